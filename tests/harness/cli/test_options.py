import shlex
from dataclasses import replace
from operator import attrgetter
from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.cli.options import RunOptions, parse_run
from harness.cli.run_parser import DEFAULT_LOG_DIR
from harness.episode.metrics_feed import extended_parameters, extended_settings, parameter_words
from harness.robots import RoverSpec
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.extended.settings import Settings
from tests.support.rovers import LEO, ROVER_ZERO4WD


def parsed(words: str) -> RunOptions:
    options = parse_run(shlex.split(words))
    assert options is not None
    return options


def test_without_words_all_options_are_the_default_ones() -> None:
    assert parsed("") == RunOptions(
        fleet=(Run(),),
        ros=RosOptions(log_dir=DEFAULT_LOG_DIR),
        direct=False,
        all_settings=(Settings(),),
        parameters=({},),
        params=None,
        report=None,
        summary=None,
        picture=None,
        video=None,
        picture_lidar=False,
        social_log=None,
    )
    assert Path("metrics_analyzer/data/metric_logs") == DEFAULT_LOG_DIR


def test_every_word_about_the_episode_reaches_it() -> None:
    words = (
        "--terrain posts --robot rover_zero4wd --seed 4 --duration 7 --driver spin --difficulty 0.25 "
        "--terrain-size 3 4 --terrain-height 5 --start -1.5,2,0.25 --timestep 0.005 "
        "--noise hardware --lidar-beams 90 --imu-rate 50 --fault imu:nan@1 --fault scan:empty"
    )
    assert parsed(words).config == Run.of(
        terrain="posts",
        robot="rover_zero4wd",
        seed=4,
        duration=7.0,
        driver="spin",
        difficulty=0.25,
        terrain_size=(3.0, 4.0),
        terrain_height=5.0,
        start=(-1.5, 2.0, 0.25),
        timestep=0.005,
        noise="hardware",
        lidar_beams=90,
        imu_rate=50,
        faults=("imu:nan@1", "scan:empty"),
    )


@pytest.mark.parametrize(
    ("words", "name", "value"),
    [
        ("--terrain-size 3", "config.terrain_size", (3.0, 3.0)),
        ("--start -3,4", "config.start", (-3.0, 4.0, 0.0)),
        ("--start=-3,-4,-1", "config.start", (-3.0, -4.0, -1.0)),
        ("--datum -33.9,151.2", "config.datum", (-33.9, 151.2, 0.0)),
        ("--datum=-33.9,-70.6,520", "config.datum", (-33.9, -70.6, 520.0)),
        ("--noise", "config.noise", "white"),
        ("--cmd-vel twist", "ros.cmd_vel", "twist"),
        ("--cmd-vel stamped", "ros.cmd_vel", "stamped"),
        ("--rate max", "ros.rate", None),
        ("--rate 0.01", "ros.rate", 0.01),
        ("--rate 2.5", "ros.rate", 2.5),
        ("--no-metrics", "ros.host_metrics", False),
        ("--wait-for /a --wait-for /b", "ros.wait_for", ("/a", "/b")),
        ("--record a.mcap", "ros.record", Path("a.mcap")),
        ("--record a.mcap --overwrite", "ros.overwrite", True),
        ("--log-dir logs", "ros.log_dir", Path("logs")),
        ("--direct", "direct", True),
        ("--extended", "settings.extended_columns", True),
        ("--extended --direct", "direct", True),
        ("--direct --driver goal --goal-area 0,1,0,1", "direct", True),
        ("--report a.html", "report", Path("a.html")),
        ("--summary a.json", "summary", Path("a.json")),
        ("--picture a.png", "picture", Path("a.png")),
        ("--picture-lidar", "picture_lidar", True),
        ("--video a.mp4", "video", Path("a.mp4")),
        ("--actor a=random --actor b=1,2", "config.actors", ("a=random", "b=1,2")),
        ("--goal-area -.5,2,-3,4", "config.goal_area", (-0.5, 2.0, -3.0, 4.0)),
        ("--actor a=random --social-log s.csv", "social_log", Path("s.csv")),
    ],
)
def test_an_option_means(words: str, name: str, value: object) -> None:
    assert attrgetter(name)(parsed(words)) == value


def test_the_list_of_choices_is_no_run_whatever_else_is_asked_for() -> None:
    assert parse_run(["--list", "--extended", "--no-metrics"]) is None


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("--rate 0.0099", "give 'max' or a number from 0.01 up"),
        ("--rate fast", "'fast' is not valid"),
        ("--terrain-size 1 2 3", "give one or two numbers"),
        ("--start 1", "'1' is not valid; give X,Y or X,Y,YAW in metres and radians"),
        ("--start 1,2,3,4", "'1,2,3,4' is not valid"),
        ("--start 1,north", "'1,north' is not valid"),
        ("--datum 51", "'51' is not valid; give LAT,LON or LAT,LON,ALT in degrees and metres"),
        ("--start --seed 1", "argument --start: expected one argument"),
        ("--goal-area 1,2,3", "'1,2,3' is not valid; give XMIN,XMAX,YMIN,YMAX in metres"),
        ("--seed 1 --start", "expected one argument"),
    ],
)
def test_a_wrong_word_is_one_line_and_exit_code_2(
    words: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as leaving:
        parse_run(words.split())
    assert leaving.value.code == 2
    text = capsys.readouterr().err
    assert text.startswith("harness.run: ")
    assert text.endswith("; see --help\n")
    assert text.count("\n") == 1
    assert told in text


@pytest.mark.parametrize(("given", "name"), [("rover1", "/rover1"), ("/a/b/", "/a/b")])
def test_a_namespace_becomes_a_remapping(given: str, name: str) -> None:
    assert parsed(f"--namespace {given}").ros.ros_args == ("--ros-args", "-r", f"__ns:={name}", "--")
    assert parsed("--namespace /").ros.ros_args == ()


def told_node(rover: RoverSpec, gravity: float | None = None) -> list[str]:
    return parameter_words(extended_parameters(extended_settings(rover, gravity)))


def test_what_the_user_tells_ros_comes_last_and_so_holds() -> None:
    own = ("--ros-args", "-p", "log_dir:=x")
    for rover in (LEO, ROVER_ZERO4WD):
        words = f"--namespace a --extended --robot {rover.name} {' '.join(own)}"
        namespace = ("--ros-args", "-r", "__ns:=/a", "--")
        assert parsed(words).ros.ros_args == (*namespace, *told_node(rover), *own)


@pytest.mark.parametrize(
    ("words", "flag"),
    [
        ("--no-metrics", "--no-metrics"),
        ("--wait-for /x", "--wait-for"),
        ("--namespace x", "--namespace"),
        ("--record x.mcap", "--record"),
        ("--driver cmd_vel", "--driver cmd_vel"),
        ("--driver goal", "--driver goal without --goal-area"),
    ],
)
def test_what_needs_ros_is_refused_without_it_alone(words: str, flag: str) -> None:
    parsed(f"{words} --ros-args --")
    with pytest.raises(UsageError, match=rf"^{flag} needs ROS; leave out --direct"):
        parse_run(["--direct", *words.split()])


def test_extended_columns_know_the_gravity_of_the_world(tmp_path: Path) -> None:
    box = "<geometry><box><size>20 20 1</size></box></geometry>"
    link = f"<link name='l'><collision name='c'>{box}</collision></link>"
    model = f"<model name='ground'><static>true</static>{link}</model>"
    world = f"<world name='moon'><gravity>0 0 -1.62</gravity>{model}</world>"
    file = tmp_path / "moon.sdf"
    file.write_text(f"<sdf version='1.9'>{world}</sdf>")
    told = parsed(f"--extended --terrain '{file}'")
    assert told.settings.extended == extended_settings(LEO, 1.62)
    assert told.settings.extended.gravity == told.config.gravity() == 1.62
    assert told.ros.ros_args == tuple(told_node(LEO, 1.62))
    assert "gravity:=1.62" in told.ros.ros_args
    assert parsed("--extended").settings.extended.gravity == LEO.gravity


def test_a_parameter_file_says_what_the_metrics_are_made_with_after_the_rover_and_before_the_user(
    tmp_path: Path,
) -> None:
    file = tmp_path / "p.yaml"
    file.write_text("/**: {ros__parameters: {collision_threshold: 0.75, gravity: 9.0, fsync: true}}")
    own = ("--ros-args", "-p", "gravity:=8.0")
    told = parsed(f"--extended --params '{file}' {' '.join(own)}")
    words = ("-p", "collision_threshold:=0.75", "-p", "gravity:=9.0", "-p", "fsync:=true")
    assert told.ros.ros_args == (*told_node(LEO), "--ros-args", *words, "--", *own)
    assert told.settings.thresholds == Thresholds(collision_threshold=0.75)
    assert told.settings.extended == replace(extended_settings(LEO), gravity=9.0)
    assert (told.settings.extended_columns, told.params) == (True, file)
    alone = parsed(f"--direct --params '{file}'").settings
    assert alone == Settings().updated({"collision_threshold": 0.75, "gravity": 9.0, "fsync": True})
    file.write_text("/**: {ros__parameters: {colision_threshold: 0.75}}")
    for words_of_a_mistake, mend in (
        (f"--direct --params '{file}'", "did you mean collision_threshold?"),
        (f"--params '{tmp_path}'", "Is a directory"),
        (f"--no-metrics --params '{file}'", "start yours with --ros-args --params-file FILE"),
        ("--ros-args -p x:=1 --seed 3", "--seed stands behind --ros-args"),
    ):
        with pytest.raises(UsageError) as refused:
            parsed(words_of_a_mistake)
        assert mend in str(refused.value)
        assert "\n" not in str(refused.value)


def test_several_rovers_have_a_folder_pages_and_parameters_each() -> None:
    words = "--terrain flat --extended --report out/run.html --summary run.json --log-dir logs"
    told = parsed(f"{words} --rover leo:a --rover rover_zero4wd:b,x=2,y=0")
    assert [told.log_dir(config) for config in told.fleet] == [Path("logs/a"), Path("logs/b")]
    assert [told.report_of(config) for config in told.fleet] == [
        Path("out/run_a.html"),
        Path("out/run_b.html"),
    ]
    assert told.summary_of(told.config) == Path("run_a.json")
    for rover, settings, own in zip(
        (LEO, ROVER_ZERO4WD), told.all_settings, told.parameters, strict=True
    ):
        assert settings.extended == extended_settings(rover)
        assert own == extended_parameters(settings.extended)
    assert told.ros.ros_args == ()
    alone = parsed(words)
    assert (alone.log_dir(alone.config), alone.report_of(alone.config)) == (
        Path("logs"),
        Path("out/run.html"),
    )
    assert alone.parameters == ({},)


TWO = "--terrain flat --rover leo:a"


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("--social-log s.csv", "--social-log is of a run with people; add --actor SPEC"),
        ("--overwrite", "--overwrite is for the file of --record; name one"),
        ("--extended --no-metrics", "start yours with"),
        ("--direct --ros-args --", "--ros-args needs ROS"),
        (f"{TWO} --namespace n", "--namespace is for a single rover: name each as --rover ROBOT:NAME"),
        (f"{TWO} --robot rover_zero4wd", "is for a single rover: give --rover rover_zero4wd beside"),
        (f"{TWO} --actor g=1,1 --social-log a.csv", "--social-log is for a single rover: each --rover"),
        (f"{TWO} --direct --rover leo:b,driver=cmd_vel,x=2,y=0", "--driver cmd_vel needs ROS"),
        (f"{TWO} --direct --rover leo:b,driver=goal,x=2,y=0", "goal without --goal-area needs ROS"),
    ],
)
def test_what_makes_no_sense_together_is_refused(words: str, told: str) -> None:
    with pytest.raises(UsageError, match=told):
        parsed(words)
