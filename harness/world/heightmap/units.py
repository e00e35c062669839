"""Lengths of the units in which surveys are: by EPSG's numbers, by name, in names of CRSs and in WKT.

Where a GeoTIFF names its CRS by EPSG's number alone (as GDAL does of one with heights), its unit stands
nowhere but in the CRS's name: `NAD83 / New York Long Island (ftUS) + NAVD88 height (ftUS)`; that of
older ones (NAD27's state planes, grids of yards, links and chains) not even there.
"""

import re
from collections.abc import Mapping
from typing import Any

from harness.spec.world import MESH_UNITS

METRE, FOOT, US_FOOT, OTHER = 9001, 9002, 9003, 32767
FOOT_LENGTH, US_FOOT_LENGTH = MESH_UNITS["ft"], 1200.0 / 3937.0  # [m]
UNITS = {  # EPSG's numbers: name, length [m]
    METRE: ("metre", 1.0),
    FOOT: ("foot", FOOT_LENGTH),
    US_FOOT: ("US survey foot", US_FOOT_LENGTH),
    9036: ("kilometre", 1000.0),
}
NAMED = {  # as GDAL's unit types of bands are written
    **MESH_UNITS,
    **dict.fromkeys(("metre", "metres", "meter", "meters"), 1.0),
    **dict.fromkeys(("foot", "feet", "international foot"), FOOT_LENGTH),
    **dict.fromkeys(("us-ft", "ftus", "us survey foot", "us survey feet", "sfoot"), US_FOOT_LENGTH),
    "dm": 0.1,
    "km": 1e3,
    "yd": 0.9144,
}
HEIGHTS = {  # EPSG's numbers of vertical CRSs whose unit is known: all in feet, and NAVD88 in metres
    **dict.fromkeys((5702, 6360, 8052), US_FOOT),
    **dict.fromkeys((6130, 6131, 6132, 8050, 8228), FOOT),
    5703: METRE,
}
OLD_UNITS = {  # EPSG's first and last numbers of projected CRSs whose names do not say their unit
    US_FOOT: (
        *((2155, 2155), (2194, 2194), (2204, 2204), (2964, 2964), (3102, 3102), (3561, 3565)),
        *((3991, 3992), (4455, 4456), (5623, 5625), (6200, 6202), (6966, 6966), (7057, 7070)),
        *((8518, 8529), (8531, 8531), (8533, 8536), (8538, 8540), (10481, 10481), (26729, 26760)),
        *((26766, 26787), (26791, 26799), (26801, 26803), (26811, 26813), (32001, 32003)),
        *((32005, 32031), (32033, 32058), (32074, 32077), (32099, 32099)),
    ),
    FOOT: ((3080, 3080), (5588, 5588), (6128, 6129), (6141, 6141), (6391, 6391)),
    OTHER: (
        *((2066, 2066), (2136, 2136), (2159, 2160), (2314, 2314), (3139, 3140), (3167, 3167)),
        *((3407, 3407), (5472, 5472), (5589, 5589), (22300, 22300), (24100, 24100), (24370, 24374)),
        *((24382, 24382), (24571, 24571), (27291, 27292), (29871, 29872), (30200, 30200)),
    ),
}
MARK = re.compile(r"\(ft(US)?\)")  # in EPSG's names of CRSs
WKT_UNIT = re.compile(r'UNIT\["[^"]*", *([0-9.eE+-]+)')
WKT_VERTICAL = re.compile(r"VERT_?CR?S|VERTICALCRS")


def horizontal_unit(keys: Mapping[str, Any]) -> int:
    """Returns EPSG's number of the unit that GeoKeys name; the metre's if they name none."""
    name = str(keys.get("PCSCitationGeoKey") or keys.get("GTCitationGeoKey") or "").partition(" + ")[0]
    mark, crs = MARK.search(name), keys.get("ProjectedCSTypeGeoKey", 0)
    named = METRE if mark is None else US_FOOT if mark[1] else FOOT
    old = (unit for unit, all_of in OLD_UNITS.items() for first, last in all_of if first <= crs <= last)
    return int(keys.get("ProjLinearUnitsGeoKey", next(old, named)))


def height_unit(keys: Mapping[str, Any], horizontal: float) -> float | None:
    """Returns the length of a unit of height [m]; None if unnamed, and the ground not in metres.

    Args:
        keys: GeoKeys.
        horizontal: Length of the ground's unit [m].
    """
    number = keys.get("VerticalUnitsGeoKey", HEIGHTS.get(keys.get("VerticalCSTypeGeoKey", 0)))
    if number is not None:
        return UNITS.get(number, ("", None))[1]
    return 1.0 if horizontal == 1.0 else None


def wkt_units(wkt: str) -> tuple[float, float]:
    """Returns the lengths of the units of ground and height [m] that a CRS in WKT has; 1 if it has none.

    Of each of its two CRSs the last unit is that of its axes. Without one of heights, they are in the
    ground's.
    """
    ground, *height = (WKT_UNIT.findall(part) for part in WKT_VERTICAL.split(wkt, maxsplit=1))
    metres = float(ground[-1]) if ground else 1.0
    return metres, float(height[0][-1]) if height and height[0] else metres
