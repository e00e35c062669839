import pytest

from harness.base.errors import UsageError, find_named


def test_a_value_is_found_by_its_name_or_the_names_are_told() -> None:
    assert find_named("robot", "b", {"a": 1, "b": 2}) == 2
    with pytest.raises(UsageError, match=r"^robot 'c' does not exist; available: a, b$"):
        find_named("robot", "c", {"a": 1, "b": 2})
