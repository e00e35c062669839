"""Writes the site's pages and its configuration, for mkdocs to build. Called by `make docs`.

    python -m tools.site build

Leaves FOLDER/docs (Markdown and pictures) and FOLDER/mkdocs.yml.
"""

import argparse
import json
import shutil
import sys
from pathlib import Path

from tools.site.generated import generated
from tools.site.links import REPOSITORY, BrokenLinks, Links
from tools.site.notebooks import told
from tools.site.pages import ROOT, navigation, sources

ASSETS = Path(__file__).with_name("assets")
CONFIG = Path(__file__).with_name("mkdocs.yml")


def main() -> int:
    """Runs the command; returns its exit code: 1 if a link leads nowhere."""
    parser = argparse.ArgumentParser(prog="python -m tools.site", description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="gets docs/ and mkdocs.yml; made anew")
    folder: Path = parser.parse_args().folder
    try:
        write(folder)
    except BrokenLinks as error:
        print(f"tools.site: {error}", file=sys.stderr)
        return 1
    return 0


def write(folder: Path) -> None:
    """Writes the pages and the configuration.

    Raises:
        BrokenLinks: A link of a document leads nowhere.
    """
    docs, logs = folder / "docs", folder.resolve() / "logs"  # notebooks run in their own folder
    for old in (docs, logs):
        shutil.rmtree(old, ignore_errors=True)
    shutil.copytree(ASSETS, docs / "assets")
    pages, made = sources(), generated()
    links = Links(pages)
    texts = {page: _text(ROOT / source, logs) for page, source in pages.items()}
    written = {page: links.rewritten(texts[page], source, page) for page, source in pages.items()} | made
    links.check()
    for page, text in written.items():
        (docs / page).parent.mkdir(parents=True, exist_ok=True)
        (docs / page).write_text(text, encoding="utf-8")
    for picture in links.pictures:
        (docs / "files" / picture).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / picture, docs / "files" / picture)
    # JSON is YAML, but for the tags of mkdocs.yml, which stays what it is.
    config = {
        "INHERIT": str(CONFIG),
        "nav": navigation(pages),
        "docs_dir": "docs",
        "site_dir": "site",
        # Not repo_url, which would ask GitHub for stars.
        "extra": {"social": [{"icon": "fontawesome/brands/github", "link": REPOSITORY}]},
    }
    (folder / "mkdocs.yml").write_text(json.dumps(config, indent=1))


def _text(document: Path, logs: Path) -> str:
    """A document as Markdown; a notebook writes its logs there."""
    if document.suffix == ".ipynb":
        return told(document, {"LOGS": logs / document.stem}, {})
    return document.read_text(encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
