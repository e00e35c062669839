"""`pytest --rover`: a test a run over a scripted episode, in a pytest of its own."""

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import tomllib

# Loaded here: pytester forgets what a run within loads, and numpy cannot be loaded twice.
from harness.scenario import attempt, junit, plugin  # noqa: F401

pytest_plugins = ["pytester"]
pytestmark = pytest.mark.usefixtures("driven")
PLUGINS = (f"-p{plugin.__name__}", "-pno:randomly", "-pno:xdist", "-pno:cacheprovider")
HEAD = "about: a test\nterrain: flat\nduration: 2\n"
ROBOTS = "matrix: {robot: [leo, rover_zero4wd]}"
HALF = "pass_rate: {min: 0.5}\nexpected_to_fail: [{reason: it stands, robot: leo}]"
SCENARIOS = {
    "good": "seeds: 2\nexpect: {truth.path_length: {max: 1}}",
    "bad": "expect: {truth.hazard_contacts: {max: 0}}",
    "known": "expect: {truth.path_length: {max: 0}}\nexpected_to_fail: [{reason: it drives}]",
    "rate": f"{ROBOTS}\nexpect: {{truth.path_length: {{max: 1}}}}\n{HALF}",
    "half": f"{ROBOTS}\nexpect: {{truth.path_length: {{max: 0}}}}\n{HALF}",
    "never": f"seeds: 2\nexpect: {{truth.path_length: {{max: 1}}}}\n{HALF}",
    "lost": "expect: {truth.path_length: {over: end, relative: 0.1}}",
    "wrong": "expect: {truth.sped: {max: 1}}",
}


def test_it_is_a_plugin_of_every_pytest_under_its_own_name() -> None:
    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())
    assert project["project"]["entry-points"]["pytest11"] == {plugin.__name__: plugin.__name__}


def test_scenarios_are_tests_if_they_are_asked_for(pytester: pytest.Pytester) -> None:
    for name, text in SCENARIOS.items():
        (pytester.path / f"{name}.scenario.yaml").write_text(HEAD + text)
    assert pytester.inline_run(*PLUGINS).ret == pytest.ExitCode.NO_TESTS_COLLECTED
    run = pytester.runpytest_inprocess(
        *PLUGINS, "--rover", "-rA", "--junit-xml=out.xml", "--continue-on-collection-errors"
    )
    run.assert_outcomes(passed=3, failed=2, xfailed=2, errors=2)  # "half" is expected of its first run
    shown = run.stdout.str()
    told = "truth.hazard_contacts: 1 > 0, first at 1.05 s: front left wheel against hazard_3"
    again = "again: python -m harness.scenario bad.scenario.yaml --seed 0"
    assert "raise " not in shown
    unmet = "passed, but was expected to fail: it stands\nagain: python -m harness.scenario never"
    assert f"\n{unmet}.scenario.yaml --seed 0\n{unmet}.scenario.yaml --seed 1\n" in shown
    assert "wrong.scenario.yaml:4:10: expect.truth.sped: quantity 'truth.sped' does not exist" in shown
    assert "lost[0] could not run: there is no baseline of it in lost.baseline.json" in shown
    cases = {case.get("name"): case for case in ET.parse("out.xml").iter("testcase")}  # noqa: S314 - our own
    assert {"good[0]", "good[1]", "bad[0]", "known[0]", "rate", "half", "lost[0]"} <= cases.keys()
    assert [child.tag for child in cases["bad[0]"]] == ["properties", "failure"]
    assert [child.tag for child in cases["lost[0]"]] == ["properties", "error"]
    properties = {p.get("name"): p.get("value") for p in cases["bad[0]"].iter("property")}
    assert properties["again"] == again.removeprefix("again: ")
    kept = Path(str(properties["kept"]))
    assert kept.parts[-2:] == ("rover", "bad@0")
    assert f">{properties['again']}</pre>" in (kept / "run.html").read_text()
    assert f"\n{told}\n{again}\nsee:   {kept / 'run.html'}\n" in shown


def test_seeds_can_be_given_and_artefacts_sent_elsewhere(pytester: pytest.Pytester) -> None:
    (pytester.path / "bad.scenario.yaml").write_text(HEAD + SCENARIOS["bad"])
    more = ("--rover", "--rover-seeds=2", "--rover-artifacts=kept", "-k", "bad[1]")
    pytester.runpytest_inprocess(*PLUGINS, "-pharness.testing.plugin", *more).assert_outcomes(
        failed=1, deselected=1
    )
    assert (pytester.path / "kept/bad@1/run.html").is_file()
