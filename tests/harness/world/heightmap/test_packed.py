"""packed.tar.xz: one pattern in each kind of number, by tifffile 2026.3.3 with imagecodecs 2026.3.6."""

import io
import tarfile
from pathlib import Path

import numpy as np
import pytest
import tifffile

from harness.base.errors import UsageError
from harness.world.heightmap.packed import READABLE, unpacked


@pytest.fixture(scope="module")
def files() -> dict[str, bytes]:
    with tarfile.open(Path(__file__).with_name("packed.tar.xz")) as archive:
        members = {member.name: archive.extractfile(member) for member in archive}
        return {name: file.read() for name, file in members.items() if file is not None}


def page_of(data: bytes) -> tifffile.TiffPage:
    page = tifffile.TiffFile(io.BytesIO(data)).pages.first
    assert isinstance(page, tifffile.TiffPage)
    return page


def pattern(kind: str) -> np.ndarray:
    row, column = np.mgrid[0:23, 0:19]
    values = ((7 * row + column * column) % 50).astype(kind)
    limits = (-1e3, 1e3) if values.dtype.kind == "f" else (np.iinfo(kind).min, np.iinfo(kind).max)
    values[3, 4], values[20, 17] = limits
    return np.asarray(values)


def test_every_number_compression_predictor_layout_and_byte_order_is_read_as_written(
    files: dict[str, bytes],
) -> None:
    seen = set()
    for name, data in files.items():
        page, kind = page_of(data), name.partition("-")[0]
        read = unpacked(page)
        seen.add(int(page.compression))
        assert read.dtype == np.dtype(kind), name
        np.testing.assert_array_equal(read, pattern(kind), name)
    assert seen == set(READABLE) - {32946}  # an old number for deflate


def test_a_part_that_holds_too_little_is_damaged_and_an_unknown_predictor_named(
    files: dict[str, bytes],
) -> None:
    page = page_of(files["float32-zlib-strips.tif"])
    page.databytecounts = (9, *page.databytecounts[1:])
    with pytest.raises(ValueError, match=r"reshape|buffer"):
        unpacked(page)
    page = page_of(files["int16-lzw-strips.tif"])
    page.predictor = 7
    with pytest.raises(UsageError, match="predictor 7"):
        unpacked(page)


def test_a_part_that_was_never_written_holds_no_data(files: dict[str, bytes]) -> None:
    page = page_of(files["float32-zlib-strips.tif"])
    page.nodata, page.databytecounts = -5.0, (0, *page.databytecounts[1:])
    read, rows = unpacked(page), page.chunks[0]
    assert (read[:rows] == -5.0).all()
    np.testing.assert_array_equal(read[rows:], pattern("float32")[rows:])
