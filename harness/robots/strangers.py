"""What a model from elsewhere may not be: endless, a reader of other files, or impossible as a body.

MuJoCo takes friction below 0, reads whatever a file names, and makes room for every heightfield; here
each of these is an error of one line.
"""

import math
import re
from collections.abc import Iterable
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from harness.base.documents import read_bytes
from harness.base.errors import UsageError
from harness.base.xml import parse_xml

MOST_BYTES = 20_000_000  # of a URDF, a model, or what it includes
MOST_CELLS = 4_194_304  # rows x columns of a heightfield, pixels of a texture
MOST_COPIES = 1_000  # of what <replicate>, <composite> and <flexcomp> repeat, one within the other
MOST_FILES = 100  # that a model may include
PNG = b"\x89PNG"
NEEDED = "constraint", "contact", "gravity", "actuation", "sensor"  # of what <flag> can switch off
MEDIUM = "wind", "density", "viscosity"  # of <option>: of a fluid that no world has
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)  # MuJoCo's may hold --
TIES = mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD
# Range, unit and arrays of MuJoCo's model: what a rover of 1 g to 1000 t may be made of.
_QUANTITIES = (
    ("friction", "", 0.0, 100.0, "geom", "geom_friction"),
    ("size", " m", 0.0, 1e3, "geom", "geom_size"),
    ("mass", " kg", 0.0, 1e6, "body", "body_mass"),
    ("inertia", " kg m2", 0.0, 1e9, "body", "body_inertia"),
    ("damping", "", 0.0, 1e6, "joint", "dof_damping"),
    ("friction", "", 0.0, 1e6, "joint", "dof_frictionloss"),
    ("armature", "", 0.0, 1e6, "joint", "dof_armature"),
    ("stiffness", "", 0.0, 1e9, "joint", "jnt_stiffness"),
    ("gravcomp", "", 0.0, 0.0, "body", "body_gravcomp"),
)


def read_xml(path: Path) -> ET.Element:
    """Returns the root of an XML file; UsageError if it is too large, has entities, or is no XML."""
    return parsed(read_text(path), path)


def read_text(path: Path) -> str:
    """Returns the text of a file; UsageError if it is too large or none."""
    try:
        return read_bytes(path, MOST_BYTES).decode("utf-8")
    except UnicodeDecodeError as error:
        raise UsageError(f"cannot read {path} ({error}); save it as UTF-8") from error


def parsed(text: str, path: Path) -> ET.Element:
    """Returns the root of an XML text of that file; UsageError if it declares entities or is no XML."""
    try:
        return parse_xml(COMMENT.sub("", text).lstrip().encode(), "utf-8")
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error


def inside(file: Path, folder: Path, where: str) -> Path:
    """Returns a file if it is below a folder.

    Args:
        file: There or not.
        folder: Of the rover, which has all its files.
        where: The file is named, for the message.

    Raises:
        UsageError: It is elsewhere.
    """
    if not file.resolve().is_relative_to(folder.resolve()):
        raise UsageError(f"{where}: {file} is not in the rover's folder {folder}; copy it there")
    return file


def check_files(path: Path, folder: Path) -> None:
    """Checks an MJCF file and those that it includes, before MuJoCo reads them.

    UsageError if one of them leads out of the rover's folder, or makes room for too much.
    """
    roots, waiting = list[ET.Element](), [path]
    while waiting:
        roots.append(read_xml(waiting.pop()))
        if len(roots) > MOST_FILES:
            raise UsageError(f"{path} includes more than {MOST_FILES} files; join them")
        for include in roots[-1].iter("include"):
            file = path.parent / include.get("file", "")
            waiting.append(inside(file, folder, f"{path}: <include>"))
    folders = {key: of for root in roots for one in root.iter("compiler") for key, of in one.items()}
    common = folders.get("assetdir", "")
    for root in roots:
        for element in root.iter():
            kind = "texturedir" if element.tag == "texture" else "meshdir"
            beside = path.parent / folders.get(kind, common)
            files = [name for key, name in element.items() if key.startswith("file")]
            for name in files if element.tag != "include" else ():
                _check_picture(inside(beside / name, folder, f"{path}: <{element.tag}>"), path)
            for sides in (("nrow", "ncol"), ("width", "height")):
                _check_cells((element.get(side, "1") for side in sides), f"{path}: <{element.tag}>")
        _check_copies(root, 1, path)


def _check_picture(file: Path, path: Path) -> None:
    """Checks a PNG by the sizes in its head; other files are as large as what they hold."""
    if file.is_file():
        with file.open("rb") as picture:
            head = picture.read(24)
        if head.startswith(PNG):
            sides = (str(int.from_bytes(head[at : at + 4], "big")) for at in (16, 20))
            _check_cells(sides, f"{path}: {file.name}")


def _check_cells(sides: Iterable[str], where: str) -> None:
    numbers = [float(side) if side.strip().isdecimal() else 1.0 for side in sides]
    if math.prod(numbers) > MOST_CELLS:
        size = " x ".join(f"{number:.0f}" for number in numbers)
        raise UsageError(f"{where}: {size} cells are more than {MOST_CELLS:,}; give coarser ones")


def _check_copies(element: ET.Element, copies: float, path: Path) -> None:
    numbers = [float(word) for word in element.get("count", "").split() if word.isdecimal()]
    copies *= math.prod(numbers)
    if copies > MOST_COPIES:
        raise UsageError(
            f"{path}: <{element.tag}> makes {copies:.0f} copies, more than {MOST_COPIES:,}; give fewer"
        )
    for child in element:
        _check_copies(child, copies, path)


def check_quantities(model: mujoco.MjModel, path: Path) -> None:
    """Checks a model, compiled alone; UsageError if a friction, mass or the like can be no rover's.

    Nor may it switch off or add what its world needs or lacks, for its options are the world's, nor be
    held by the world.
    """
    options = model.opt
    for flag in NEEDED:
        if options.disableflags & getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag.upper()}"):
            raise UsageError(f'{path}: no rover drives so; take <flag {flag}="disable"/> out')
    added = [name for name in MEDIUM if np.any(getattr(options, name))]
    added += ["actuatorgroupdisable"] if options.disableactuator else []
    if added:
        raise UsageError(f"{path}: no rover drives so; take {' and '.join(added)} out of <option>")
    x, y, z = options.gravity.tolist()
    if x or y or z >= 0.0:
        raise UsageError(f"{path}: gravity {x:g} {y:g} {z:g} does not point down; give 0 0 -9.81")
    bodies = np.isin(model.eq_type, TIES) & (model.eq_objtype == mujoco.mjtObj.mjOBJ_BODY)
    if model.eq_active0[bodies & ((model.eq_obj1id == 0) | (model.eq_obj2id == 0))].any():
        raise UsageError(f"{path}: an <equality> ties the rover to the world; take it out")
    for quantity, unit, low, high, kind, array in _QUANTITIES:
        values = np.asarray(getattr(model, array), float)
        values = values.reshape(len(values), values.size // max(1, len(values)))  # there may be none
        wrong = np.argwhere(~((values >= low) & (values <= high)))
        if wrong.size:
            row, column = wrong[0]
            owner = int(model.dof_jntid[row]) if array.startswith("dof") else int(row)
            name = getattr(model, kind)(owner).name
            raise UsageError(
                f"{path}: {quantity} {values[row, column]:g}{unit} of {kind} '{name}' is not valid; "
                f"give {low:g} to {high:g}{unit}"
            )
