import pytest

from harness.base.errors import UsageError
from harness.spec.ros import FrameOptions


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"odom_tf": "ekf"}, "^odom_tf 'ekf' is not valid; give ground_truth, wheels, none$"),
        ({"odom_tf": "wheels", "odom_tf_3d": True}, "leave out --odom-tf wheels, or --odom-tf-3d$"),
        ({"odom_tf": "none", "odom_tf_3d": True}, "leave out --odom-tf none, or --odom-tf-3d$"),
    ],
)
def test_what_does_not_fit_is_told_with_the_mend(values: dict[str, object], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        FrameOptions(**values)  # type: ignore[arg-type]  # a table of keywords
