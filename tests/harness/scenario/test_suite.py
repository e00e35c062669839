"""Runs to verdicts, verdicts to lines, JUnit and exit codes."""

import math
import re
import shutil
import signal
import xml.etree.ElementTree as ET
from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from harness import __version__
from harness.base.errors import RunFailed
from harness.base.interrupt import Interrupted
from harness.base.workers import WorkerLost, Workers
from harness.scenario.__main__ import main
from harness.scenario.attempt import DEFAULTS, AttemptOptions
from harness.scenario.baseline import path_of
from harness.scenario.case import Case
from harness.scenario.junit import junit_of
from harness.scenario.progress import Progress
from harness.scenario.suite import run_all
from harness.scenario.terminal import print_verdicts
from harness.scenario.verdict import Attempt, Outcome, exit_code, verdicts_of
from harness.spec.run import Run
from tests.harness.scenario.conftest import MakeCases, cases_with
from tests.support.complaint import complaint
from tests.support.snapshots import check_snapshot

SPEED = "{truth.speed: {min: 0}}"


class Backwards(Workers):
    """Gives outcomes from the last to the first."""

    def map(self, work: Callable[[Any], Any], items: Sequence[Any]) -> Generator[Any, None, None]:
        yield from [work(item) for item in reversed(items)]


class Ending(Workers):
    """Ends so after some outcomes."""

    def __init__(self, error: Exception, after: int = 1) -> None:
        self.error, self.after = error, after

    def map(self, work: Callable[[Any], Any], items: Sequence[Any]) -> Generator[Any, None, None]:
        yield from [work(item) for item in items[: self.after]]
        raise self.error


def test_parameters_of_the_metrics_are_those_that_the_log_is_written_with(
    make_cases: MakeCases, tmp_path: Path, driven: list[Run]
) -> None:
    cases = cases_with(
        make_cases, tmp_path, "metrics_node: {ros__parameters: {collision_threshold: 5.0}}"
    )
    near, far = run_all(cases, Backwards(), tmp_path / "out", lambda *_: None)
    assert near.breaches == (
        "log.Total Collisions: 40 > 0 at 2 s, first at 1 s",
    )  # the nearest is at 2 m
    assert far.passed
    assert len(driven) == 2


def test_attempts_come_in_the_order_of_their_cases(
    make_cases: MakeCases, tmp_path: Path, driven: list[Run]
) -> None:
    cases, shown = make_cases(SPEED, "seeds: 3"), list[tuple[int, ...]]()

    def show(*count: int) -> None:
        shown.append(count)

    found = run_all(cases, Backwards(), tmp_path, show)
    assert [attempt.case for attempt in found] == cases
    assert [config.seed for config in driven] == [2, 1, 0]
    assert shown == [(0, 3), (1, 3), (2, 3), (3, 3)]
    killed = WorkerLost("a worker process was killed")
    run_all(cases, Ending(killed), tmp_path, show)  # one more each time
    assert shown[4:] == [(0, 3), (1, 3), (2, 3), (3, 3)]
    undone = r"a worker process was killed; not done: two\[0\], two\[1\], two\[2\]; .* --resume"
    with pytest.raises(RunFailed, match=undone):
        run_all(cases, Ending(killed, 0), tmp_path, show)


def test_a_suite_that_was_stopped_goes_on_if_nothing_has_changed(
    make_cases: MakeCases, tmp_path: Path, driven: list[Run]
) -> None:
    sand, out = tmp_path / "sand.yaml", tmp_path / "out"
    sand.write_text("k_phi: 1.0e+6\nn: 1.0\nfriction_angle_deg: 30\nshear_length: 0.01\n")
    cases = make_cases("{truth.hazard_contacts: {max: 1}}", "seeds: 3\nsoil: sand.yaml")

    def run(
        backend: Workers, options: AttemptOptions = DEFAULTS, *, resume: bool = False
    ) -> tuple[list[Attempt], list[int]]:
        driven.clear()
        found = run_all(cases, backend, out, lambda *_: None, options, resume=resume)
        return [replace(one, wall_s=0.0) for one in found], sorted(config.seed for config in driven)

    def stop() -> Path:
        stopped = "stopped by SIGINT after 2 of 3 runs; the same command with --resume goes on"
        with pytest.raises(Interrupted, match=stopped):
            run(Ending(Interrupted(signal.SIGINT), 2))
        (unfinished,) = out.iterdir()
        assert len(unfinished.read_text().splitlines()) == 3  # what the suite is, and two runs
        return unfinished

    whole, _ = run(Backwards())
    assert not out.exists()

    def edit(old: str, new: str) -> Callable[[Path], object]:
        return lambda path: path.write_text(path.read_text().replace(old, new, 1))

    for change, left in (
        (lambda path: path, [2]),
        (lambda path: path.write_text(path.read_text()[:-9]), [1, 2]),  # killed as it wrote
        (lambda path: path.write_bytes(b"\xff"), [0, 1, 2]),
        (edit('"error":null', '"error":"no disk"'), [0, 2]),
        (edit('"kept":[]', '"kept":["nowhere"]'), [0, 2]),
        (lambda _: cases[0].path.write_text(cases[0].path.read_text() + "\n"), [0, 1, 2]),
        (lambda _: sand.write_text(sand.read_text() + "\n"), [0, 1, 2]),  # beside the scenario
    ):
        unfinished = stop()
        change(unfinished)
        assert run(Backwards(), resume=True) == (whole, left), left
        assert not out.exists()
    stop()
    assert run(Backwards()) == (whole, [0, 1, 2])
    stop()
    assert run(Backwards(), AttemptOptions(keep=True), resume=True)[1] == [0, 1, 2]  # none was kept
    shutil.rmtree(out, ignore_errors=True)
    stop()
    cases = [replace(case, params={"collision_threshold": 9.0}) for case in cases]
    assert run(Backwards(), resume=True)[1] == [0, 1, 2]
    out.touch()
    with pytest.raises(Interrupted, match=r"after 1 of 3 runs$"):  # nothing can be kept there
        run(Ending(Interrupted(signal.SIGINT)))


def test_a_suite_goes_on_only_if_every_file_that_its_runs_read_is_as_it_was(
    make_cases: MakeCases, tmp_path: Path
) -> None:
    (first,) = make_cases(SPEED)
    names = (
        "dem.npy",
        "sand.yaml",
        "walk.sdf",
        "box.obj",
        "face.png",
        "net.npz",
        "own.py",
        "hills.py",
        "yard.sdf",
        "rock.obj",
        "rover/rover.yaml",
        "rover/wheel.stl",
        "clay.py",
        "radar.py",
        "mud.py",
        *(f"dem.{ending}" for ending in ("tfw", "wld", "prj", "npy.aux.xml")),
    )
    (tmp_path / "rover").mkdir()
    files = {name: tmp_path / name for name in names} | {"": path_of(first.path)}  # its baseline
    for file in files.values():
        file.write_text("k_phi: 1.0e+6\nn: 1.0\nfriction_angle_deg: 30\nshear_length: 0.01\n")
    terrain, soil, people, mesh, texture, net, own, hills, yard, *_ = map(str, files.values())
    files["hills.py"].write_text("from harness.world.terrains.ground import Slope as Hills\n")
    files["clay.py"].write_text("from harness.soil.soils import SOILS\nClay = SOILS['firm']\n")
    files["mud.py"].write_text(files["clay.py"].read_text())
    (tmp_path / "map.yaml").write_text(f"soils: ['{files['mud.py']}:Clay']\nmap: map.png\n")
    files["rock.obj"].write_text(
        "v 3 3 1\nv 4 3 1\nv 3 4 1\nv 3 3 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    )
    ground = (
        "<plane><normal>0 0 1</normal><size>20 20</size></plane>",
        "<mesh><uri>rock.obj</uri></mesh>",
    )
    shapes = (
        f"<collision name='{number}'><geometry>{shape}</geometry></collision>"
        for number, shape in enumerate(ground)
    )
    model = f"<model name='m'><static>1</static><link name='l'>{''.join(shapes)}</link></model>"
    files["yard.sdf"].write_text(f"<sdf version='1.9'><world name='w'>{model}</world></sdf>")
    world = {"terrain": terrain, "soil": soil, "actors": (people,)}
    world["targets"] = (f"{mesh}:texture={texture}",)
    drivers = (f"policy:{net}", f"{own}:Mine")
    runs = [Run.of(**world, driver=driver, robot=str(tmp_path / "rover")) for driver in drivers]
    runs += [Run.of(terrain=other) for other in (f"{hills}:Hills", yard)]
    runs.append(Run.of(soil=f"{files['clay.py']}:Clay", sensors=[f"{files['radar.py']}:Radar"]))
    runs.append(Run.of(soil=str(tmp_path / "map.yaml")))
    cases = [replace(first, run=run) for run in runs]
    for name, file in files.items():
        before = Progress(cases, tmp_path / "out", compare=True)
        before.keep(0, Attempt(cases[0]))
        assert before.read()
        file.write_text(file.read_text() + "\n")
        assert not Progress(cases, tmp_path / "out", compare=True).read(), name
        before.end()


def wilson(good: int, count: int) -> tuple[float, float]:
    """Wilson's interval at 95 %, by his own formula (1927)."""
    z, rate = 1.959963984540054, good / count
    middle = (rate + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(rate * (1 - rate) / count + z * z / (4 * count**2))
    return max(0.0, middle - half), min(1.0, middle + half)


KEPT = (Path("out/run.html"),)


def outcomes(cases: Sequence[Case], letters: str, **more: float) -> list[Attempt]:
    """Runs that passed, failed or could not be run: p, f, e."""
    failed = {"breaches": ("truth.speed: 1 < 2", "x: 3 > 2"), "kept": KEPT, "model_hash": "af"}
    made = {"p": {"terrain_hash": "be"}, "f": failed, "e": {"error": "no disk"}}
    return [
        Attempt(case, **made[letter], **more)  # type: ignore[arg-type]
        for case, letter in zip(cases, letters, strict=True)
    ]


KNOWN = "expected_to_fail: [{reason: it is blind, robot: leo}]"
RATE = "pass_rate: {min: 0.5}"


@pytest.mark.parametrize(
    ("letters", "more", "good", "code", "junit"),
    [
        ("pppp", "", 4, 0, (0, 0, 0)),
        ("pfpp", "", 3, 1, (1, 0, 0)),
        ("pfpp", RATE, 3, 0, (0, 0, 1)),
        ("fffp", RATE, 1, 1, (3, 0, 0)),
        ("ffpp", RATE, 2, 0, (0, 0, 2)),
        ("ppep", RATE, 3, 2, (0, 1, 0)),
        ("ppef", "", 2, 2, (1, 1, 0)),
        ("ffpp", KNOWN, 4, 0, (0, 0, 2)),
        ("fppp", KNOWN, 3, 1, (1, 0, 1)),
        ("ffpf", KNOWN, 3, 1, (1, 0, 2)),
    ],
)
def test_runs_become_a_verdict_an_exit_code_and_junit(
    letters: str, more: str, good: int, code: int, junit: tuple[int, ...], make_cases: MakeCases
) -> None:
    cases = make_cases(SPEED, f"matrix: {{robot: [leo, rover_zero4wd]}}\nseeds: 2\n{more}")
    attempts, other = outcomes(cases, letters), outcomes(make_cases(SPEED, name="other"), "e")
    (verdict,) = verdicts = verdicts_of(attempts)
    mixed = verdicts_of([attempts[0], *other, *attempts[1:]])
    assert (mixed[0], exit_code(mixed)) == (verdict, 2)
    assert verdict.rate == good / 4
    assert verdict.interval == pytest.approx(wilson(good, 4))
    assert exit_code(verdicts) == code
    assert (verdict.outcome is Outcome.PASSED) == (code == 0)
    (suite,) = ET.fromstring(junit_of(verdicts))  # noqa: S314 - our own
    assert tuple(int(suite.get(name, -1)) for name in ("failures", "errors", "skipped")) == junit


def test_a_bad_run_is_shown_with_its_reasons_and_the_command_that_repeats_it(
    make_cases: MakeCases, capsys: pytest.CaptureFixture[str]
) -> None:
    attempts = outcomes(make_cases(SPEED, "seeds: 2"), "pf", simulated_s=12.0, wall_s=4.0)
    whole = [*attempts, *outcomes(make_cases(SPEED, f"seeds: 2\n{KNOWN}", name="known"), "fp")]
    whole += outcomes(make_cases(SPEED, name="broken"), "e")
    print_verdicts(Console(width=40), verdicts_of(whole))
    text = capsys.readouterr().out + junit_of(verdicts_of(whole))
    text = text.replace(__version__, "VERSION").replace("><", ">\n<")
    check_snapshot("verdicts.txt", re.sub(r"[^ \"]*/(\w+\.scenario\.yaml)", r"\1", text))
    many = outcomes(make_cases(SPEED, "seeds: 49"), "p" + 48 * "f")
    print_verdicts(Console(width=40), verdicts_of(many))
    assert capsys.readouterr().out.startswith("failed two: 1 of 49 runs ")  # 1 / 49 * 49 < 1


def test_the_command_runs_a_folder_writes_junit_and_records_baselines(
    make_cases: MakeCases, tmp_path: Path, driven: list[Run], capsys: pytest.CaptureFixture[str]
) -> None:
    make_cases("{truth.path_length: {over: end, relative: 0.01}}", "seed: 1")
    junit = tmp_path / "out.xml"
    words = [str(tmp_path), "--jobs", "1", "--out", str(tmp_path / "out"), "--junit", str(junit)]
    for more, code in (
        ([], 2),
        (["--update-baseline"], 0),
        ([], 0),
        (["--seeds", "2"], 2),
        (["--seed", "5", "--update-baseline"], 0),
    ):
        assert main([*words, *more]) == code, more
        tags = ["error"] if code else []
        assert [case.tag for case in ET.parse(junit).iter("error")] == tags  # noqa: S314 - our own
    assert "1 of 1 scenario passed: 1 run" in capsys.readouterr().out
    assert [run.seed for run in driven] == [1, 1, 1, 5]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("wrong", "mend"),
    [
        (["--seeds", "0"], "give 1 or more"),
        (["--only", "leo"], "e.g. --only robot=leo"),
        (["--only", "terrain=a=b"], "no run has terrain=a=b"),
        (["--jobs", "0"], "0 jobs are not valid"),
        (["--junit", "."], "--junit . is a folder"),
        (["--page", "no/a.html"], "create it first"),
        (["--plot", "box.docx"], "ends in .png, .pdf, .svg"),
    ],
)
def test_a_wrong_word_is_one_line_with_the_mend(
    make_cases: MakeCases,
    wrong: list[str],
    mend: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (case,) = make_cases(SPEED)
    monkeypatch.delattr("harness.scenario.command.run_all")  # nothing is driven before it is told
    assert mend in complaint(main, [str(case.path), *wrong], capsys)
