"""A world from an SDF file, or from a mesh alone."""

import hashlib
from dataclasses import replace
from pathlib import Path

from harness.base.errors import UsageError
from harness.world.sdf.document import Document, read_document
from harness.world.sdf.poses import IDENTITY
from harness.world.sdf.resources import Resources
from harness.world.solids.assembly import assembled
from harness.world.solids.solid import MeshFile, Solid
from harness.world.terrain_file import WORLDS, TerrainFile
from harness.world.world import World


def solid_world(file: TerrainFile, seed: int) -> World:
    """Makes a world from an SDF file or a mesh.

    Raises:
        UsageError: It or a file that it names is not readable, or nothing of it can be driven.
    """
    resources = Resources(file.folders)
    try:
        if file.path.suffix.lower() in WORLDS:
            return _of_document(read_document(file.path, resources), file, seed)
        solid = Solid(file.path.stem, MeshFile(file.path), IDENTITY)
        return assembled(file.path.name, [solid], file, seed, [])
    except UsageError as error:
        told = str(error)
        for prefix in (f"{file.path}: ", f"mesh {file.path}: ", f"{file.path} "):
            told = told.removeprefix(prefix)
        raise UsageError(f"terrain {file.path}: {told}") from error


def _of_document(document: Document, file: TerrainFile, seed: int) -> World:
    notes = [*document.notes]
    if document.actors:
        notes.append(f"actors: {', '.join(person.name for person in document.actors)}")
    world = assembled(file.path.name, document.solids, file, seed, notes)
    files = ((str(path), _hash(path)) for path in dict.fromkeys(document.files))
    return replace(world, gravity=document.gravity, files=(*files, *world.files))


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
