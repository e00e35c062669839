"""The rovers pass, rovers that were tampered with do not, and tables show it."""

import math
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

import mujoco
import pytest

from harness.physics.scene import Scene
from harness.physics.simulation import Simulation
from harness.robots import ROVERS, RoverSpec
from harness.robots.content import MODELS_DIR
from harness.robots.sections import OPEN, Span
from harness.validate import climbing, driving, rig, stability, suite
from harness.validate.check import Check, around, at_most
from harness.validate.suite import Manoeuvres, cells_of, validate
from tests.support.once import made_once
from tests.support.rovers import LEO
from tools.site.documents import validation

BEGIN, END = "<!-- generated: validation -->", "<!-- end -->"
Tampering = Callable[[mujoco.MjModel], None]
NUMBER = re.compile(r"\d+(?:\.(\d+))?")


def cells_in(path: Path) -> dict[str, list[list[str]]]:
    """The rows of the tables between the markers, by rover."""
    rows: dict[str, list[list[str]]] = {}
    for line in path.read_text(encoding="utf-8").split(BEGIN)[1].split(END)[0].splitlines():
        if line.startswith("### "):
            rows[line.removeprefix("### ")] = []
        elif line.startswith("| "):
            rows[next(reversed(rows))].append(line.strip("| ").split(" | "))
    return rows


SHOWN = cells_in(MODELS_DIR / "README.md")


def measured(rover: RoverSpec) -> list[Check]:
    """The checks with seed 0; what is searched for is tried where it was found last time first."""
    found = (
        cells[2]
        for cells in SHOWN.get(rover.name, ())
        if re.match("highest|kerb|slope climbed", cells[0])
    )

    def search(passes: Callable[[float], bool], low: float, high: float, step: float) -> float:
        last = round(float(next(found, "-1").split()[0]) / step)
        if low <= last * step < high and passes(last * step) and not passes((last + 1) * step):
            return last * step
        return rig.largest_passing(passes, low, high, step)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(climbing, "largest_passing", search)
        return validate(rover, seed=0)


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Check]]:
    """The checks of each rover, by its name."""
    return {
        name: made_once(tmp_path_factory, f"validated_{name}", partial(measured, rover))
        for name, rover in ROVERS.items()
    }


def test_every_check_of_the_suite_passes_is_named_once_and_has_its_source(
    driven: dict[str, list[Check]],
) -> None:
    for checks in driven.values():
        assert [check for check in checks if not (check.passed and check.expected.source)] == []
        names = [check.quantity for check in checks]
        assert len(set(names)) == len(names)
    again = {check.quantity: check.measured for check in climbing.rocker_checks(LEO, 0)}
    first = {check.quantity: check.measured for check in driven[LEO.name]}
    assert again == {name: first[name] for name in again}  # to the last bit


def slippery(model: mujoco.MjModel) -> None:
    model.geom_friction[:, 0] = 0.6


def weak_servos(model: mujoco.MjModel) -> None:
    model.actuator_gainprm[:, 0] = 4.0
    model.actuator_biasprm[:, 2] = -4.0


def stiff_rockers(model: mujoco.MjModel) -> None:
    model.jnt_range[model.joint("rocker_L_joint").id] = (-0.1, 0.1)


def low_belly(model: mujoco.MjModel) -> None:
    model.geom_pos[model.geom("body_chassis").id, 2] -= 0.02


@pytest.mark.parametrize(
    ("tampering", "manoeuvres", "missed"),
    [
        (slippery, stability.checks, "slope held, nose up"),
        (weak_servos, driving.checks, "speed at 0.5 m/s commanded"),
        (stiff_rockers, climbing.rocker_checks, "rocker angle at its stops"),
        (low_belly, climbing.passage_checks, "highest rock that passes below the underside"),
    ],
)
def test_a_rover_that_was_tampered_with_is_found_out(
    tampering: Tampering, manoeuvres: Manoeuvres, missed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def tampered(scene: Scene, timestep_ns: int) -> Simulation:
        tampering(scene.model)
        return Simulation(scene, timestep_ns)

    monkeypatch.setattr(rig, "Simulation", tampered)
    assert not next(check for check in manoeuvres(LEO, 0) if check.quantity == missed).passed


def test_the_readme_tells_what_the_suite_expects_and_measures(
    driven: dict[str, list[Check]], tmp_path: Path
) -> None:
    """Words are the same; numbers differ by what processors may differ in."""
    fresh = tmp_path / "README.md"
    fresh.write_text(f"{BEGIN}\n{validation(driven)}\n{END}", encoding="utf-8")
    again = cells_in(fresh)
    assert list(SHOWN) == list(again) == list(driven)
    for robot, rows in again.items():
        assert len(SHOWN[robot]) == len(rows), "run python -m tools.site write"
        for old, new in zip(SHOWN[robot], rows, strict=True):
            assert [NUMBER.sub("#", cell) for cell in old] == [NUMBER.sub("#", cell) for cell in new]
            for column, (one, other) in enumerate(zip(old, new, strict=True)):
                for theirs, ours in zip(NUMBER.finditer(one), NUMBER.finditer(other), strict=True):
                    last_digit = 10.0 ** -len(ours[1] or "")
                    rel = 0.03 if column == 2 else 0.0
                    assert float(ours[0]) == pytest.approx(
                        float(theirs[0]), rel=rel, abs=1.01 * last_digit
                    ), f"{robot}: {new[0]}"


@pytest.mark.parametrize(
    ("span", "text", "passing", "missing"),
    [
        (Span(0.49, 0.50, ""), "0.49 to 0.50", (0.49, 0.495, 0.50), (0.489, 0.501, math.nan)),
        (Span(0.07, math.inf, ""), "at least 0.07", (0.07, 1e9), (0.06, math.nan)),
        (at_most(0.3, ""), "at most 0.30", (0.3, -1e9), (0.31, math.nan)),
        (around(0.57, 0.03, ""), "0.54 to 0.60", (0.55,), (0.61,)),
        (OPEN, "-", (1e9, math.nan), ()),
    ],
)
def test_a_value_passes_on_the_ends_of_its_span_and_between(
    span: Span, text: str, passing: tuple[float, ...], missing: tuple[float, ...]
) -> None:
    assert span.describe(2) == text
    assert all(Check("speed", "m/s", span, value).passed for value in passing)
    missed = [Check("speed", "m/s", span, value) for value in missing]
    assert not any(check.passed for check in missed)
    assert {cells_of(check)[3] for check in missed} <= {"MISS"}


def test_a_rover_of_which_nothing_is_expected_is_measured_and_not_judged(
    foreign: Callable[[str], RoverSpec], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(suite, "SUITE", (driving.rest_checks,))
    checks = suite.validate(foreign("a200"), 0)
    assert checks[0].measured == pytest.approx(9.81, abs=0.01)
    assert {check.expected for check in checks} == {OPEN}
