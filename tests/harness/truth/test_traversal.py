import pytest

from harness.truth.traversal import slip_ratio


@pytest.mark.parametrize(
    ("wheel", "ground", "slip"),
    [
        (1.0, 1.0, 0.0),
        (1.0, 0.5, 0.5),
        (1.0, 0.0, 1.0),
        (0.0, 1.0, -1.0),
        (0.5, 1.0, -0.5),
        (1.0, -0.1, 1.0),
        (-1.0, -0.5, -0.5),
        (-1.0, 0.1, -1.0),
        (0.02, 0.0, 1.0),
        (0.0, 0.0199, 0.0),
        (0.0199, 0.0, 0.0),
    ],
)
def test_slip_ratio_is_positive_when_driving_and_negative_when_braking(
    wheel: float, ground: float, slip: float
) -> None:
    assert slip_ratio(wheel, ground) == pytest.approx(slip)
