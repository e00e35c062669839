"""CSV files as everybody writes them: commas, semicolons or tabs, decimal points or decimal commas."""

import gzip
import io
import warnings
import zlib
from pathlib import Path
from typing import Any

import pandas as pd

from harness.base.documents import read_bytes
from harness.base.errors import UsageError
from rover_metrics.analysis.logs.header import comma_in_cells

MOST_BYTES = 2**30


def read_csv(path: Path, largest: int = MOST_BYTES, **how: Any) -> pd.DataFrame:  # noqa: ANN401 - as of pandas
    """Returns a file's columns as they are; UsageError if it is no CSV, or holds more than its header.

    Args:
        path: Of a file, which may be compressed (.gz).
        largest: How many bytes it may have.
        how: What else pandas is told.
    """
    try:
        content = read_bytes(path, largest)
        content = gzip.decompress(content) if path.suffix == ".gz" else content
        separator = max(b",", b";", b"\t", key=content.partition(b"\n")[0].count)
        commas_are_decimal = comma_in_cells(content.splitlines()[1:], separator.decode()) == "."
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            table: pd.DataFrame = pd.read_csv(
                io.BytesIO(content),
                encoding="utf-8-sig",
                skipinitialspace=True,
                sep=separator.decode(),
                decimal="," if commas_are_decimal else ".",
                thousands=None if commas_are_decimal or separator == b"," else ",",
                index_col=False,  # rows longer than the header would be shifted
                **how,
            )
    except pd.errors.ParserWarning:
        raise UsageError(
            f"{path}: its rows have more values than its header has names; name each, and separate by "
            "semicolons where decimals have commas"
        ) from None
    except (OSError, EOFError, ValueError, zlib.error) as error:
        raise UsageError(f"{path} cannot be read as CSV: {str(error).splitlines()[0]}") from None
    table.columns = [str(name).strip() for name in table.columns]
    return table
