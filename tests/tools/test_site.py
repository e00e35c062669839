"""The site: its pages, their links and what is generated; built if `make docs` has put mkdocs there."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import tomllib

from harness.world.terrains import TERRAINS
from tests.support.documents import PAGES
from tools.site.__main__ import build, main
from tools.site.documents import FILES, MEASURED, PART, PARTS, part
from tools.site.links import BrokenLinks, Links
from tools.site.pages import ROOT, sources

MKDOCS = ROOT / "build/environments/docs/bin/mkdocs"
BLOB = "https://github.com/OWNER/rover-harness/blob/main"


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")

    def told(notebook: Path, given: dict[str, Path], _: object) -> str:
        assert given["LOGS"] == folder / "logs" / notebook.stem  # wherever the notebook stands
        return f"# {notebook.stem}\n"

    with pytest.MonkeyPatch.context() as patch:  # tests/test_examples.py runs the notebooks
        patch.setattr("tools.site.__main__.as_markdown", told)
        patch.chdir(folder.parent)
        build(Path(folder.name))
    return folder


def page(folder: Path, name: str) -> str:
    return (folder / "docs" / name).read_text()


def test_every_page_is_in_the_navigation_once_and_every_entry_is_a_page(written: Path) -> None:
    told = json.loads((written / "mkdocs.yml").read_text())
    entries = [entry for section in told["nav"] for pages in section.values() for entry in pages]
    there = {str(path.relative_to(written / "docs")) for path in (written / "docs").rglob("*.md")}
    assert sorted(entries) == sorted(there)
    assert {path.name for path in (ROOT / "docs").glob("*.md")} < there
    assert Path(told["INHERIT"]).is_file()


def test_what_a_page_shows_or_links_to_is_on_the_site(written: Path) -> None:
    for path in (written / "docs").rglob("*.md"):
        text = re.sub(r"^```.*?^```|`[^`\n]*`", "", path.read_text(), flags=re.DOTALL | re.MULTILINE)
        for target in re.findall(r"\]\(([^)#\s]+)", text):
            if not re.match("[a-z]+:", target):
                assert (path.parent / target).is_file(), f"{target} in {path.name}"


LINKS = {
    "](testing.md#faults)": "](testing.md#faults)",
    "](../CONTRIBUTING.md)": "](contributing.md)",
    "](../harness/config.py)": f"]({BLOB}/harness/config.py)",
    "](../scenarios)": f"]({BLOB.replace('blob', 'tree')}/scenarios)",
    "![A](rocky.png)": "![A](files/docs/rocky.png)",
    "](https://mujoco.org)": "](https://mujoco.org)",
    "](#here)": "](#here)",
    "](../examples/learn.ipynb)": "](notebooks/learn.md)",
    "![A](data:image/png;base64,a/b=)": "![A](data:image/png;base64,a/b=)",
    "`a[0](b.md)`": "`a[0](b.md)`",
    "```\nx](nowhere.md)\n```": "```\nx](nowhere.md)\n```",
}


DOCUMENT = Path("docs/a.md")


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A copy of what links lead to."""
    root = tmp_path / "repository"
    names = ("docs/testing.md", "docs/rocky.png", "CONTRIBUTING.md", "harness/config.py", "scenarios/a")
    for name in (*names, "../elsewhere.md"):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).touch()
    monkeypatch.setattr("tools.site.links.ROOT", root)


@pytest.mark.usefixtures("repository")
@pytest.mark.parametrize("link", LINKS)
def test_a_link_of_a_document_holds_on_the_site(link: str) -> None:
    links = Links(sources())
    assert links.rewritten(f"See\n{link}\n", DOCUMENT, "a.md") == f"See\n{LINKS[link]}\n"
    links.check()
    assert links.pictures == ({"docs/rocky.png"} if "rocky" in link else set())


@pytest.mark.usefixtures("repository")
@pytest.mark.parametrize("target", ["nowhere.md", "../../elsewhere.md"])
def test_a_link_that_leads_nowhere_is_named(target: str) -> None:
    links = Links(sources())
    links.rewritten(f"[a]({target})\n", DOCUMENT, "a.md")
    with pytest.raises(BrokenLinks, match=rf"^links that lead nowhere: {target} in docs/a.md$"):
        links.check()


def test_the_page_of_commands_has_the_help_of_each(written: Path) -> None:
    scripts = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
    text = page(written, "reference/commands.md")
    usages = re.findall(r"^## (\S+)\n\n`python -m \S+`\n\n```text\nusage: (\S+) ", text, re.MULTILINE)
    assert usages == [(name, name) for name in sorted(scripts) if name.startswith("rover-")]


def test_documents_have_what_the_code_gives_and_every_part_is_in_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    told = "".join((ROOT / page).read_text() for page in PAGES)
    assert {found[2] for found in PART.finditer(told)} == PARTS.keys()
    assert {path.stem for path in (ROOT / "docs/terrains").glob("*.webp")} == TERRAINS.keys()
    assert main(["check"]) == 0, capsys.readouterr().out
    shutil.copytree(ROOT / "docs", tmp_path / "docs")
    for name in ("models/README.md", *FILES):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copyfile(ROOT / name, tmp_path / name)
    topics = tmp_path / "docs/topics.md"
    topics.write_text(topics.read_text().replace("| `/scan` |", "| `/old` |"))
    for module in ("documents", "__main__"):
        monkeypatch.setattr(f"tools.site.{module}.ROOT", tmp_path)
    for name in MEASURED:
        monkeypatch.setitem(PARTS, name, lambda: "measured anew\n")
    part.cache_clear()
    assert main(["check"]) == 1
    assert capsys.readouterr().out.startswith(
        "docs/topics.md is not what the code gives; run: python -m"
    )
    assert main(["write"]) == main(["check"]) == 0
    part.cache_clear()
    assert topics.read_text() == (ROOT / "docs/topics.md").read_text()
    assert "\nmeasured anew\n" in (tmp_path / "models/README.md").read_text()
    topics.write_text("<!-- generated: chess -->\n<!-- end -->\n")
    assert main(["check"]) == 1
    part.cache_clear()
    assert "nothing generates 'chess'; available: topics, " in capsys.readouterr().err


def test_the_page_of_a_scenarios_keys_has_each_with_type_and_default(written: Path) -> None:
    text = page(written, "reference/scenario_file.md")
    rules = json.loads((ROOT / "scenarios/scenario.schema.json").read_text())
    assert set(rules["properties"]) <= set(re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE))
    assert "| `expect` | quantity: [Bound](#bound) or list of [Bound](#bound) |" in text


def test_the_site_shows_no_badges_and_names_the_repository_that_the_project_names(written: Path) -> None:
    assert "badge" in (ROOT / "README.md").read_text()
    assert "badge" not in page(written, "index.md")
    told = json.loads((written / "mkdocs.yml").read_text())["extra"]["social"]
    assert [entry["link"] for entry in told] == [BLOB.removesuffix("/blob/main")]


@pytest.mark.skipif(not MKDOCS.exists(), reason="needs mkdocs: make docs")
def test_mkdocs_builds_the_site_without_a_warning(written: Path) -> None:
    # mkdocstrings looks for the sources beside the folder that it is given.
    for name in ("harness", "rover_metrics"):
        (written.parent / name).symlink_to(ROOT / name)
    words: list[str | Path] = ["build", "--quiet", "--strict", "--config-file", written / "mkdocs.yml"]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    subprocess.run([MKDOCS, *words], env=environment, check=True, cwd=written)
    reference = (written / "site/reference/python.html").read_text()
    assert 'id="harness.episode.run.run_episode"' in reference
    assert (written / "site/search/search_index.js").exists()
    assert "https://fonts." not in reference
