from pathlib import Path

from rover_metrics.analysis.study import labels


def named(*paths: str) -> list[str]:
    return labels([Path(path) for path in paths])


def test_a_log_is_called_by_its_stem() -> None:
    assert named("/data/a/1.csv", "/data/b/2.csv") == ["1", "2"]


def test_same_names_take_as_many_folders_as_tell_them_apart() -> None:
    assert named("/x/a/run/1.csv", "/x/b/run/1.csv", "/x/2.csv") == ["a/run/1", "b/run/1", "2"]
    assert named("/1.csv", "/a/1.csv", "/b/a/1.csv") == ["1", "a/1", "b/a/1"]


def test_names_that_differ_only_in_what_is_not_shown_are_numbered() -> None:
    assert named("/d/1.csv", "/d/1.txt") == ["d/1 (1)", "d/1 (2)"]
    assert named(f"/{'a' * 20}{'b' * 20}.csv") == ["a" * 20 + "b" * 20]
    assert named(f"/{'a' * 20}c{'b' * 20}.csv") == ["a" * 18 + "..." + "b" * 19]
    long = [f"/d/{'x' * 50}{middle}{'y' * 50}.csv" for middle in "ab"]
    short = named(*long)
    assert len(set(short)) == 2
    assert max(map(len, short)) < 50


def test_control_characters_do_not_reach_the_terminal() -> None:
    assert named("/d/a\x1b[31m\nb.csv") == ["a?[31m?b"]
