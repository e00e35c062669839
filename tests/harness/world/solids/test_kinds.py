"""What is a rock and what a hazard: by height, or by names."""

from pathlib import Path
from typing import Any

import pytest
from harness.world.terrain_file import TerrainFile

from harness.base.errors import UsageError
from harness.world.obstacles import ObstacleKind
from harness.world.solids.kinds import Kinds

NAMES = ("wall::link::top", "wall::link::base", "stone_1::link::c", "stone_2::link::c")


def kinds(**options: Any) -> Kinds:  # noqa: ANN401 - of several fields
    return Kinds(TerrainFile(path=Path("a.world"), clearance=0.125, **options), NAMES)


@pytest.mark.parametrize(
    ("rock_height", "limit"), [(None, 0.125), (0.0, 0.0), (0.5, 0.5)], ids=["clearance", "none", "told"]
)
def test_what_is_no_higher_than_the_limit_is_a_rock(rock_height: float | None, limit: float) -> None:
    found = kinds(rock_height=rock_height)
    assert (found.limit, found.clearance) == (limit, 0.125)
    assert [found.by_height(height).name for height in (limit, limit + 1e-6)] == ["ROCK", "HAZARD"]
    assert found.of("wall::link::top")(limit) is ObstacleKind.ROCK


def test_names_outrule_heights_and_hazards_outrule_rocks() -> None:
    found = kinds(rocks=("stone_?", "*::top"), hazards=("stone_2", "wall::link::base"))
    expected = {
        "wall::link::top": "ROCK",
        "wall::link::base": "HAZARD",
        "stone_1::link::c": "ROCK",
        "stone_2::link::c": "HAZARD",
    }
    for height in (0.0, 9.0):
        assert {name: found.of(name)(height).name for name in NAMES} == expected
    assert [found.of("sand::link::c")(height).name for height in (0.1, 0.2)] == ["ROCK", "HAZARD"]


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"rocks": ("stone_1", "Stone_1")}, r"--rock: solid 'Stone_1' .* did you mean 'stone_1'\?"),
        ({"hazards": ("link",)}, "--hazard: solid 'link' .*; available: wall, stone_1, stone_2"),
    ],
)
def test_a_pattern_that_fits_nothing_is_told_with_the_models_that_there_are(
    options: dict[str, tuple[str, ...]], told: str
) -> None:
    with pytest.raises(UsageError, match=f"^{told}$"):
        kinds(**options)
