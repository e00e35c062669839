"""docs/guarantees.md names a test for each promise; a name that no test has is a promise broken."""

import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

ROOT = Path(__file__).parents[2]
GUARANTEES = ROOT / "docs/guarantees.md"


def promised() -> Iterator[tuple[str, str]]:
    """Test files and beginnings of test names, as the last column of the tables gives them."""
    header = ""
    for before, line in pairwise(GUARANTEES.read_text().splitlines()):
        header = line if line.startswith("| ") and not before.startswith("|") else header
        if not line.startswith("| ") or line == header or not header.startswith("| promise"):
            continue
        for part in line.split("|")[-2].split(";"):
            found = re.match(r"\s*`([\w/]+\.py)`([^`]*)$", part)
            assert found, f"no test file in: {part}"
            yield found[1], ""
            for name in re.sub(r"\([^)]*\)", "", found[2]).split(","):
                yield found[1], name.strip()


def test_every_promise_has_its_test() -> None:
    promises = set(promised())
    folders = {file: ROOT if "/" in file else ROOT / "tests/rover_metrics" for file, _ in promises}
    texts = {file: (folder / file).read_text() for file, folder in folders.items()}
    assert [each for each in sorted(promises) if f"def test_{each[1]}" not in texts[each[0]]] == []
