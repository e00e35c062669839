"""SDF worlds of upright cylinders on a plane, as text that harness.world.sdf reads."""

from collections.abc import Iterable, Sequence

Circle = tuple[float, float, float]  # x, y, radius [m]

PLANE = 40.0  # [m] along a side
HEAD = f"""<sdf version="1.6">
<world name="{{name}}">
<gravity>0 0 -9.8</gravity>
<model name="ground_plane"><static>1</static><link name="link"><collision name="collision"><geometry>
<plane><normal>0 0 1</normal><size>{PLANE:g} {PLANE:g}</size></plane>
</geometry></collision></link></model>
"""
CYLINDER = """<model name="cylinder_{number}"><static>1</static><pose>{x} {y} 0 0 0 0</pose>
<link name="link"><collision name="collision"><geometry><cylinder><radius>{radius}</radius>
<length>1</length></cylinder></geometry></collision></link></model>
"""


def world_text(name: str, circles: Sequence[Circle]) -> bytes:
    """Returns a plane with cylinders of 1 m, half of each in the ground as BARN has them."""
    models = "".join(
        CYLINDER.format(number=number, x=x, y=y, radius=radius)
        for number, (x, y, radius) in enumerate(circles)
    )
    return f"{HEAD.format(name=name)}{models}</world>\n</sdf>\n".encode()


def actors_text(walks: Iterable[Sequence[Circle]]) -> bytes:
    """Returns people who walk for ever through points at times: x, y [m] and time [s] of each."""
    lines = ['<sdf version="1.6"><world name="actors">']
    for number, walk in enumerate(walks):
        points = "".join(
            f"<waypoint><time>{t:.4f}</time><pose>{x:.4f} {y:.4f} 0 0 0 0</pose></waypoint>"
            for x, y, t in walk
        )
        script = f'<loop>true</loop><trajectory id="0" type="walk">{points}</trajectory>'
        lines.append(f'<actor name="mover_{number}"><script>{script}</script></actor>')
    return "\n".join([*lines, "</world></sdf>"]).encode()
