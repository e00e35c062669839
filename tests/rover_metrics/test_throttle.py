from rover_metrics.errors import is_worth_a_line


def test_a_count_is_worth_a_line_when_it_reaches_or_leaps_over_a_power_of_two() -> None:
    assert [now for now in range(1, 100) if is_worth_a_line(now - 1, now)] == [1, 2, 4, 8, 16, 32, 64]
    assert [now for now in range(5, 20) if is_worth_a_line(5, now)] == list(range(8, 20))
    assert not is_worth_a_line(4, 4)
