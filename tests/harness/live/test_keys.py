"""Keys that are held to drive."""

from harness.live.keys import HELD, STANDING, Keys


def test_a_key_of_turning_goes_with_one_of_driving_as_long_as_either_is_held() -> None:
    now = [0.0]
    keys = Keys(lambda: now[0])
    for forward, left, both in (
        (1.0, 0.0, (1.0, 0.0)),
        (0.0, 1.0, (1.0, 1.0)),
        (-1.0, 0.0, (-1.0, 1.0)),
    ):
        keys.press(forward, left)
        now[0] += 0.9 * HELD
        assert keys.share == both
    now[0] += 0.2 * HELD
    assert keys.share == STANDING
