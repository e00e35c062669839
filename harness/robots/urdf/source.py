"""A URDF file as MuJoCo's own reader takes it: with the paths of its meshes, without what is missing.

A URDF is data. xacro is a program: it evaluates Python expressions of its author, so a xacro file
is only expanded where the user says that it is trusted.
"""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from urllib.parse import unquote, urlparse
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from harness.base.documents import read_bytes
from harness.base.errors import UsageError
from harness.base.mesh import Mesh
from harness.base.mesh_file import FACE, HEAD, SIMPLER, SUFFIXES, read_mesh
from harness.base.mesh_file import MOST_BYTES as LARGEST
from harness.base.sdf.scopes import ROOTS
from harness.robots.model import keep_mujoco_quiet
from harness.robots.strangers import COMMENT, parsed, read_text
from harness.robots.urdf.sdf import AXES, urdf_of_sdf

MUJOCO = (".stl", ".obj", ".msh")  # what its own decoders read
MOST_FACES = 200_000  # that MuJoCo's decoder reads
XACRO = re.compile(r"<xacro:|\$[({]")  # it leaves its namespace, and comments as they were, in a URDF


def read_urdf(
    path: Path, folders: Sequence[Path], name: str, *, trust_xacro: bool
) -> tuple[mujoco.MjSpec, ET.Element, list[str]]:
    """Returns a URDF, or a model in SDF, as a model of MuJoCo, its <robot>, and what was mended.

    The links are bodies, none fused; what was dropped or mended is a line each.

    Args:
        path: Of the file.
        folders: With meshes and packages, beside its own and those of packages above it.
        name: The rover's; of several models in SDF, that of this name is read.
        trust_xacro: Whether it may be xacro, which runs what its author wrote.

    Raises:
        UsageError: It cannot be read, is not URDF, or a mesh that collides is missing.
    """
    robot = parsed(_text(path, folders, trust_xacro=trust_xacro), path)
    notes: list[str] = []
    if robot.tag in ROOTS:
        robot, notes = urdf_of_sdf(robot, path, folders, name)
    _check_content(robot, path)
    for link in robot.iter("link"):
        notes += _find_meshes(link, path, folders)
        notes += _implausible_inertia(link, path)
    for extension in robot.findall("mujoco"):
        robot.remove(extension)
    compiler = {"fusestatic": "false", "discardvisual": "false", "strippath": "false"}
    ET.SubElement(ET.SubElement(robot, "mujoco"), "compiler", compiler | {"balanceinertia": "true"})
    keep_mujoco_quiet()
    try:
        spec = mujoco.MjSpec.from_string(ET.tostring(robot, encoding="unicode"))
    except ValueError as error:
        raise UsageError(
            f"{path} is no URDF that MuJoCo reads: {' '.join(str(error).split())}"
        ) from error
    for mesh in spec.meshes:
        if not _taken_by_mujoco(file := Path(mesh.file)):
            triangles = _triangles(file)
            mesh.uservert, mesh.userface = triangles.vertices.ravel(), triangles.faces.ravel()
            mesh.file = ""
    _wind_springs(spec, robot)
    without = {link.get("name") for link in robot.iter("link") if link.find("inertial") is None}
    for body in spec.bodies:
        if body.name in without:  # MuJoCo would give its shapes the density of water
            for geom in body.geoms:
                geom.mass = 0.0
    return spec, robot, notes


def _wind_springs(spec: mujoco.MjSpec, robot: ET.Element) -> None:
    """Gives joints the springs that SDF has, and URDF cannot say."""
    for joint in robot.findall("joint"):
        dynamics = joint.find("dynamics")
        stiffness = 0.0 if dynamics is None else float(dynamics.get("spring_stiffness", "0"))
        if dynamics is not None and stiffness:
            sprung = spec.joint(joint.get("name"))
            sprung.stiffness[0] = stiffness
            sprung.springref = float(dynamics.get("spring_reference", "0"))


def _check_content(robot: ET.Element, path: Path) -> None:
    if robot.tag != "robot":
        mend = "give a file that holds <robot> or <sdf>"
        raise UsageError(f"{path} is neither URDF nor SDF: it holds <{robot.tag}>; {mend}")
    if robot.find("link") is None:
        raise UsageError(f"{path} holds no <link>; give the URDF of a robot")
    for joint in robot.findall("joint"):
        name, kind = joint.get("name"), joint.get("type")
        if kind in ("floating", "planar"):
            raise UsageError(
                f"{path}: joint '{name}' is {kind}; take it and all above it out: roots are free"
            )
    links, joints = (
        Counter(one.get("name", "") for one in robot.findall(tag)) for tag in ("link", "joint")
    )
    for what, names in (("links", links), ("joints", joints)):
        if twice := [name for name, times in names.items() if times > 1]:
            raise UsageError(f"{path}: {names[twice[0]]} {what} are called '{twice[0]}'; rename them")
    ends = [{end.tag: end.get("link", "") for end in joint} for joint in robot.findall("joint")]
    above = {end["child"]: [end["parent"]] for end in ends if {"child", "parent"} <= end.keys()}
    try:
        TopologicalSorter(above).prepare()
    except CycleError as error:
        loop = " -> ".join(error.args[1])
        raise UsageError(f"{path}: links hang in a loop, {loop}; take a joint of it out") from error
    for mimic in robot.iterfind("joint/mimic"):
        if (name := mimic.get("joint")) not in joints:
            raise UsageError(f"{path}: a joint mimics '{name}', which is not there; take <mimic> out")


def _taken_by_mujoco(file: Path) -> bool:
    """Whether MuJoCo's own decoders read a mesh: not STL in text, cut short, or with more behind."""
    data = read_bytes(file, LARGEST)
    if file.suffix.lower() != ".stl":
        return file.suffix.lower() in MUJOCO
    faces = int.from_bytes(data[HEAD - 4 : HEAD], "little")
    return len(data) == HEAD + FACE * faces and faces <= MOST_FACES


def _triangles(file: Path) -> Mesh:
    """What another file holds, of COLLADA whatever axis it says is up: RViz and Gazebo skip that."""
    mesh, _ = read_mesh(file, up="z")
    if len(mesh.faces) > MOST_FACES:
        raise UsageError(f"it has {len(mesh.faces):,} triangles, more than {MOST_FACES:,}; {SIMPLER}")
    return mesh


def _text(path: Path, folders: Sequence[Path], *, trust_xacro: bool) -> str:
    text = read_text(path)
    if XACRO.search(COMMENT.sub("", text)) is None and path.suffix != ".xacro":
        return text
    if not trust_xacro:
        raise UsageError(
            f"{path} is xacro, which runs its author's Python; give the URDF that it makes "
            f"(xacro {path.name} > robot.urdf), or add --trust-xacro if you trust all that it includes"
        )
    return _expanded(path, folders)


def _expanded(path: Path, folders: Sequence[Path]) -> str:
    try:
        import xacro  # noqa: PLC0415 - an optional extra
        from xacrodoc import XacroDoc, packages  # noqa: PLC0415
    except ImportError as error:
        raise UsageError("--trust-xacro needs xacrodoc: pip install 'rover-harness[xacro]'") from error
    # As of meshes, packages are looked for in the folders, then beside and above the file: the last one
    # in counts.
    places = reversed((*folders, *path.resolve().parents))
    there = (file for place in places for file in place.glob("*/package.xml"))
    packages.update_package_cache({file.parent.name: file.parent for file in there})
    xacro.init_stacks(str(path.resolve()))  # by which it finds what is included beside the file
    try:
        document = XacroDoc.from_file(str(path), resolve_packages=False)
        return str(document.to_urdf_string())
    except Exception as error:  # whatever the xacro file does
        reason = " ".join(str(error).split())
        if "AMENT_PREFIX_PATH" in reason or isinstance(error, packages.PackageNotFoundError):
            missing = "a package" if "AMENT" in reason else f"package {error.args[0]}"
            reason = f"{missing} is not found; name the folder that holds it by --resource-path"
        raise UsageError(f"xacro refuses {path}: {reason}") from error


def _find_meshes(link: ET.Element, path: Path, folders: Sequence[Path]) -> Iterator[str]:
    """Puts in where the meshes of a link are; drops what is only to be seen and cannot be."""
    for shape in (*link.findall("visual"), *link.findall("collision")):
        mesh = shape.find("geometry/mesh")
        if mesh is None:
            continue
        file, why, mend = _file(mesh.get("filename", ""), path, folders)
        if file is not None:
            mesh.set("filename", str(file))
            continue
        problem = f"link '{link.get('name')}': {shape.tag} mesh {mesh.get('filename')} {why}"
        if shape.tag == "collision":
            raise UsageError(f"{path}: {problem}; {mend}, or give a shape")
        link.remove(shape)
        yield f"{problem}; dropped"


def _file(name_in_file: str, path: Path, folders: Sequence[Path]) -> tuple[Path | None, str, str]:
    """Where a mesh is, or why it is not taken, with the mend.

    Packages are looked for in the folders, and beside and above the file; no name leads out of them.
    """
    url, above = urlparse(name_in_file), path.resolve().parents
    name, own = unquote(url.path), (*folders, above[0])
    if url.scheme in ("package", "model"):
        packages = [folder / url.netloc for folder in (*folders, *above) if url.netloc]
        packages += [folder for folder in above if folder.name == url.netloc]
        places = [(package, package / name.lstrip("/")) for package in (*packages, above[0])]
    else:
        places = [(folder, folder / name) for folder in own]
    there = [(root, place) for root, place in places if place.is_file()]
    if not there:
        return None, "is not there", "put its package beside the file or above it"
    inside = (
        place
        for root, place in there
        if any(place.resolve().is_relative_to(of.resolve()) for of in (root, *folders))
    )
    if (file := next(inside, None)) is None:
        return None, "is outside of the URDF's folder", "name its folder by --resource-path"
    if file.suffix.lower() not in (*SUFFIXES, *MUJOCO):
        return None, f"is no {', '.join(SUFFIXES)} or {MUJOCO[-1]}", "convert it"
    try:
        if not _taken_by_mujoco(file):
            _triangles(file)
    except UsageError as error:
        text = str(error).replace(f"mesh {file}: ", "").replace(f"{file} ", "")
        why, _, mend = text.removeprefix("it ").partition("; ")
        return None, why, mend or "export it anew"
    return file, "", ""


def _implausible_inertia(link: ET.Element, path: Path) -> Iterator[str]:
    """Reports an inertia that no body can have, which MuJoCo balances."""
    inertia = link.find("inertial/inertia")
    if inertia is None:
        return
    name = link.get("name")
    try:
        xx, yy, zz, xy, xz, yz = (float(inertia.get(f"i{axes}", "0")) for axes in AXES)
        mass = float(link.find("inertial/mass").get("value", "0"))  # type: ignore[union-attr]  # None fails
    except (ValueError, AttributeError) as error:
        raise UsageError(
            f"{path}: link '{name}': <inertial> needs a mass and an inertia in numbers"
        ) from error
    moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if mass == 0 and not moments.any():  # as exporters write of a link that is only a frame
        link.remove(link.find("inertial"))  # type: ignore[arg-type]  # it is there: it has an inertia
        return
    if not (mass > 0 and moments[0] > 0):
        stated = f"mass {mass:g} and moments of inertia {moments.round(9).tolist()}"
        raise UsageError(f"{path}: link '{name}' has {stated}; give numbers above 0")
    if moments[0] + moments[1] < moments[2]:
        yield f"link '{name}': no body has the inertia {moments.round(6).tolist()}; balanced"
