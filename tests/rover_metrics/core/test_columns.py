"""The twelve columns' units and kinds, as docs/metrics.md and RoboTerrain's analyzer have them."""

from dataclasses import replace

from rover_metrics.core.columns import ROBOTERRAIN_COLUMNS, Column

SHAKING = "m/s^2 + rad/s"
UNITS = ("s", "", "", SHAKING, SHAKING, "m", "m", "m/s", "m/s^2", "", "m/s^2", "")


def test_the_twelve_have_units_and_three_of_them_count_from_the_start_on() -> None:
    assert tuple(column.unit for column in ROBOTERRAIN_COLUMNS) == UNITS
    told = [column.name for column in ROBOTERRAIN_COLUMNS if column.cumulative]
    assert told == ["Total Collisions", "Smoothness Metric", "Distance Traveled"]
    assert [column.name for column in ROBOTERRAIN_COLUMNS if "so far" in column.meaning] == told


def test_an_extended_column_has_its_unit_in_its_header() -> None:
    column = Column(name="Way", meaning="How far.", formula="Sum.", source="/x")
    assert replace(column, unit="m").header == "Way [m]"
    assert (column.header, column.unit, column.rate_invariant) == ("Way", "", "yes")
    assert not column.cumulative
