from pathlib import Path

import pytest

from harness.cli.options import (
    DEFAULT_LOG_DIR,
    check_combination,
    config_of,
    namespace_args,
    run_parser,
    split_ros_args,
)
from harness.config import EpisodeConfig
from harness.errors import UsageError


@pytest.mark.parametrize(
    ("words", "own", "ros"),
    [
        ("--seed 1", "--seed 1", ""),
        ("--seed 1 --ros-args -r a:=b", "--seed 1", "--ros-args -r a:=b"),
        ("--ros-args -r a:=b -- --seed 1", "--seed 1", "--ros-args -r a:=b --"),
        ("-- --seed --ros-args -p x:=1 -- 1", "-- --seed 1", "--ros-args -p x:=1 --"),
    ],
)
def test_ros_arguments_end_at_two_dashes_or_with_the_line(words: str, own: str, ros: str) -> None:
    assert split_ros_args(words.split()) == (own.split(), ros.split())


def test_without_words_the_episode_is_the_default_one() -> None:
    options = run_parser().parse_args([])
    assert config_of(options) == EpisodeConfig()
    assert (options.rate, options.log_dir, options.namespace) == (None, DEFAULT_LOG_DIR, "")
    assert Path("metrics_analyzer/data/metric_logs") == DEFAULT_LOG_DIR
    flags = ("no_metrics", "direct", "extended", "picture_lidar", "list")
    assert not any(getattr(options, flag) for flag in flags)


def test_every_word_about_the_episode_reaches_it() -> None:
    words = (
        "--terrain posts --robot rover_zero4wd --seed 4 --duration 7 --driver spin --difficulty 0.25 "
        "--terrain-size 3 4 --terrain-height 5 --timestep 0.005 --noise hardware --lidar-beams 90 "
        "--imu-rate 50 --fault imu:nan@1 --fault scan:empty"
    )
    assert config_of(run_parser().parse_args(words.split())) == EpisodeConfig(
        terrain="posts",
        robot="rover_zero4wd",
        seed=4,
        duration=7.0,
        driver="spin",
        difficulty=0.25,
        terrain_size=(3.0, 4.0),
        terrain_height=5.0,
        timestep=0.005,
        noise="hardware",
        lidar_beams=90,
        imu_rate=50,
        faults=("imu:nan@1", "scan:empty"),
    )


@pytest.mark.parametrize(
    ("words", "name", "value"),
    [
        ("--terrain-size 3", "terrain_size", (3.0, 3.0)),
        ("--noise", "noise", True),
        ("--rate max", "rate", None),
        ("--rate 0.01", "rate", 0.01),
        ("--rate 2.5", "rate", 2.5),
        ("--wait-for /a --wait-for /b", "wait_for", ["/a", "/b"]),
        ("--record a.mcap", "record", Path("a.mcap")),
        ("--report a.html", "report", Path("a.html")),
        ("--summary a.json", "summary", Path("a.json")),
        ("--picture a.png", "picture", Path("a.png")),
        ("--video a.mp4", "video", Path("a.mp4")),
        ("--log-dir logs", "log_dir", Path("logs")),
    ],
)
def test_an_option_means(words: str, name: str, value: object) -> None:
    assert getattr(run_parser().parse_args(words.split()), name) == value


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("--rate 0.0099", "give 'max' or a number from 0.01 up"),
        ("--rate fast", "'fast' is not valid"),
        ("--terrain-size 1 2 3", "give one or two numbers"),
    ],
)
def test_a_wrong_word_is_one_line_and_exit_code_2(
    words: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as leaving:
        run_parser().parse_args(words.split())
    assert leaving.value.code == 2
    text = capsys.readouterr().err
    assert text.startswith("harness.run: ")
    assert text.endswith("; see --help\n")
    assert text.count("\n") == 1
    assert told in text


@pytest.mark.parametrize(("given", "name"), [("rover1", "/rover1"), ("/a/b/", "/a/b")])
def test_a_namespace_becomes_a_remapping(given: str, name: str) -> None:
    assert namespace_args(given) == ["--ros-args", "-r", f"__ns:={name}", "--"]
    assert namespace_args("") == namespace_args("/") == []


@pytest.mark.parametrize(
    ("words", "flag"),
    [
        ("--no-metrics", "--no-metrics"),
        ("--wait-for /x", "--wait-for"),
        ("--namespace x", "--namespace"),
        ("--record x.mcap", "--record"),
        ("--driver cmd_vel", "--driver cmd_vel"),
    ],
)
def test_what_needs_ros_is_refused_without_it_alone(words: str, flag: str) -> None:
    check_combination(run_parser().parse_args(words.split()), ["--ros-args", "--"])
    options = run_parser().parse_args(["--direct", *words.split()])
    with pytest.raises(UsageError, match=rf"^{flag} needs ROS; leave out --direct"):
        check_combination(options, [])


def test_extended_columns_need_the_hosted_node() -> None:
    options = run_parser().parse_args(["--extended", "--no-metrics"])
    with pytest.raises(UsageError, match="start yours with"):
        check_combination(options, [])
    check_combination(run_parser().parse_args(["--extended", "--direct"]), [])
    with pytest.raises(UsageError, match="--ros-args needs ROS"):
        check_combination(run_parser().parse_args(["--direct"]), ["--ros-args", "--"])
