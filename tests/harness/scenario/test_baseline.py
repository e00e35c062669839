"""Recorded runs: what their values are called, what can be compared, and what a file keeps."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness.base.errors import UsageError
from harness.episode.result import RunResult
from harness.scenario.baseline import (
    Recorded,
    check_comparable,
    first_difference,
    record,
    write_baselines,
)
from tests.harness.scenario.conftest import MakeCases


@pytest.mark.parametrize(
    ("was", "now", "told"),
    [
        ({"a": 1, "b": 2}, {"a": 1, "b": 3}, "the baseline is of b 2, this run of 3; "),
        ({"a": 1}, {}, "the baseline is of a 1, this run of the default; "),
        ({}, {"a": 1}, "the baseline is of a the default, this run of 1; "),
    ],
)
def test_runs_are_comparable_if_nothing_differs_in_either(
    was: dict[str, int], now: dict[str, int], told: str
) -> None:
    check_comparable(Recorded(of=now), Recorded(of=now))
    with pytest.raises(UsageError, match=f"^{told}if that is meant, record it anew"):
        check_comparable(Recorded(of=now), Recorded(of=was))


@pytest.mark.parametrize(
    ("now", "told"),
    [
        (("t,x,y", "1,2,3", "4,5,6"), None),
        (("t,x,y", "1,2,3", "4,7,8"), "row 2: x is 7, baseline 5"),
        (("t,x,y", "1,2,", "4,5,6"), "row 1: y is nothing, baseline 3"),
        (("t,x,y", "1,2,3", "4,5,6", "7,8,9"), "row 3: t is 7, baseline nothing"),
        (("t,x", "1,2,3", "4,5,6"), "row 0: y is nothing, baseline y"),
    ],
)
def test_the_first_cell_that_differs_is_told_with_both_values(
    now: tuple[str, ...], told: str | None
) -> None:
    difference = first_difference(
        Recorded(of={}, log=now), Recorded(of={}, log=("t,x,y", "1,2,3", "4,5,6"))
    )
    assert difference == (told and f"same_bytes: {told}")


def test_where_files_are_makes_no_other_run(make_cases: MakeCases) -> None:
    (case,), found = make_cases("{truth.speed: {max: 1}}"), list[dict[str, Any]]()
    files = {"terrain": "@w.sdf", "soil": "@s.yaml", "robot": "@mine", "driver": "policy:@p.npz"}
    more = {"actors": ["g=@walk.sdf:push=1"], "targets": ["t=@r.obj:texture=@p.png,x=1,y=2"]}
    stated = json.dumps(files | more | {"resource_path": ["@models"], "sensors": ["@p.py:Clock=fast"]})
    for place in ("", "a/", "b/c/"):
        run = case.run.alone(**json.loads(stated.replace("@", place)))
        found.append(record(replace(case, run=run), RunResult(run=run, mode=""), {}).of)
    assert found[0] == found[1] == found[2]
    assert found[0].items() >= json.loads(stated.replace("@", "")).items()


def test_runs_are_written_beside_those_that_the_file_has(make_cases: MakeCases, tmp_path: Path) -> None:
    one, two = make_cases("{truth.speed: {over: end, absolute: 1}}", "seeds: [1, 2]")
    path = tmp_path / "two.baseline.json"
    kept = {"two[9]": {"of": {"a": 9}, "values": {}, "log": []}}
    path.write_text(json.dumps(kept | {"two[2]": kept["two[9]"]}))
    recorded = [
        (one, Recorded(of={"a": 1}, values={"v": 2.5}, log=("x",))),
        (two, Recorded(of={"a": 2})),
    ]
    assert write_baselines(recorded) == [path]
    assert json.loads(path.read_text()) == kept | {
        "two[1]": {"of": {"a": 1}, "values": {"v": 2.5}, "log": ["x"]},
        "two[2]": {"of": {"a": 2}, "values": {}, "log": []},
    }
