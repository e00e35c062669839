import pytest

from rover_metrics.ros.arguments import complaint, refusal, split_ros_args

OWN = ("--seed", "--params", "-h")


@pytest.mark.parametrize(
    ("words", "own", "ros"),
    [
        ("--seed 1", "--seed 1", ""),
        ("--seed 1 --ros-args -r a:=b", "--seed 1", "--ros-args -r a:=b"),
        ("--ros-args -r a:=b -- --seed 1", "--seed 1", "--ros-args -r a:=b --"),
        ("-- --seed --ros-args -p x:=1 -- 1", "-- --seed 1", "--ros-args -p x:=1 --"),
        ("--ros-args -e /a -- x --ros-args -e /b", "x", "--ros-args -e /a -- --ros-args -e /b"),
    ],
)
def test_ros_arguments_end_at_two_dashes_or_with_the_line(words: str, own: str, ros: str) -> None:
    assert split_ros_args(words.split()) == (own.split(), ros.split())


@pytest.mark.parametrize(
    "words",
    [
        "",
        "--sed 3",
        "--ros-args",
        "--ros-args -p a:=1 -r --sed:=x -e --seed -- --sed 3",
        "--ros-args -r __ns:=/ -r a:b:=~/c1/{node} -r rostopic:///x:=/y",
        "--ros-args --log-level debug --disable-rosout-logs --ros-args -e /a --",
        "--ros-args -p x:=1 -- --sed --ros-args --remap a:=b",
    ],
)
def test_options_that_ros_knows_and_words_of_others_are_none_of_its_business(words: str) -> None:
    assert complaint(words.split(), OWN) is None


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("--ros-args --parms-file x", "knows no '--parms-file'; did you mean --params-file?"),
        ("--ros-args -p a:=1 --log-levl warn", "knows no '--log-levl'; did you mean --log-level?"),
        ("--ros-args --params-file=x.yaml", "'--params-file=x.yaml'; did you mean --params-file?"),
        ("--ros-args --params-file x", "cannot read parameters from x: No such file or directory"),
        ("--ros-args --seed=3", "--seed stands behind --ros-args"),
        ("--ros-args --sed 3", "knows no '--sed'; did you mean --seed, before --ros-args?"),
        *((f"--ros-args -r {rule}", "give FROM:=TO") for rule in ("scan", "scan:=", "a:=b/1x")),
        ("--ros-args x", "--ros-args knows no 'x'; did you mean -"),
    ],
)
def test_an_option_that_ros_does_not_know_is_named_with_the_nearest(words: str, told: str) -> None:
    assert told in str(complaint(words.split(), OWN))


def test_a_refusal_is_one_line_and_says_what_else_a_log_could_be_written_to() -> None:
    assert refusal(RuntimeError("Couldn't parse\n  rule 'x', at /a/b.c:3")) == "Couldn't parse rule 'x'"
    for reason in ("Failed to create log directory: /x", "Failed to get logging directory: no HOME"):
        assert refusal(RuntimeError(reason)) == f"{reason}; ROS_LOG_DIR names another folder"
