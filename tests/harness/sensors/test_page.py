"""The sensors' page says what the table and the options say."""

from pathlib import Path

import pytest

from harness.errors import UsageError
from harness.sensors.choice import kinds
from harness.sensors.page import described, written

PAGE = (Path(__file__).parents[3] / "docs" / "sensors.md").read_text()


def test_the_page_is_up_to_date() -> None:
    assert written(PAGE) == PAGE, "run: python -m harness.sensors.page docs/sensors.md"


def test_every_option_of_every_kind_is_described() -> None:
    for kind, row in kinds().items():
        assert row.options is not None
        missing = set(row.options.__dataclass_fields__) - set(described(row.options))
        assert not missing, f"{kind}: {missing}"
        assert row.summary


def test_a_page_without_a_place_for_the_tables_is_refused() -> None:
    with pytest.raises(UsageError, match=r"has no place for the tables"):
        written("nothing")
