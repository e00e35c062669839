"""Cells of the CSV files that are written here."""

from rover_metrics.core.row import Field

FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n")  # what spreadsheets take for the beginning of one


def harmless(cell: Field) -> Field:
    """Give text that would start a formula with an apostrophe before it; numbers as they are.

    What is in a note, or in the name of a log, may come from strangers, and a spreadsheet that opens the
    file would run it (OWASP, CSV injection).
    """
    return f"'{cell}" if isinstance(cell, str) and cell.startswith(FORMULA) else cell
