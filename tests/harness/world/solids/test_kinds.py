"""What is a rock and what a hazard: by height, or by names."""

from typing import Any

import pytest

from harness.base.errors import UsageError
from harness.spec.value import made
from harness.spec.world import WorldSpec
from harness.world.solids.pieces import Kinds

NAMES = ("wall::link::top", "wall::link::base", "stone_1::link::c", "stone_2::link::c")


def kinds(**fields: Any) -> Kinds:  # noqa: ANN401 - of several fields
    return Kinds(made(WorldSpec, fields), 0.125, NAMES)


@pytest.mark.parametrize(("rock_height", "limit"), [(None, 0.125), (0.0, 0.0), (0.5, 0.5)])
def test_what_is_no_higher_than_the_limit_is_a_rock(rock_height: float | None, limit: float) -> None:
    found = kinds(rock_height=rock_height)
    assert (found.limit, found.clearance) == (limit, 0.125)
    for rule in (found.by_height, found.of("wall::link::top")):
        assert [rule(height).name for height in (limit, limit + 1e-6)] == ["ROCK", "HAZARD"]


def test_names_outrule_heights_and_hazards_outrule_rocks() -> None:
    found = kinds(rock=("stone_?", "*::top"), hazard=("stone_2", "wall::link::base"))
    for height in (0.0, 9.0):
        assert [found.of(name)(height).name for name in NAMES] == ["ROCK", "HAZARD", "ROCK", "HAZARD"]
        assert found.of("sand::link::c")(height) is found.by_height(height)


def test_a_pattern_that_fits_nothing_is_refused_with_the_models_that_there_are() -> None:
    with pytest.raises(UsageError, match=r"^--rock: solid 'Stone_1' .* did you mean 'stone_1'\?$"):
        kinds(rock=("stone_1", "Stone_1"))
    with pytest.raises(
        UsageError, match=r"^--hazard: solid 'link' .*; available: wall, stone_1, stone_2$"
    ):
        kinds(hazard=("link",))
