import pytest

from harness.base.errors import UsageError, find_named, how_many


def test_a_value_is_found_by_its_name_or_the_names_are_told() -> None:
    assert find_named("robot", "b", {"a": 1, "b": 2}) == 2
    with pytest.raises(UsageError, match=r"^robot 'c' does not exist; available: a, b$"):
        find_named("robot", "c", {"a": 1, "b": 2})


def test_one_is_no_plural() -> None:
    assert [how_many(n, "row") for n in (0, 1, 1000)] == ["0 rows", "1 row", "1,000 rows"]
