"""Notebooks: run as Jupyter runs them, and written as Markdown with what their cells print and draw."""

import ast
import base64
import contextlib
import io
import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt

# The tag of the cell whose names may be given other values, as papermill has it.
PARAMETERS = "parameters"


def as_markdown(notebook: Path, given: Mapping[str, object], names: dict[str, Any]) -> str:
    """Returns a notebook as Markdown, each code cell with its output; runs it in its folder.

    Args:
        notebook: The file.
        given: Values instead of those in the cells with the tag `parameters`, by name.
        names: Gets what the cells define.
    """
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    parts: list[str] = []
    with _started_in(notebook.parent.resolve()):
        for cell in cells:
            source = "".join(cell["source"])
            if cell["cell_type"] == "code":
                parts += [f"```python\n{source}\n```", *_outputs(source, names)]
            else:
                parts.append(source)
            if PARAMETERS in cell["metadata"].get("tags", ()):
                names.update({name: value for name, value in given.items() if name in names})
    return "\n\n".join(parts) + "\n"


def _outputs(source: str, names: dict[str, Any]) -> Iterator[str]:
    """Runs a cell; yields its text and its figures."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        value = _run(source, names)
        if value is not None and not source.rstrip().endswith(";"):
            print(value)
    if text.getvalue():
        yield f"```text\n{text.getvalue().rstrip()}\n```"
    yield from _figures()


def _run(source: str, names: dict[str, Any]) -> object:
    """Runs a cell and returns the value of its last line, if that is an expression."""
    *lines, last = ast.parse(source).body
    if not isinstance(last, ast.Expr):
        exec(compile(source, "<cell>", "exec"), names)  # noqa: S102 - our own notebook
        return None
    exec(compile(ast.Module(lines, []), "<cell>", "exec"), names)  # noqa: S102 - our own notebook
    return eval(compile(ast.Expression(last.value), "<cell>", "eval"), names)  # noqa: S307 - our own notebook


def _figures() -> Iterator[str]:
    """Yields the open figures as pictures within the page, and closes them."""
    for number in plt.get_fignums():
        picture = io.BytesIO()
        plt.figure(number).savefig(picture, format="png", dpi=110)
        plt.close(number)
        encoded = base64.b64encode(picture.getvalue()).decode()
        yield f"![What the cell draws](data:image/png;base64,{encoded})"


@contextlib.contextmanager
def _started_in(folder: Path) -> Iterator[None]:
    """The working folder, and where imports are looked for first, as a notebook in it has them."""
    sys.path.insert(0, str(folder))
    try:
        with contextlib.chdir(folder):
            yield
    finally:
        sys.path.remove(str(folder))
