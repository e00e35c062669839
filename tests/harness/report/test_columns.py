from harness.report.columns import describe


def test_a_column_beyond_the_twelve_has_the_unit_in_its_name() -> None:
    assert (describe("Heat [K]").unit, describe("Heat").unit) == ("K", "")
    assert describe("Obstacle Clearance").thresholds == ("collision_threshold", "min_safe_clearance")
