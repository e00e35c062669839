"""Rovers that are not ours, as URDFs made from public numbers, and what those numbers are.

Husky: husky_description (A200, 50 kg). Buggy: the vehicle of F1TENTH's simulator (f1tenth_gym, 3.74 kg).
Rocker-bogie: sizes of Sojourner (JPL: 10.5 kg, wheels of 13 cm, 65 cm x 48 cm), driven at 0.3 m/s.
"""

from collections.abc import Iterator
from dataclasses import dataclass

QUARTER = 1.5707963267948966


@dataclass(frozen=True)
class Foreign:
    """A URDF with what is known of its rover; [kg], [m], [m/s]."""

    urdf: str
    mass: float
    wheel_radius: float
    wheelbase: float
    track: float
    top_speed: float
    left: tuple[str, ...]
    right: tuple[str, ...]


def link(name: str, mass: float, shape: str = "", size: tuple[float, ...] = (0.0,) * 3) -> str:
    """A link whose mass fills a box of that size."""
    x, y, z = (mass * s * s / 12 for s in size)
    inertia = f'ixx="{y + z}" iyy="{x + z}" izz="{x + y}" ixy="0" ixz="0" iyz="0"'
    inertial = f'<inertial><mass value="{mass}"/><inertia {inertia}/></inertial>' if mass else ""
    return f'<link name="{name}">{inertial}{shape}</link>'


def box(size: tuple[float, float, float]) -> str:
    return f'<collision><geometry><box size="{size[0]} {size[1]} {size[2]}"/></geometry></collision>'


def seen(size: tuple[float, float, float]) -> str:
    return box(size).replace("collision", "visual")


def joint(name: str, kind: str, parent: str, child: str, xyz: tuple[float, ...], more: str = "") -> str:
    where = f'<origin xyz="{xyz[0]} {xyz[1]} {xyz[2]}"/>'
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{where}{more}</joint>'


def wheel(
    name: str,
    parent: str,
    xyz: tuple[float, ...],
    radius: float,
    width: float,
    mass: float,
    limit: str = "",
) -> str:
    cylinder = f'<geometry><cylinder radius="{radius}" length="{width}"/></geometry>'
    tyre = f'<collision><origin rpy="{QUARTER} 0 0"/>{cylinder}</collision>'
    size = (1.7 * radius, width, 1.7 * radius)
    turning = joint(f"{name}_joint", "continuous", parent, name, xyz, f'<axis xyz="0 1 0"/>{limit}')
    return link(name, mass, tyre, size) + turning


def robot(name: str, *parts: str) -> str:
    return f'<robot name="{name}">{"".join(parts)}</robot>'


def _husky() -> Foreign:
    wheelbase, track, radius, width = 0.5120, 0.5708, 0.1651, 0.1143
    size, limit = (0.9874, 0.5709, 0.2475), '<limit effort="40" velocity="6.06"/>'
    places = {"front_left": (1, 1), "rear_left": (-1, 1), "front_right": (1, -1), "rear_right": (-1, -1)}
    wheels = (
        wheel(
            f"{n}_wheel",
            "base_link",
            (x * wheelbase / 2, y * track / 2, 0.0328),
            radius,
            width,
            2.637,
            limit,
        )
        for n, (x, y) in places.items()
    )
    body = box(size).replace("<collision>", '<collision><origin xyz="0 0 0.1824"/>')
    parts = (
        link("base_footprint", 0.0),
        joint("base_footprint_joint", "fixed", "base_footprint", "base_link", (0, 0, radius - 0.0328)),
        link("base_link", 46.034, body, size),
        *wheels,
        link("laser", 0.0),
        joint("laser_mount", "fixed", "base_link", "laser", (0.3, 0.0, 0.45)),
        link("imu_link", 0.0),
        joint("imu_joint", "fixed", "base_link", "imu_link", (0.19, 0.0, 0.149)),
    )
    left, right = (
        tuple(f"{e}_{side}_wheel_joint" for e in ("front", "rear")) for side in ("left", "right")
    )
    return Foreign(
        robot("husky", *parts), 46.034 + 4 * 2.637, radius, wheelbase, track, 1.0, left, right
    )


def _buggy() -> Foreign:
    front, rear, track, radius, width, mass = 0.15875, 0.17145, 0.2413, 0.0508, 0.045, 3.74
    size, wheel_mass = (0.46, 0.16, 0.08), 0.2
    limit = '<limit effort="1.5" velocity="100"/>'
    steering = '<axis xyz="0 0 1"/><limit lower="-0.4189" upper="0.4189" effort="5" velocity="3.2"/>'

    def corner(side: str, y: float) -> Iterator[str]:
        yield link(f"{side}_hinge", 0.05, "", (0.03, 0.03, 0.03))
        yield joint(
            f"{side}_steering", "revolute", "chassis", f"{side}_hinge", (front, y, 0.0), steering
        )
        free = "front_" + side
        yield wheel(free, f"{side}_hinge", (0.0, 0.0, 0.0), radius, width, wheel_mass)
        yield wheel("rear_" + side, "chassis", (-rear, y, 0.0), radius, width, wheel_mass, limit)

    motor = "<hardwareInterface>hardware_interface/VelocityJointInterface</hardwareInterface>"
    transmissions = "".join(
        f'<transmission name="{n}"><joint name="rear_{n}_joint">{motor}</joint></transmission>'
        for n in ("left", "right")
    )
    shell = mass - 4 * wheel_mass - 2 * 0.05
    body = link(
        "chassis", shell, box(size).replace("<collision>", '<collision><origin xyz="0 0 0.05"/>'), size
    )
    corners = (*corner("left", track / 2), *corner("right", -track / 2))
    urdf = robot("buggy", body, *corners, transmissions)
    sides = (tuple(f"{end}_{side}_joint" for end in ("front", "rear")) for side in ("left", "right"))
    return Foreign(urdf, mass, radius, front + rear, track, 100 * radius, *sides)


def _rocker_bogie() -> Foreign:
    radius, width, track, ahead, low = 0.065, 0.079, 0.40, 0.25, -0.115
    limit = '<dynamics damping="0.05" friction="0.05"/><limit effort="3" velocity="4.615"/>'
    swing = '<axis xyz="0 1 0"/><limit lower="-0.4" upper="0.4" effort="0" velocity="1"/>'
    swing += '<dynamics damping="0.2" friction="0.05"/>'

    def side(s: str, y: float) -> Iterator[str]:
        mirrored = '<mimic joint="rocker_L_joint" multiplier="-1"/>' if s == "R" else ""
        yield link(f"rocker_{s}", 0.5, seen((0.5, 0.03, 0.04)), (0.3, 0.03, 0.05))
        yield joint(
            f"rocker_{s}_joint", "revolute", "base_link", f"rocker_{s}", (0, y, 0), swing + mirrored
        )
        yield wheel(f"rear_{s}", f"rocker_{s}", (-ahead, 0.0, low), radius, width, 0.4, limit)
        yield link(f"bogie_{s}", 0.3, seen((0.25, 0.03, 0.03)), (0.25, 0.03, 0.03))
        pivot = (ahead / 2, 0.0, low + 0.06)
        yield joint(f"bogie_{s}_joint", "revolute", f"rocker_{s}", f"bogie_{s}", pivot, swing)
        yield wheel(f"middle_{s}", f"bogie_{s}", (-ahead / 2, 0.0, -0.06), radius, width, 0.4, limit)
        yield wheel(f"front_{s}", f"bogie_{s}", (ahead / 2, 0.0, -0.06), radius, width, 0.4, limit)

    size = (0.45, 0.28, 0.12)
    rest = 10.5 - 2 * (0.5 + 0.3) - 6 * 0.4
    body = link(
        "base_link", rest, box(size).replace("<collision>", '<collision><origin xyz="0 0 0.05"/>'), size
    )
    urdf = robot("sojourner", body, *side("L", track / 2), *side("R", -track / 2))
    left, right = (tuple(f"{end}_{s}_joint" for end in ("front", "middle", "rear")) for s in "LR")
    return Foreign(urdf, 10.5, radius, 2 * ahead, track, 4.615 * radius, left, right)


HUSKY, BUGGY, ROCKER_BOGIE = _husky(), _buggy(), _rocker_bogie()
FOREIGN = {"a200": HUSKY, "buggy": BUGGY, "sojourner": ROCKER_BOGIE}


def _leo_like() -> str:
    """Names, nesting, meshes as in leo_description: rockers in turned frames, a mimic, a fixed base."""
    moments = " ".join(f'i{a}="{{1}}"' for a in ("xx", "yy", "zz")) + ' ixy="0" ixz="0" iyz="0"'
    inertial = '<inertial><mass value="{0}"/><inertia ' + moments + "/></inertial>"
    mesh = '<geometry><mesh filename="package://leo_description/models/{}"/></geometry>'
    seen_mesh = "<visual>" + mesh + "</visual>"
    outline = f"<collision>{mesh.format('Chassis_outline.stl')}</collision>"
    rocker = '<axis xyz="0 1 0"/><limit lower="-0.24" upper="0.24" effort="100" velocity="100"/>'
    limit = '<limit effort="2" velocity="6"/><dynamics damping="0.1" friction="0.3125"/>'

    def side(s: str, y: float, turned: str, more: str) -> Iterator[str]:
        yield f'<link name="rocker_{s}_link">{inertial.format(1.387, 0.02)}</link>'
        yield (
            f'<joint name="rocker_{s}_joint" type="revolute"><parent link="base_link"/>'
            f'<child link="rocker_{s}_link"/><origin xyz="0.00263 {y} -0.04731" rpy="0 0 {turned}"/>'
            f"{rocker}{more}</joint>"
        )
        for end, x in (("F", 0.15256), ("R", -0.15256)):
            ahead = -x if turned != "0" else x  # in the turned frame
            outboard = -0.08214 if s == "R" or turned != "0" else 0.08214
            place = (ahead, outboard, -0.08802)
            name = f"wheel_{end}{s}"
            axis = "0 -1 0" if turned != "0" else "0 1 0"
            yield (
                wheel(f"{name}_link", f"rocker_{s}_link", place, 0.0625, 0.07, 0.2836, limit)
                .replace(f"{name}_link_joint", f"{name}_joint")
                .replace('<axis xyz="0 1 0"/>', f'<axis xyz="{axis}"/>')
            )

    fixed, chassis = "fixed", seen_mesh.format("Chassis.dae") + outline
    parts = (
        link("base_footprint", 0.0),
        joint("base_joint", fixed, "base_footprint", "base_link", (0, 0, 0.19783)),
        f'<link name="base_link">{inertial.format(1.58, 0.01)}{chassis}</link>',
        f'<link name="antenna_link">{seen_mesh.format("Antenna.dae")}</link>',
        joint("antenna_joint", fixed, "base_link", "antenna_link", (0.0052, 0.056, -0.0065)),
        link("lidar_link", 0.0),
        joint("lidar_joint", fixed, "base_link", "lidar_link", (0.174, 0.0, 0.6)),
        link("imu_frame", 0.0),
        joint("imu_joint", fixed, "base_link", "imu_frame", (0.0628, -0.0314, -0.0393)),
        *side("L", 0.14167, "3.14159265359", ""),
        *side("R", -0.14167, "0", '<mimic joint="rocker_L_joint"/>'),
    )
    return robot("leo", *parts)


def _rover_4wd_like() -> str:
    """Names and nesting as in rover_4wd.urdf; wheels turn about z of links that lie on their sides."""
    size, mass = (0.4, 0.28, 0.1), 8.4

    def corner(name: str, x: float, y: float) -> Iterator[str]:
        cylinder = '<geometry><cylinder radius="0.127" length="0.083"/></geometry>'
        tyre = f"<collision>{cylinder}</collision>"
        yield link(f"{name}_wheel", 0.8, tyre, (0.2, 0.2, 0.08))
        roll = -QUARTER if y > 0 else QUARTER  # z outboard on both sides: the right one backwards
        limit = '<limit effort="20" velocity="10"/>'
        yield (
            f'<joint name="{name}_wheel_to_chassis" type="continuous"><parent link="chassis_link"/>'
            f'<child link="{name}_wheel"/><origin xyz="{x} {y} 0" rpy="{roll} 0 0"/>'
            f'<axis xyz="0 0 1"/>{limit}</joint>'
        )

    places = {"fl": (1, 1), "rl": (-1, 1), "fr": (1, -1), "rr": (-1, -1)}
    corners = (part for name, (x, y) in places.items() for part in corner(name, 0.143 * x, 0.18 * y))
    body = link("chassis_link", mass, box(size), size)
    base = joint("base_joint", "fixed", "base_link", "chassis_link", (0, 0, 0.125))
    return robot("rover_4wd", link("base_link", 0.0), base, body, *corners)


LEO_LIKE, ROVER_4WD_LIKE = _leo_like(), _rover_4wd_like()
