"""Rovers to begin with: a URDF of plain shapes for each kind of undercarriage, to be changed at will."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

BODY, BODY_MASS = (0.62, 0.36, 0.14), 14.0  # [m], [kg]
RADIUS, WIDTH, WHEEL_MASS = 0.12, 0.08, 1.2  # [m], [m], [kg]
ASIDE = 0.5 * BODY[1] + 0.5 * WIDTH + 0.03  # [m] of the wheels, from the middle
LIFT = 0.06  # [m] of the body's middle over the axles
EFFORT, SPEED = 6.0, 10.0  # [N m], [rad/s] of a motor


@dataclass(frozen=True)
class Template:
    """A kind of undercarriage."""

    summary: str  # what it is
    axles: tuple[float, ...]  # their places along x, front to rear [m]
    rockers: bool = False  # whether the wheels of a side sit on a rocker, both joined by a differential
    steers: bool = False  # whether the wheels of the first axle turn


TEMPLATES = {
    "skid4": Template("four wheels, steered by its sides", (0.22, -0.22)),
    "skid6": Template("six wheels, steered by its sides", (0.27, 0.0, -0.27)),
    "rocker": Template("four wheels on two rockers with a differential", (0.22, -0.22), rockers=True),
    "ackermann": Template("four driven wheels, the front two steer", (0.25, -0.25), steers=True),
}


def urdf_of(name: str, template: Template) -> str:
    """Returns the URDF of a template, x forward, z up, the root link in the middle of the body."""
    parts = (*_body(), *(part for side in (1, -1) for part in _side(template, side)))
    return "\n".join((f'<robot name="{name}">', *parts, "</robot>", ""))


def _body() -> Iterator[str]:
    x, y, z = BODY
    yield _link("base_link", BODY_MASS, f'<box size="{x:g} {y:g} {z:g}"/>', (x, y, z))
    for link, place in (("lidar_link", (0.1, 0.0, 0.5 * z + 0.15)), ("imu_link", (0.0, 0.0, 0.0))):
        yield f'  <link name="{link}"/>'
        yield _joint(f"{link}_joint", "fixed", "base_link", link, place)


def _side(template: Template, side: int) -> Iterator[str]:
    letter, parent, down = "L" if side > 0 else "R", "base_link", -LIFT
    if template.rockers:
        rocker, size = f"rocker_{letter}", (2 * template.axles[0], 0.03, 0.03)
        box = '<box size="{:g} {:g} {:g}"/>'.format(*size)
        yield _link(rocker, 1.0, box, size)
        place = (0.0, side * (0.5 * BODY[1] + 0.015), 0.0)
        mimic = '<mimic joint="rocker_L_joint" multiplier="-1"/>' if side < 0 else ""
        limit = '<axis xyz="0 1 0"/><limit lower="-0.3" upper="0.3" effort="0" velocity="9"/>'
        yield _joint(f"{rocker}_joint", "revolute", "base_link", rocker, place, limit + mimic)
        parent = rocker
    for number, x in enumerate(template.axles):
        wheel, held = f"wheel_{letter}{number + 1}", parent
        y = side * (ASIDE - (0.5 * BODY[1] + 0.015) * template.rockers)
        place = (x, y, down)
        if template.steers and number == 0:
            held = knuckle = f"knuckle_{letter}"
            yield _link(knuckle, 0.3, '<box size="0.04 0.03 0.06"/>', (0.04, 0.03, 0.06))
            limit = '<axis xyz="0 0 1"/><limit lower="-0.6" upper="0.6" effort="8" velocity="3"/>'
            yield _joint(f"steer_{letter}", "revolute", parent, knuckle, place, limit)
            place = (0.0, 0.0, 0.0)
        cylinder = f'<cylinder radius="{RADIUS:g}" length="{WIDTH:g}"/>'
        yield _link(wheel, WHEEL_MASS, cylinder, (2 * RADIUS, WIDTH, 2 * RADIUS), lies=True)
        motor = f'<axis xyz="0 1 0"/><limit effort="{EFFORT:g}" velocity="{SPEED:g}"/>'
        yield _joint(f"{wheel}_joint", "continuous", held, wheel, place, motor)


def _link(
    name: str, mass: float, shape: str, size: tuple[float, float, float], *, lies: bool = False
) -> str:
    """A link of one shape, with the inertia of the box around it."""
    x, y, z = (length**2 for length in size)
    origin = f'<origin rpy="{pi / 2:.8g} 0 0"/>' if lies else ""
    i_x, i_y, i_z = (mass * squares / 12 for squares in (y + z, x + z, x + y))
    moments = f'ixx="{i_x:.4g}" iyy="{i_y:.4g}" izz="{i_z:.4g}" ixy="0" ixz="0" iyz="0"'
    return (
        f'  <link name="{name}">\n'
        f'    <inertial><mass value="{mass:g}"/><inertia {moments}/></inertial>\n'
        f"    <visual>{origin}<geometry>{shape}</geometry></visual>\n"
        f"    <collision>{origin}<geometry>{shape}</geometry></collision>\n"
        "  </link>"
    )


def _joint(
    name: str, kind: str, parent: str, child: str, place: tuple[float, float, float], more: str = ""
) -> str:
    x, y, z = place
    return (
        f'  <joint name="{name}" type="{kind}">\n'
        f'    <parent link="{parent}"/><child link="{child}"/><origin xyz="{x:g} {y:g} {z:g}"/>{more}\n'
        "  </joint>"
    )
