"""Whole runs against kept references and against what holds for all of them."""

from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.golden import kept
from tests.golden.evidence import gather
from tests.golden.invariants import INVARIANTS
from tests.golden.table import RUNS, GoldenRun, missing_pairs, missing_values

HAS_ROS = find_spec("rclpy") is not None


# MuJoCo remarks on it where rovers of one world have other options in their models than the first.
@pytest.mark.filterwarnings("ignore:Attach conflict:UserWarning")
@pytest.mark.usefixtures("ros_domain")
@pytest.mark.parametrize("run", RUNS, ids=lambda run: run.name)
def test_run_gives_what_was_kept_and_all_that_holds_for_runs_holds(
    run: GoldenRun, files: dict[str, Path], tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    evidence = gather(run, files, tmp_path, with_ros=HAS_ROS)
    broken = [f"{each.__name__}: {line}" for each in INVARIANTS for line in each(evidence)]
    outcome, before = kept.outcome(evidence, next(iter(files.values())).parent), kept.references()
    if request.config.getoption("--accept", default=False) and not broken:
        kept.keep(run.name, outcome)
    else:
        exact = before.get(kept.ARITHMETIC) == kept.arithmetic() and HAS_ROS
        broken += kept.differences(before.get(run.name, {}), outcome, exact=exact)
    assert not broken, "\n".join([f"{run.name}:", *broken[:40]])


def test_this_machine_computes_as_the_one_that_made_the_references() -> None:
    if kept.references()[kept.ARITHMETIC] != kept.arithmetic():
        pytest.skip("another arithmetic: golden runs are compared by their summaries, with tolerances")


def test_every_two_kinds_of_values_stand_in_some_run_and_every_registered_value_does() -> None:
    assert missing_pairs() == []
    assert missing_values() == set()
    assert sorted(kept.references()) == sorted([kept.ARITHMETIC, *(run.name for run in RUNS)])
