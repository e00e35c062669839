"""Links between documents: right on GitHub as they stand, rewritten for the site."""

import os
import re
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

import tomllib

from tools.site.pages import ROOT

REPOSITORY: str = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["urls"]["Homepage"]
PICTURES = (".gif", ".jpg", ".png", ".svg", ".webp")
# GitHub's to show: the site asks for nothing elsewhere.
BADGE = re.compile(r"^\[!\[[^\n]*\n", re.MULTILINE)
# Code comes first, so that what it holds is no link.
LINK = re.compile(r"^```.*?^```|`[^`\n]*`|\]\((?P<target>[^)\s]+)\)", re.DOTALL | re.MULTILINE)


class BrokenLinks(Exception):
    """Links that lead nowhere; the message names them."""


class Links:
    """Rewrites the links of documents, and remembers what they need.

    Args:
        pages: The document of each page, below the repository's root.

    Attributes:
        pictures: Those that pages show, below the repository's root; the site has them in files/.
        broken: Links that lead nowhere, with their document.
    """

    def __init__(self, pages: Mapping[str, Path]) -> None:
        self._page_of = {str(source): page for page, source in pages.items()}
        self.pictures: set[str] = set()
        self.broken: list[str] = []

    def rewritten(self, text: str, source: Path, page: str) -> str:
        """Returns a document's text with links that hold on the site.

        Args:
            text: The text.
            source: The document, below the repository's root.
            page: Its place on the site.
        """

        def replaced(match: re.Match[str]) -> str:
            target = match["target"]
            return match[0] if target is None else f"]({self._target(target, source, page)})"

        return LINK.sub(replaced, BADGE.sub("", text))

    def check(self) -> None:
        """Checks that all links led somewhere.

        Raises:
            BrokenLinks: Some did not.
        """
        if self.broken:
            raise BrokenLinks(f"links that lead nowhere: {'; '.join(self.broken)}")

    def _target(self, target: str, source: Path, page: str) -> str:
        if re.match(r"[a-z]+:|#", target):
            return target
        path, sharp, anchor = target.partition("#")
        place = os.path.normpath(source.parent / path)
        if place in self._page_of:
            return _relative(self._page_of[place], page) + sharp + anchor
        if not (ROOT / place).exists() or place.startswith(".."):
            self.broken.append(f"{target} in {source}")
        if place.endswith(PICTURES):
            self.pictures.add(place)
            return _relative(f"files/{place}", page)
        kind = "tree" if (ROOT / place).is_dir() else "blob"
        return f"{REPOSITORY}/{kind}/main/{place}{sharp}{anchor}"


def _relative(to: str, page: str) -> str:
    return PurePosixPath(os.path.relpath(to, PurePosixPath(page).parent)).as_posix()
