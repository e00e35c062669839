"""The command line of harness.run: every flag reaches the field that it is named after."""

import re
import shlex
from dataclasses import replace
from operator import attrgetter
from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.base.files import BESIDE
from harness.cli.files import Files
from harness.cli.flags import flags_of
from harness.cli.options import RunOptions, parse_run, with_name
from harness.cli.run_parser import DEFAULT_LOG_DIR, run_parser
from harness.episode.metrics_feed import extended_settings
from harness.spec import Run
from harness.spec.live import LiveOptions
from harness.spec.ros import FrameOptions, RosOptions, parse_effect
from harness.spec.run import PARTS
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.extended.settings import Settings
from tests.support.rovers import LEO, ROVER_ZERO4WD


def parsed(words: str) -> RunOptions:
    options = parse_run(shlex.split(words))
    assert options is not None
    return options


def test_without_words_everything_is_the_default() -> None:
    assert parsed("") == RunOptions(
        run=Run(),
        ros=RosOptions(log_dir=DEFAULT_LOG_DIR),
        direct=False,
        settings=(Settings(),),
        params=None,
        files=Files(),
    )
    assert Path("metrics_analyzer/data/metric_logs") == DEFAULT_LOG_DIR


def test_every_option_of_a_value_is_a_flag_of_the_parser_with_help() -> None:
    actions = {flag: action for action in run_parser()._actions for flag in action.option_strings}
    for flag in flags_of(*PARTS.values(), Run, RosOptions, FrameOptions, Files).values():
        assert actions[flag].help


WORDS = (
    "--terrain posts --robot rover_zero4wd --seed 4 --duration 7 --driver spin --difficulty 0.25 "
    "--start -1.5,2,0.25 --timestep 0.005 --noise hardware --lidar-beams 90 --imu-rate 50 "
    "--fault imu:nan@1 --fault scan:empty --datum=-33.9,-70.6,520 --sensors gnss,depth=small "
    "--actor a=random --actor b=1,2"
)


def test_every_word_about_the_run_reaches_it() -> None:
    assert parsed(WORDS).run == Run.of(
        terrain="posts",
        robot="rover_zero4wd",
        seed=4,
        duration=7.0,
        driver="spin",
        difficulty=0.25,
        start=(-1.5, 2.0, 0.25),
        timestep=0.005,
        noise="hardware",
        lidar_beams=90,
        imu_rate=50,
        faults=["imu:nan@1", "scan:empty"],
        datum=(-33.9, -70.6, 520.0),
        sensors=["gnss", "depth=small"],
        actors=["a=random", "b=1,2"],
    )


@pytest.mark.parametrize(
    ("words", "name", "value"),
    [
        ("--terrain a.npy --terrain-size 30 40", "run.world.terrain_size", (30.0, 40.0)),
        ("--terrain a.sdf --rock a* --rock b*", "run.world.rock", ("a*", "b*")),
        ("--noise", "run.rover.noise", "white"),
        ("--driver cmd_vel --cmd-vel-timeout 1", "run.rover.cmd_vel_timeout", 1.0),
        ("--cmd-vel twist", "ros.cmd_vel", "twist"),
        ("--odom-tf wheels --map-tf", "ros.frames", FrameOptions(odom_tf="wheels", map_tf=True)),
        ("--rate max", "ros.rate", None),
        ("--rate 0.01", "ros.rate", 0.01),
        ("--no-metrics", "ros.host_metrics", False),
        ("--wait-for /a --wait-for /b", "ros.wait_for", ("/a", "/b")),
        ("--record a.mcap --overwrite", "ros.overwrite", True),
        ("--log-dir logs", "ros.log_dir", Path("logs")),
        ("--direct --driver goal --goal-area 0,1,0,1", "direct", True),
        ("--page a.html", "files.page", Path("a.html")),
        ("--report a.html", "files.page", Path("a.html")),  # as it was called
        ("--page", "files.page", BESIDE),
        ("--out a --picture b.png", "files", Files(out=Path("a"), page=BESIDE, picture=Path("b.png"))),
        ("--out a", "ros.log_dir", Path("a")),
        ("--fail-on hazard,tipped_over", "files.fail_on", ("hazard", "tipped_over")),
        ("--video a.mp4", "files.video", Path("a.mp4")),
        ("--actor a=random --social-log s.csv", "files.social_log", Path("s.csv")),
        ("--namespace rover1", "ros.ros_args", ("--ros-args", "-r", "__ns:=/rover1", "--")),
        ("--namespace /", "ros.ros_args", ()),
        ("--extended --ros-args -p fsync:=true", "ros.ros_args", ("--ros-args", "-p", "fsync:=true")),
        ("--soil dry_sand --keep-ruts", "run", Run.of(soil="dry_sand", keep_ruts=True)),
        ("--robot husky --actuators real --surface snow", "run.rover.surface", "snow"),
        ("--robot husky --actuators real", "run", Run.of(robot="husky", actuators="real")),
        ("--target post", "run", Run.of(targets=["post"])),
        ("--driver goal --route 1,2", "run", Run.of(driver="goal", route="1,2")),
        *(
            (f"--terrain {terrain} {words}", "run", Run.of(terrain=terrain, **values))
            for terrain, words, values in (
                ("a.png", "--terrain-height 3", {"terrain_height": 3.0}),
                ("a.npy", "--terrain-roughness D", {"terrain_roughness": "D"}),
                ("a.sdf", "--resource-path a --resource-path b", {"resource_path": ("a", "b")}),
                ("a.sdf", "--rock-height 0.2 --hazard h*", {"rock_height": 0.2, "hazard": ("h*",)}),
                ("a.obj", "--mesh-unit cm --mesh-up y", {"mesh_unit": "cm", "mesh_up": "y"}),
                ("a.obj", "--terrain-cell 0.2", {"terrain_cell": 0.2}),
            )
        ),
        ("--live 8080 --live-token aaaaaaaa", "live", LiveOptions(live="8080", live_token="a" * 8)),
        ("--live", "live", LiveOptions().served()),
        ("--foxglove 8080", "ros.foxglove", "8080"),
        ("--truth-map --wait-for-topic /a", "ros.truth_map", True),
        ("--wait-for-topic /a", "ros.wait_for_topic", (parse_effect("/a"),)),
        ("--odom-tf-3d", "ros.frames.odom_tf_3d", True),
        ("--json a.json", "files.summary", Path("a.json")),
        ("--picture --picture-lidar --camera top", "files.camera", "top"),
        ("--picture --picture-lidar", "files.picture_lidar", True),
    ],
)
def test_an_option_means(words: str, name: str, value: object) -> None:
    assert attrgetter(name)(parsed(words)) == value


def test_what_every_option_means_is_told_here() -> None:
    told = set(re.findall(r"--[\w-]+", Path(__file__).read_text()))
    elsewhere = ("help", "version", "columns")  # columns are of plug-ins alone
    actions = [action for action in run_parser()._actions if action.dest not in elsewhere]
    assert [each.dest for each in actions if not told.intersection(each.option_strings)] == []


def test_the_list_of_choices_is_no_run_whatever_else_is_asked_for() -> None:
    assert parse_run(["--list", "--extended", "--no-metrics"]) is None


TWO = "--terrain flat --rover leo:a"
GIVEN = {"wait_for": " /x", "wait_for_topic": " /x", "cmd_vel": " twist", "odom_tf": " wheels"}
WITHOUT_ROS = {"log_dir", "rate", "record", "foxglove", "overwrite"}
OF_ROS = [  # all that is not for a run without it, too
    f"--{name.replace('_', '-')}{GIVEN.get(name, '')}"
    for name, field in RosOptions.model_fields.items()
    if field.metadata and name not in WITHOUT_ROS
]


@pytest.mark.parametrize(
    ("words", "mend"),
    [
        ("--rate 0.0099", "--rate '0.0099' is not valid; give 0.01 or more"),
        ("--rate fast", "--rate 'fast' is not valid; give a number"),
        ("--terrain-size 1 2 3", "give at most 2"),
        ("--start 1", "give X,Y or X,Y,YAW in metres and radians"),
        ("--duration long", "--duration 'long' is not valid; give a number"),
        ("--seed -1", "--seed '-1' is not valid; give 0 or more"),
        ("--social-log s.csv", "--social-log is of a run with people; add --actor SPEC"),
        ("--keep-ruts", "--keep-ruts is of soil; name one with --soil"),
        ("--soil=", "names no soil; leave it out for rigid ground"),
        ("--overwrite", "--overwrite is for the file of --record or --social-log; name one"),
        ("--extended --no-metrics", "start yours with -p extended_columns:=true"),
        ("--odom-tf wheels --odom-tf-3d", "leave out --odom-tf wheels, or --odom-tf-3d"),
        ("--ros-args -p log_dir:=3", "give --log-dir FOLDER before it"),
        ("--ros-args -p /metrics_node:log_dir:=other", "give --log-dir FOLDER before it"),
        *(
            (f"--direct {words}", f"{words.split()[0]} needs ROS; leave out --direct")
            for words in ("--ros-args --", "--no-metrics", "--namespace x", *OF_ROS)
        ),
        *((f"--direct {flag}", "/tf, which nobody gets") for flag in ("--odom-tf none", "--map-tf")),
        ("--terrain-size 8", "--terrain-size '8' is not valid; give 10 to 50000"),
        ("--foxglove nowhere:x", "--foxglove 'nowhere:x' is not valid; give HOST, PORT or HOST:PORT"),
        ("--direct --driver cmd_vel", "--driver cmd_vel needs ROS; leave out --direct"),
        (
            "--direct --driver goal",
            "--driver goal without --route or --goal-area needs ROS",
        ),
        (f"{TWO} --namespace n", "name each as --rover ROBOT:NAME"),
        (f"{TWO} --robot rover_zero4wd", "is for a single rover"),
        (f"{TWO} --actor g=1,1 --social-log a.csv", "each --rover has its own below --log-dir"),
        (f"{TWO} --direct --rover leo:b,driver=cmd_vel,x=2,y=0", "--driver cmd_vel needs ROS"),
    ],
)
def test_a_mistake_is_one_line_with_the_mend(words: str, mend: str) -> None:
    with pytest.raises(UsageError) as refused:
        parsed(words)
    assert mend in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "words", ["--start --seed 1", "--sed 1", "--cmd-vel q", "--ros-args -p x:=1 --seed 3"]
)
def test_what_the_parser_refuses_is_one_line_and_exit_code_2(
    words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as leaving:
        parsed(words)
    text = capsys.readouterr().err
    assert (leaving.value.code, text.count("\n")) == (2, 1)
    assert text.startswith("harness.run: ")


def test_extended_columns_know_the_gravity_of_the_world(tmp_path: Path) -> None:
    box = "<geometry><box><size>20 20 1</size></box></geometry>"
    link = f"<link name='l'><collision name='c'>{box}</collision></link>"
    model = f"<model name='ground'><static>true</static>{link}</model>"
    file = tmp_path / "moon.sdf"
    world = f"<world name='moon'><gravity>0 0 -1.62</gravity>{model}</world>"
    file.write_text(f"<sdf version='1.9'>{world}</sdf>")
    (settings,) = parsed(f"--extended --terrain '{file}'").settings
    assert settings.extended == extended_settings(LEO, 1.62)


@pytest.mark.parametrize("way", ["", "--direct"])
def test_a_parameter_file_sets_the_metrics_after_what_the_rover_says(tmp_path: Path, way: str) -> None:
    file = tmp_path / "p.yaml"
    file.write_text("/**: {ros__parameters: {collision_threshold: 0.75, gravity: 9.0, fsync: true}}")
    options = parsed(f"{way} --extended --params '{file}'")
    (settings,) = options.settings
    assert settings.thresholds == Thresholds(collision_threshold=0.75)
    assert settings.extended == replace(extended_settings(LEO), gravity=9.0)
    assert (settings.extended_columns, settings.fsync, options.params) == (True, True, file)
    file.write_text("/**: {ros__parameters: {colision_threshold: 0.75}}")
    for words, mend in (
        (f"{way} --params '{file}'", "did you mean collision_threshold?"),
        (f"{way} --params '{tmp_path}'", "Is a directory"),
    ):
        with pytest.raises(UsageError, match=mend):
            parsed(words)


def test_a_rovers_metrics_take_the_parameters_of_its_namespace(tmp_path: Path) -> None:
    file = tmp_path / "p.yaml"
    sections = {"/a/metrics_node": 8.0, "/b/metrics_node": 9.0}
    file.write_text(
        "".join(f"{n}: {{ros__parameters: {{gravity: {g}}}}}\n" for n, g in sections.items())
    )
    words = f"--terrain flat --extended --params '{file}'"
    fleet = parsed(f"{words} --rover leo:a --rover leo:b,x=2,y=0").settings
    assert [settings.extended.gravity for settings in fleet] == [8.0, 9.0]
    fleet = parsed(f"{words} --rover leo:a --rover leo:c,x=2,y=0").settings
    assert [settings.extended.gravity for settings in fleet] == [8.0, extended_settings(LEO).gravity]
    (alone,) = parsed(f"{words} --namespace b").settings
    assert alone.extended.gravity == 9.0
    for nobodys in ("", "--rover leo:c --rover leo:d,x=2,y=0"):
        with pytest.raises(UsageError, match=r"no section '.*/metrics_node.*it has /a/metrics_node"):
            parsed(f"{words} {nobodys}")


def test_several_rovers_have_logs_pages_and_settings_each() -> None:
    words = "--terrain flat --extended --log-dir logs"
    options = parsed(f"{words} --rover leo:a --rover rover_zero4wd:b,x=2,y=0")
    rovers = options.run.rovers
    assert [options.log_dir(rover) for rover in rovers] == [Path("logs/a"), Path("logs/b")]
    pages = [with_name(Path("out/run.html"), rover) for rover in rovers]
    assert pages == [Path("out/run_a.html"), Path("out/run_b.html")]
    extended = [settings.extended for settings in options.settings]
    assert extended == [extended_settings(LEO), extended_settings(ROVER_ZERO4WD)]
    assert [output.settings for output in options.outputs()] == [*options.settings]
    alone = parsed(words)
    assert alone.log_dir(alone.run.rover) == Path("logs")
    assert with_name(Path("run.html"), alone.run.rover) == Path("run.html")
