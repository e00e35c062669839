"""Images of ArUco markers, from OpenCV's published dictionaries: cv2.aruco's own, without its 70 MB."""

from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.spec.target import DICTIONARIES

CODES = Path(__file__).with_name("aruco.txt")
CELL = 16  # [pixels] of a cell in an image


@lru_cache(maxsize=1)
def _codes() -> dict[str, str]:
    lines = CODES.read_text(encoding="ascii").splitlines()
    return dict(line.split(maxsplit=1) for line in lines if not line.startswith("#"))


def cells(dictionary: str, marker: int) -> NDArray[np.bool_]:
    """Returns which cells of the marker of an id are white, shape (n + 2, n + 2); its border is not."""
    _, n = DICTIONARIES[dictionary]
    digits = -(-n * n // 4)
    codes = _codes()
    code = codes.get(dictionary) or codes[dictionary.rpartition("_")[0]]
    number = int(code[digits * marker :][:digits], 16)
    bits = [number >> place & 1 for place in reversed(range(n * n))]
    return np.pad(np.array(bits, bool).reshape(n, n), 1)


@lru_cache(maxsize=64)
def face_image(dictionary: str, marker: int) -> NDArray[np.uint8]:
    """Returns a marker in a white margin of one cell, as URC prints it: RGB, shape (p, p, 3)."""
    white = np.pad(cells(dictionary, marker), 1, constant_values=True)
    grey = np.kron(white, np.full((CELL, CELL), 255)).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)


def face_edge(dictionary: str, size: float) -> float:
    """Returns the edge of a face by that of its marker's black square [m]: 0.2 m of 0.15 m in 4x4."""
    _, n = DICTIONARIES[dictionary]
    return size * (n + 4) / (n + 2)
