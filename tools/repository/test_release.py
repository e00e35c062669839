"""What a release says of itself, and the workflows that make it; `make dist` checks their schemas."""

import re
from pathlib import Path
from typing import Any

import pytest
import tomllib
from ruamel.yaml import YAML

import harness

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
WORKFLOWS = sorted((ROOT / ".github/workflows").glob("*.yml"))
FORMS = sorted((ROOT / ".github/ISSUE_TEMPLATE").glob("[!c]*.yml"))
PYTHONS = ["3.11", "3.12", "3.13"]
OWNER = PROJECT["urls"]["Homepage"].split("/")[-2]  # the one place; the others repeat it


def yaml(path: Path) -> Any:  # noqa: ANN401 - whatever it says
    return YAML(typ="safe").load(path.read_text())


def steps(path: Path) -> list[dict[str, Any]]:
    return [step for job in yaml(path)["jobs"].values() for step in job["steps"]]


def test_every_place_that_names_the_version_names_this_one() -> None:
    version = harness.__version__
    assert yaml(ROOT / "CITATION.cff")["version"] == version
    changes = (ROOT / "CHANGELOG.md").read_text()
    headings = re.findall(r"^## \[(.*?)\](?: - \d{4}-\d\d-\d\d)?$", changes, re.MULTILINE)
    assert headings[:2] == ["Unreleased", version]
    assert re.findall(r"^\[(.*?)\]: https://\S+$", changes, re.MULTILINE) == headings


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_is_bounded_may_little_and_runs_verbs_that_exist(path: Path) -> None:
    workflow = yaml(path)
    assert workflow.keys() <= {"name", "on", "permissions", "concurrency", "jobs"}
    assert workflow["permissions"] == {"contents": "read"}
    verbs = set(re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    for job in workflow["jobs"].values():
        assert job["timeout-minutes"] <= 90
        assert job.keys() >= {"runs-on", "steps"}
    for step in steps(path):
        assert len({"uses", "run"} & step.keys()) == 1
        assert re.fullmatch(r"[\w/-]+@(v\d+|release/v1)", step.get("uses", "a/b@v1"))
        script = step.get("run", "")
        assert "${{" not in script  # what others wrote is data, never shell
        assert set(re.findall(r"\bmake ([a-z]+)", script)) <= verbs
        assert all((ROOT / name).is_file() for name in re.findall(r"^\.[\w/]+", script))


def test_ci_tries_every_python_that_the_project_names() -> None:
    matrix = yaml(ROOT / ".github/workflows/ci.yml")["jobs"]["test"]["strategy"]["matrix"]
    assert matrix["python-version"] == PYTHONS
    named = [word for word in PROJECT["classifiers"] if "Python ::" in word]
    assert [word.rpartition(" ")[2] for word in named] == PYTHONS
    low, high = re.findall(r"3\.\d+", PROJECT["requires-python"])
    assert (low, high) == (PYTHONS[0], "3.14")


def test_only_the_jobs_that_publish_get_a_token_and_what_they_publish_was_built_before() -> None:
    for path in WORKFLOWS:
        for job in yaml(path)["jobs"].values():
            if "id-token" in job.get("permissions", {}):
                assert job["needs"] == "build"
                assert all("run" not in step for step in job["steps"])
                assert not any("checkout" in step["uses"] for step in job["steps"])


def test_a_form_asks_for_what_it_must_have() -> None:
    for path in FORMS:
        form = yaml(path)
        assert form.keys() == {"name", "description", "labels", "body"}
        assert any(part.get("validations", {}).get("required") for part in form["body"])
        ids = [part["id"] for part in form["body"]]
        assert len(set(ids)) == len(ids)


def test_every_place_names_the_owner_that_the_project_names() -> None:
    texts = [*WORKFLOWS, *ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), ROOT / "CITATION.cff"]
    texts += [ROOT / "pyproject.toml", ROOT / ".github/ISSUE_TEMPLATE/config.yml"]
    for path in texts:
        owners = re.findall(
            r"github\.com/([^/\s]+)/rover-harness|(\w+)\.github\.io/rover", path.read_text()
        )
        assert {owner for both in owners for owner in both if owner} <= {OWNER}, path
    assert f"`{OWNER}`" in (ROOT / "CONTRIBUTING.md").read_text()


def test_the_badges_say_what_the_project_is() -> None:
    badges = re.findall(r"^\[!\[.*", (ROOT / "README.md").read_text(), re.MULTILINE)
    assert "python-" + "%20%7C%20".join(PYTHONS) in "".join(badges)
    assert f"licence-{PROJECT['license'].replace('-', '--')}-" in "".join(badges)


def test_a_newcomer_reads_no_name_that_stands_for_another() -> None:
    pages = [ROOT / "README.md", *ROOT.glob("docs/*.md")]
    assert [path.name for path in pages if re.search(r"\bOWNER\b", path.read_text())] == []
