from pathlib import Path

import pytest

from rover_metrics import errors
from rover_metrics.errors import (
    MissingRosError,
    OneLineParser,
    RoverMetricsError,
    is_worth_a_line,
    missing_ros,
)

NO_ROS = ImportError("No module named 'rclpy'")
TOLD = (
    "metrics_node needs ROS 2, but: No module named 'rclpy'; source one "
    "(source /opt/ros/<distro>/setup.bash) or install its wheels into this environment "
    "(pip install 'rover-harness[ros]')"
)


def test_without_ros_the_program_ends_with_two_after_one_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    end = missing_ros(NO_ROS, is_program=True)
    assert isinstance(end, SystemExit)
    assert end.code == 2
    assert capsys.readouterr() == ("", f"{TOLD}\n")


def test_without_ros_a_library_user_is_given_an_import_error(
    capsys: pytest.CaptureFixture[str],
) -> None:
    error = missing_ros(NO_ROS, is_program=False)
    assert isinstance(error, MissingRosError)
    assert isinstance(error, ImportError)
    assert str(error) == TOLD
    assert capsys.readouterr() == ("", "")


def test_every_known_mistake_can_be_caught_as_one_and_ends_a_program_with_two() -> None:
    kinds = [kind for name, kind in vars(errors).items() if name.endswith("Error")]
    assert len(kinds) == 5
    assert all(issubclass(kind, RoverMetricsError) and kind.exit_code == 2 for kind in kinds)


def test_a_count_is_worth_a_line_when_it_reaches_or_leaps_over_a_power_of_two() -> None:
    assert [now for now in range(1, 100) if is_worth_a_line(now - 1, now)] == [1, 2, 4, 8, 16, 32, 64]
    assert [now for now in range(5, 20) if is_worth_a_line(5, now)] == list(range(8, 20))
    assert not is_worth_a_line(4, 4)


def test_help_tells_the_default_of_each_option_as_it_would_be_typed() -> None:
    parser = OneLineParser(prog="x", description="One line.", epilog="Several\n  lines.")
    for flag, default in (
        ("--zero", 0),
        ("--tenth", 0.1),
        ("--whole", 90.0),
        ("--name", "50%"),
        ("--folder", Path("a/b")),
        ("--list", ["p", "q"]),
        ("--nothing", None),
        ("--empty", ""),
        ("--none", []),
    ):
        parser.add_argument(flag, default=default, metavar="V", help="text")
    parser.add_argument("--told", default=3, metavar="V", help="by default three")
    parser.add_argument("--switch", action="store_true", help="text")
    lines = parser.format_help().splitlines()
    told = {line.split()[0]: line.partition("text")[2] for line in lines if line.startswith("  --")}
    assert told == {
        "--zero": "; default: 0",
        "--tenth": "; default: 0.1",
        "--whole": "; default: 90",
        "--name": "; default: 50%",
        "--folder": f"; default: {Path('a/b')}",
        "--list": "; default: p q",
        "--nothing": "",
        "--empty": "",
        "--none": "",
        "--told": "",
        "--switch": "",
    }
    assert lines[-2:] == ["Several", "  lines."]
