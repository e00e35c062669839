"""A benchmark's table for the terminal."""

from rich import table as rich_table

from benchmarks.measuring import Table


def printable(table: Table) -> rich_table.Table:
    """The table as rich draws it."""
    printable = rich_table.Table(title=table.title, title_justify="left")
    for index, column in enumerate(table.columns):
        printable.add_column(column, justify="right" if index else "left")
    for row in table.rows:
        printable.add_row(*(_bold(cell) for cell in row))
    return printable


def _bold(cell: str) -> str:
    """Markdown's bold, which the cells use, as rich writes it."""
    bare = cell.replace("**", "")
    return f"[bold]{bare}[/]" if bare != cell else cell
