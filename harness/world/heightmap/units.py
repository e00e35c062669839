"""Lengths of the units in which surveys are: by EPSG's numbers, by name, in names of CRSs and in WKT.

Where a GeoTIFF names its CRS by EPSG's number alone (as GDAL does of one with heights), its unit stands
nowhere else; of a CRS without a number it may stand in the name: `State plane, Long Island (ftUS)`.
"""

import re
from collections.abc import Mapping
from typing import Any

from harness.base.errors import UsageError
from harness.spec.world import MESH_UNITS

METRE, FOOT, US_FOOT, BRITISH_FOOT, OTHER = 9001, 9002, 9003, 9095, 32767
FOOT_LENGTH, US_FOOT_LENGTH = MESH_UNITS["ft"], 1200.0 / 3937.0  # [m]
UNITS = {  # EPSG's numbers: name, length [m]
    METRE: ("metre", 1.0),
    FOOT: ("foot", FOOT_LENGTH),
    US_FOOT: ("US survey foot", US_FOOT_LENGTH),
    BRITISH_FOOT: ("British foot (1936)", 0.3048007491),
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
HEIGHTS = {  # EPSG's numbers of vertical CRSs whose unit is known: all in feet, and NAVD88
    **dict.fromkeys((5702, 6360, 8052), US_FOOT),
    **dict.fromkeys((6130, 6131, 6132, 8050, 8228), FOOT),
    5703: METRE,
    5754: BRITISH_FOOT,
}
DEPTHS = (  # EPSG's numbers of vertical CRSs that count downwards
    "5336 5612 5614 5706 5715 5734 5739 5789 5831 5861-5867 5873 6357-6359 7976 8051 8053 8358 8378 "
    "8897 9287-9288 9672 10150-10151 10349 10364 10370-10379 10547-10552 10649-10650 10678"
)
# EPSG's numbers of projected CRSs by their unit, FIRST-LAST/STEP; all others are in metres (PROJ 9.5).
PROJECTED = {
    US_FOOT: (
        "2155 2194 2204 2225-2250 2254-2263/3 2255-2287/4 2258-2264 2268-2277/3 2272-2278/2 2284-2289 "
        "2870-2895 2899-2919/4 2900-2928/4 2902-2908 2917-2920 2925-2930 2964-2968 3089-3091/2 3102 "
        "3363-3365/2 3404 3417-3438 3441-3446 3451-3459 3485-3487/2 3490-3512/2 3515-3553/2 3560-3570 "
        "3582-3586/2 3598-3600/2 3608-3632/2 3640-3642/2 3650-3662/4 3652 3660-3672/4 3670-3674/2 "
        "3677-3686/3 3688-3700/4 3690 3698 3728-3739 3753-3760 3991-3992 4217 4399-4413 4418-4433 "
        "4438-4457 5623-5625 5646 5654-5655 6200-6202 6411-6413/2 6416-6438/2 6441-6479/2 6484-6492/2 "
        "6501-6507/2 6510 6517-6543/2 6549-6555/2 6563-6565/2 6568-6576/4 6574-6590/4 6584-6590/2 "
        "6593-6609/2 6612-6618/2 6625-6627 6633 6880 6923-6925/2 6966 6997 7057-7070 7128-7368/4 "
        "7258-7370/2 7587-7645 8035-8036 8091-8093/2 8096-8182/2 8177-8189/3 8185-8197/4 8200-8210/2 "
        "8213-8216/3 8220-8226/3 8224 8380-8384/2 8387 8518-8540 9748-9749 10481-10516 10622 "
        "23301-23333 26729-26813 26847-26870 32001-32058 32064-32077 32099 32164-32167 32664-32667"
    ),
    FOOT: (
        "2222-2224 2251-2253 2256 2265-2273/4 2266-2270/4 2280-2282 2867-2869 2896-2898 2901 "
        "2909-2910 2913-2914 2921-2923 2992-2994/2 3080 3359-3361/2 3479-3483/2 3588-3590/2 3593 3605 "
        "3634-3636/2 3644-3648/2 3656 3676-3682/3 5588 6128-6141 6391 6405-6409/2 6494-6496/2 6499 "
        "6515 6545-6547/2 6557-6561/2 6570 6785-6863/2 6868 6885-6887/2 7119-7127 8065-8068 "
        "8312-8348/2 20050"
    ),
    9036: "22300",
    OTHER: (
        "2066 2136 2159-2160 2314 3139-3140 3167 3407 5472 5589 24100 24370-24374 24382 24571 "
        "27291-27292 29871-29872 30200"
    ),
}
RANGE = re.compile(r"(\d+)(?:-(\d+))?(?:/(\d+))?")
MARK = re.compile(r"\(ft(US)?\)")  # in EPSG's names of CRSs
WKT_UNIT = re.compile(r'UNIT\["[^"]*", *([0-9.eE+-]+)')
WKT_DOWN = re.compile(r'AXIS\["[^"]*", *DOWN', re.IGNORECASE)
TURN = "(gdal_calc --calc=-A turns them round)"
MERCATORS = re.compile(r'Pseudo-Mercator|(PROJECTION|METHOD)\["Mercator')  # in WKT
WKT_VERTICAL = re.compile(r"VERT_?CR?S|VERTICALCRS")


def horizontal_unit(keys: Mapping[str, Any]) -> int:
    """Returns EPSG's number of the unit that GeoKeys name; the metre's if they name none."""
    name = str(keys.get("PCSCitationGeoKey") or keys.get("GTCitationGeoKey") or "").partition(" + ")[0]
    mark, crs = MARK.search(name), keys.get("ProjectedCSTypeGeoKey", 0)
    named = METRE if mark is None else US_FOOT if mark[1] else FOOT
    numbered = (unit for unit, ranges in PROJECTED.items() if _is_in(ranges, crs))
    return int(keys.get("ProjLinearUnitsGeoKey", next(numbered, named)))


def _is_in(ranges: str, number: int) -> bool:
    return any(
        int(first) <= number <= int(last or first) and (number - int(first)) % int(step or 1) == 0
        for first, last, step in RANGE.findall(ranges)
    )


def height_unit(keys: Mapping[str, Any], horizontal: float) -> float | None:
    """Returns the length of a unit of height [m]; None if unnamed, and the ground not in metres.

    Args:
        keys: GeoKeys.
        horizontal: Length of the ground's unit [m].

    Raises:
        UsageError: They are depths.
    """
    if _is_in(DEPTHS, crs := keys.get("VerticalCSTypeGeoKey", 0)):
        raise UsageError(f"it has depths (EPSG:{crs}), not heights {TURN}")
    number = keys.get("VerticalUnitsGeoKey", HEIGHTS.get(crs))
    if number is not None:
        return UNITS.get(number, ("", None))[1]
    return 1.0 if horizontal == 1.0 else None


def wkt_units(wkt: str) -> tuple[float, float]:
    """Returns the lengths of the units of ground and height [m] that a CRS in WKT has; 1 if it has none.

    Of each of its two CRSs the last unit is that of its axes. Without one of heights, they are in the
    ground's.

    Raises:
        UsageError: Heights are depths.
    """
    if WKT_DOWN.search(wkt):
        raise UsageError(f"it has depths, not heights {TURN}")
    ground, *height = (WKT_UNIT.findall(part) for part in WKT_VERTICAL.split(wkt, maxsplit=1))
    metres = float(ground[-1]) if ground else 1.0
    return metres, float(height[0][-1]) if height and height[0] else metres
