"""What CI runs, ours and others': .ci/run, action.yml, shell of docs, steps of the Containerfile."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from harness.scenario.__main__ import main
from harness.scenario.verdict import Attempt

ROOT = Path(__file__).parents[2]
SCENARIO = (
    "about: Stands.\nterrain: flat\ndriver: cmd_vel\nduration: 1\nexpect: {truth.speed: {max: 1}}\n"
)
# Tells what it was called with.
SHIM = '#!/bin/sh\nprintf "%s\\n" "$@" "" >> "$CALLS"\n'


def yaml(text: str) -> Any:  # noqa: ANN401 - whatever it says
    return YAML(typ="safe").load(text)


def run(script: str, folder: Path, **variables: str) -> list[list[str]]:
    """Runs a script as CI does, in a folder; returns what it called python and pip with."""
    tools, calls = folder.parent / "tools", folder.parent / "calls"
    tools.mkdir(exist_ok=True)
    for name in ("python", "pip"):
        (tools / name).write_text(SHIM)
        (tools / name).chmod(0o755)
    calls.write_text("")
    subprocess.run(
        ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", script],  # noqa: S607 - as GitHub
        cwd=folder,
        check=True,
        env={"PATH": f"{tools}:{os.environ['PATH']}", "CALLS": str(calls), **variables},
    )
    return [call.splitlines() for call in calls.read_text().split("\n\n") if call]


def driven(call: list[str], folder: Path, monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """The files that a call of harness.scenario leaves, none of which is driven."""
    assert call[:2] == ["-m", "harness.scenario"]
    monkeypatch.chdir(folder)
    monkeypatch.setattr("harness.scenario.suite.attempt", lambda case, *_, **__: Attempt(case))
    assert main([*call[2:], "--jobs", "1"]) == 0
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "checkout/scenarios").mkdir(parents=True)
    for name in ("one", "two"):
        (tmp_path / f"checkout/scenarios/{name}.scenario.yaml").write_text(SCENARIO)
    return tmp_path / "checkout"


@pytest.mark.parametrize(
    "given", [{}, {"seeds": "2", "scenarios": "scenarios/one.scenario.yaml scenarios"}]
)
def test_the_action_installs_itself_drives_and_uploads_what_it_is_asked_for(
    given: dict[str, str], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    action = yaml((ROOT / "action.yml").read_text())
    inputs = {name: str(one["default"]) for name, one in action["inputs"].items()} | given
    python, cache, install, drive, upload = action["runs"]["steps"]
    assert cache["with"]["path"] == "~/.cache/pip"
    told = json.dumps(action["runs"])
    assert set(re.findall(r"inputs\.([\w-]+)", told)) == set(inputs)
    assert "${{" not in install["run"] + drive["run"]  # an input is data
    assert python["with"]["python-version"] == "${{ inputs.python-version }}"

    def variables(step: dict[str, Any]) -> dict[str, str]:
        return {
            k: inputs[v.removeprefix("${{ inputs.").removesuffix(" }}")] for k, v in step["env"].items()
        }

    place = str(ROOT)
    for extras, installed in (("", place), ("ros,tune", f"{place}[ros,tune]")):
        (call,) = run(install["run"], folder, GITHUB_ACTION_PATH=place, EXTRAS=extras)
        assert call == ["-m", "pip", "install", "--quiet", installed]
    (call,) = run(drive["run"], folder, **variables(drive))
    files = driven(call, folder, monkeypatch)
    results = {path for path in files if path.startswith(f"{upload['with']['path']}/")}
    assert results == {f"rover-results/{name}" for name in ("junit.xml", "index.html", "results.json")}
    runs = json.loads((folder / "rover-results/results.json").read_text())["scenarios"]
    assert [len(one["runs"]) for one in runs] == [int(inputs["seeds"] or 1)] * 2
    (call,) = run(drive["run"], folder, **variables(drive) | {"JOBS": "3"})
    assert call[call.index("--jobs") + 1] == "3"


def test_the_gitlab_snippet_leaves_what_it_says_it_leaves(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    docs = (ROOT / "docs/scenarios.md").read_text()
    (text,) = re.findall(r"```yaml\n# \.gitlab-ci\.yml\n(.*?)```", docs, re.DOTALL)
    (job,) = yaml(text).values()
    install, drive = run("\n".join(job["script"]), folder, CI_PROJECT_DIR=str(folder))
    assert install[0] == "install"
    files = driven(drive, folder, monkeypatch)
    assert job["artifacts"]["reports"]["junit"] in files
    (kept,) = job["artifacts"]["paths"]
    assert any(path.startswith(kept) and path.endswith("index.html") for path in files)


def test_the_container_installs_the_wheel_and_compiles_what_it_casts_rays_with(folder: Path) -> None:
    steps = [line.partition(" ")[::2] for line in (ROOT / "Containerfile").read_text().splitlines()]
    built, installed, *rest = (run(line, folder) for step, line in steps if step == "RUN")
    assert not rest
    assert built == [["wheel", "--no-cache-dir", "--no-deps", "--wheel-dir", "/wheels", "."]]
    assert installed[0] == ["install", "--no-cache-dir", "/wheels/*.whl"]
    assert installed[1][0] == "-c"
    exec(installed[1][1])  # noqa: S102 - ours
    assert yaml(dict(steps)["ENTRYPOINT"]) == ["python", "-m", "harness.scenario"]


PACKAGE = "rover_metrics\trover_metrics\t(ros.ament_python)"
VERBS = ("test", "test-jazzy", "test-cluster", "test-clients", "docs", "dist", "smoke")


@pytest.mark.parametrize(
    ("package", "steps", "code", "ran", "last"),
    [
        (PACKAGE, [], 0, ["clean", "lint", "--quiet setup", *VERBS], "smoke passed in"),
        (PACKAGE, ["docs", "lint"], 0, ["docs", "lint"], "lint passed in"),
        (PACKAGE, ["docs", "tests"], 2, [], "no step tests; steps: lint colcon test test-jazzy"),
        ("other\tother\t(-)", [], 1, ["clean", "lint", "--quiet setup"], "colcon failed"),
    ],
)
def test_ci_runs_every_verb_that_ends_and_tells_what_it_ran(
    package: str, steps: list[str], code: int, ran: list[str], last: str, tmp_path: Path
) -> None:
    for path, says in ((".venv/bin/colcon", package), ("bin/make", "make $*")):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(f'#!/bin/sh\necho "{says}"\n')
        (tmp_path / path).chmod(0o755)
    (tmp_path / ".ci").mkdir()
    (tmp_path / "bin/chromium").symlink_to("make")
    script, log = shutil.copy(ROOT / ".ci/run", tmp_path / ".ci/run"), tmp_path / "log"
    path = f"{tmp_path / 'bin'}:{os.environ['PATH']}"
    with log.open("w") as both:  # at one place in one file, as `.ci/run > log 2>&1` has it
        command = [script, *steps]
        ended = subprocess.run(command, stdout=both, stderr=both, env={"PATH": path}, check=False)
    lines = log.read_text().splitlines()
    assert (ended.returncode, [line[5:] for line in lines if line.startswith("make ")]) == (code, ran)
    assert lines[-1].startswith(f"ci: {last}")
