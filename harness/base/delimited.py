"""CSV files as everybody writes them: commas, semicolons or tabs, decimal points or decimal commas."""

import codecs
import gzip
import io
import re
import warnings
import zlib
from pathlib import Path
from typing import Any

import pandas as pd

from harness.base.documents import read_bytes
from harness.base.errors import UsageError
from rover_metrics.analysis.logs.header import comma_in_cells
from rover_metrics.log.files import packer_of

MOST_BYTES = 2**30
SEPARATORS = (",", ";", "\t", "|")
BLANKS = r"\s+"  # where there are none of these, as of numpy
COMMENTS = "#", "%", "sep="  # the last is Excel's
MINUS = "\u2212"  # as programs write it in the languages of the north


def read_csv(path: Path, largest: int = MOST_BYTES, **how: Any) -> pd.DataFrame:  # noqa: ANN401 - as of pandas
    """Returns a file's columns as they are; UsageError if it is no CSV, or holds more than its header.

    Args:
        path: Of a file, which may be compressed (.gz).
        largest: How many bytes it may have.
        how: What else pandas is told.

    Of columns of one name the first is given.
    """
    try:
        content = read_bytes(path, largest)
        content = gzip.decompress(content) if packer_of(content) == "gzip" else content
        text = _below_comments(_text(content))
        if not text.strip() or "\0" in text:
            what = "has bytes that are no text" if text.strip() else "holds nothing"
            raise UsageError(f"{path} {what}; give a line with the names of columns, and rows below it")
        header, _, rows = text.partition("\n")
        mark = max(SEPARATORS, key=header.count)
        separator = mark if mark in header else BLANKS
        between = re.escape(mark) if mark in header else BLANKS
        commas_are_decimal = comma_in_cells(rows.encode().splitlines(), between) == "."
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            table: pd.DataFrame = pd.read_csv(
                io.StringIO(text),
                skipinitialspace=True,
                sep=separator,
                decimal="," if commas_are_decimal else ".",
                thousands=None if commas_are_decimal else ",",
                index_col=False,  # rows longer than the header would be shifted
                **how,
            )
    except pd.errors.ParserWarning:
        raise UsageError(
            f"{path}: its rows have more values than its header has names; name each, and separate by "
            "semicolons where decimals have commas"
        ) from None
    except UnicodeDecodeError:
        raise UsageError(f"{path} is no text; give CSV in UTF-8") from None
    except (OSError, EOFError, ValueError, zlib.error) as error:
        raise UsageError(f"{path} cannot be read as CSV: {str(error).splitlines()[0]}") from None
    table.columns = [str(name).strip() for name in table.columns]
    return table.loc[:, ~table.columns.duplicated()]


def _text(content: bytes) -> str:
    """A file's text: UTF-8 or, where its first bytes say so, UTF-16, else what Windows writes."""
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16").replace(MINUS, "-")
    try:
        return content.decode("utf-8-sig").replace(MINUS, "-")
    except UnicodeDecodeError:
        return content.decode("cp1252")


def _below_comments(text: str) -> str:
    """A text without the comments above its header, which may be the last of them, as of numpy."""
    if not text.startswith(COMMENTS):
        return text
    lines = text.split("\n")
    first = next((n for n, line in enumerate(lines) if not line.startswith(COMMENTS)), 1)
    header = lines[first - 1].lstrip("#% ")
    marks = [mark for mark in SEPARATORS if mark in lines[first]] or [" "]
    is_header = any(0 < header.count(mark) == lines[first].count(mark) for mark in marks)
    return "\n".join([header, *lines[first:]] if is_header else lines[first:])
