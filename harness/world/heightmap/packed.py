"""Pixels of compressed TIFFs: predictors undone, every type of number.

tifffile does this only with a package of codecs; Pillow reads some of these types as others. Each part
(strip or tile) is unpacked to the size that it must have and no further.
"""

import io
import struct
import zlib

import numpy as np
import tifffile
from numpy.typing import NDArray
from PIL import Image

from harness.base.errors import UsageError

DEFLATE = (8, 32946)  # TIFF's numbers of compressions
BY_LIBTIFF = (5, 32773, 34925, 50000)  # LZW, PackBits, LZMA, Zstandard
READABLE = DEFLATE + BY_LIBTIFF
PLAIN, DIFFERENCES, FLOAT_DIFFERENCES = 1, 2, 3  # TIFF's predictors
SHORT, LONG = 3, 4  # TIFF's types


def unpacked(page: tifffile.TiffPage) -> NDArray[np.generic]:
    """Returns the pixels of one band whose compression is READABLE, as the file's type of number."""
    assert page.dtype is not None  # noqa: S101 - the caller has looked
    # What is not there is empty, says GDAL (SPARSE_OK): no data, or 0 if nothing says what that is.
    image = np.full(page.shape, page.nodata, page.dtype.newbyteorder("="))
    rows, _ = page.shape
    height, width = page.chunks
    across = -(-page.shape[1] // width)
    file = page.parent.filehandle
    for part, (offset, count) in enumerate(zip(page.dataoffsets, page.databytecounts, strict=True)):
        if not count:
            continue
        top, left = part // across * height, part % across * width
        lines = height if page.is_tiled else min(height, rows - top)
        file.seek(offset)
        packed, size = file.read(count), lines * width * page.dtype.itemsize
        is_deflated = page.compression in DEFLATE
        data = _inflated(packed, size) if is_deflated else _by_libtiff(packed, size, page.compression)
        pixels = _restored(data, (lines, width), page)
        target = image[top : top + lines, left : left + width]
        target[:] = pixels[: target.shape[0], : target.shape[1]]
    return image


def _inflated(packed: bytes, size: int) -> bytes:
    data = zlib.decompressobj().decompress(packed, size + 1)
    if len(data) > size:
        raise UsageError("a part of it unpacks to more than its size")
    return data


def _by_libtiff(packed: bytes, size: int, compression: int) -> bytes:
    """Unpacked by libtiff, to which it is a picture of one row of grey bytes."""
    tags = {
        256: size,
        257: 1,
        258: 8,
        259: compression,
        262: 1,
        273: 0,
        277: 1,
        278: 1,
        279: len(packed),
    }
    tags[273] = 8 + 2 + 12 * len(tags) + 4  # behind this header
    header = struct.pack("<2sHIH", b"II", 42, 8, len(tags))
    for tag, value in tags.items():
        header += struct.pack("<HHII", tag, SHORT if value < 1 << 16 else LONG, 1, value)
    with Image.open(io.BytesIO(header + bytes(4) + packed), formats=("TIFF",)) as image:
        return image.tobytes()


def _restored(data: bytes, shape: tuple[int, int], page: tifffile.TiffPage) -> NDArray[np.generic]:
    """Numbers of the machine's byte order from bytes that a predictor has changed."""
    assert page.dtype is not None  # noqa: S101 - as above
    lines, width = shape
    order, size = page.parent.byteorder, page.dtype.itemsize
    if page.predictor == FLOAT_DIFFERENCES:
        # Of each row first all highest bytes, then all second ones; each byte less the one before.
        planes = np.frombuffer(data, np.uint8).reshape(lines, size * width).cumsum(1, np.uint8)
        pixels = np.ascontiguousarray(planes.reshape(lines, size, width).swapaxes(1, 2))
        return pixels.view(page.dtype.newbyteorder(">")).reshape(shape)
    if page.predictor == DIFFERENCES:
        steps = np.frombuffer(data, f"{order}u{size}").reshape(shape)
        return steps.cumsum(1, f"u{size}").view(page.dtype.newbyteorder("="))
    if page.predictor != PLAIN:
        raise UsageError(f"its predictor {page.predictor} is not one of TIFF's")
    return np.frombuffer(data, page.dtype.newbyteorder(order)).reshape(shape)
