"""The files of which a rover is made."""

import hashlib
from pathlib import Path

from harness.robots.spec import RoverSpec

MODELS_DIR = next(
    folder
    for folder in (Path(__file__).parents[1] / "models", Path(__file__).parents[2] / "models")
    if folder.is_dir()
)
# Of what a rover is made; pictures of it and notes about it do not change it.
CONTENT = {".yaml", ".xml", ".stl", ".obj", ".msh"}


def content_of(folder: Path) -> list[Path]:
    """Returns the files of a folder that make its rover, in the order of their names."""
    files = (path for path in folder.rglob("*") if path.suffix.lower() in CONTENT)
    return sorted(path for path in files if path.is_file())


def model_hash(rover: RoverSpec) -> str:
    """Returns the SHA-256 of a shipped rover's model file; of another's that of its folder's content."""
    if rover.folder.parent == MODELS_DIR:
        return hashlib.sha256(rover.model_path.read_bytes()).hexdigest()
    content = hashlib.sha256()
    for path in content_of(rover.folder):
        data = path.read_bytes()
        content.update(f"{path.relative_to(rover.folder)} {len(data)}\n".encode() + data)
    return content.hexdigest()
