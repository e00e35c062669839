"""The documents: what they have from the code, and the site that they are.

python -m tools.site write          renews what documents have from the code
python -m tools.site check          names the documents that are not what the code gives
python -m tools.site build          writes build/docs and build/mkdocs.yml, for `make docs`
"""

import argparse
import json
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from tools.site.documents import MEASURED, UnknownPart, outdated
from tools.site.generated import generated
from tools.site.links import REPOSITORY, BrokenLinks, Links
from tools.site.notebooks import as_markdown
from tools.site.pages import ROOT, navigation, sources

ASSETS = Path(__file__).with_name("assets")
CONFIG = Path(__file__).with_name("mkdocs.yml")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 1 if a link leads nowhere or a document is outdated."""
    parser = argparse.ArgumentParser(prog="python -m tools.site", description=__doc__.splitlines()[0])
    about = "write or check what documents have from the code, or build the site's pages"
    parser.add_argument("what", choices=("write", "check", "build"), help=about)
    what = parser.parse_args(arguments).what
    try:
        if what == "build":
            build(ROOT / "build")
            return 0
        return _renew(write=what == "write")
    except (BrokenLinks, UnknownPart) as error:
        print(f"tools.site: {error}", file=sys.stderr)
        return 1


def _renew(*, write: bool) -> int:
    files = list(outdated(without=() if write else MEASURED))
    for path, text in files:
        if write:
            path.write_text(text, encoding="utf-8")
        mend = "" if write else " is not what the code gives; run: python -m tools.site write"
        print(f"{'wrote ' if write else ''}{path.relative_to(ROOT)}{mend}")
    return 0 if write else int(bool(files))


def build(folder: Path) -> None:
    """Writes the site's pages to FOLDER/docs, made anew, and mkdocs' configuration beside them.

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
        return as_markdown(document, {"LOGS": logs / document.stem}, {})
    return document.read_text(encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
