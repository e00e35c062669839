"""What the documents hold: their blocks of code, and the commands in them."""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
NAMED = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "examples/nav2/README.md")
PAGES = (
    *NAMED,
    "models/README.md",
    "benchmarks/README.md",
    *(f"docs/{p.name}" for p in ROOT.glob("docs/*.md")),
)
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Block:
    """A fenced block of code; `language` is empty where it is no code."""

    language: str
    text: str


def blocks(page: str, *languages: str) -> list[Block]:
    """Returns the blocks of a page, in these languages or in all."""
    found = (Block(*match) for match in BLOCK.findall((ROOT / page).read_text()))
    return [block for block in found if not languages or block.language in languages]


def commands(text: str, **variables: str) -> Iterator[list[str]]:
    """Yields the words of each command of a shell's block, those of a loop once, variables replaced."""
    for line in text.splitlines():
        words = shlex.split(line, comments=True)
        if not words or words[0] in ("for", "done"):
            continue
        words = [re.sub(r"\$(\w+)", lambda m: variables.get(m[1], m[0]), word) for word in words]
        while "&&" in words:
            yield words[: words.index("&&")]
            words = words[words.index("&&") + 1 :]
        yield words
