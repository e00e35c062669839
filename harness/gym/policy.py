"""Command: drive by a policy through ROS, evaluate one in unseen worlds, train one.

    python -m harness.gym.policy drive FILE.npz --goal 3,1 --ros-args -p use_sim_time:=true
    python -m harness.gym.policy evaluate FILE.npz --worlds 100 --page policy.html
    python -m harness.gym.policy train train.yaml

Parses, calls, prints.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.base.edge import begin_program, loading, run_program

if __name__ == "__main__":
    begin_program("harness.gym.policy")

from harness.base.errors import UsageError, find_named
from harness.cli.sheets import add_files, files_of, write_sheets
from rover_metrics.parser import OneLineParser

DRIVE, WORLDS, EVALUATED_ON = "drive", 100, ("gravel", "rocky")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    words = [*(sys.argv[1:] if arguments is None else arguments)]
    if words[:1] == [DRIVE] or (words and words[0].endswith(".npz")):  # as before there were others
        from harness.gym import policy_node

        return policy_node.main(words[words[0] == DRIVE :])
    options = _parser().parse_args(words)
    return run_program("harness.gym.policy", lambda: options.do(options))


def _evaluate(options: argparse.Namespace) -> int:
    if options.worlds < 1:
        raise UsageError(f"--worlds {options.worlds} is not valid; give 1 or more")
    with loading():
        from harness.cli.console import counted
        from harness.drivers.policy import read_policy
        from harness.gym.evaluation import table
        from harness.robots import find_rover
        from harness.world.files import is_terrain_file
        from harness.world.terrains import TERRAINS
        from rover_metrics.sheet.console import PlainConsole
        from rover_metrics.sheet.render import terminal
    policy, console = read_policy(options.file), PlainConsole()
    for terrain in options.terrain:
        if not is_terrain_file(terrain):
            find_named("terrain", terrain, TERRAINS)
    find_rover(options.robot)
    files = files_of(options)
    with counted(console, f"driving {options.file.name}") as show:
        sheet = table(policy, options.terrain, options.worlds, show, robot=options.robot)
    console.print(*terminal((sheet,), console.width), sep="\n")
    write_sheets(files, f"Policy {options.file.name}", [sheet])
    return 0


def _train(options: argparse.Namespace) -> int:
    try:
        from harness.gym.training import train
    except ModuleNotFoundError as error:
        mend = "pip install 'rover-harness[train]'"
        raise UsageError(f"training needs {error.name}: {mend}") from error
    from harness.base.documents import read_mapping

    train(read_mapping(options.config), str(options.config))
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.gym.policy", description="Policies of PointNav (docs/gym.md)."
    )
    commands = parser.add_subparsers(
        required=True, metavar="COMMAND", parser_class=OneLineParser, help="COMMAND --help tells more"
    )
    drive = commands.add_parser(DRIVE, help="drive a rover through ROS 2", add_help=False)
    drive.add_argument("words", nargs=argparse.REMAINDER, help="as harness.gym.policy_node takes them")
    evaluate = commands.add_parser("evaluate", help="count goals reached in unseen worlds")
    evaluate.add_argument("file", type=Path, metavar="FILE.npz", help="the policy")
    about = "on each terrain (default: %(default)s)"
    evaluate.add_argument("--worlds", type=int, default=WORLDS, metavar="N", help=about)
    about = f"where (default: {' '.join(EVALUATED_ON)})"
    evaluate.add_argument("--terrain", nargs="+", default=EVALUATED_ON, metavar="NAME|FILE", help=about)
    about = "a rover that ships, or a folder (default: %(default)s)"
    evaluate.add_argument("--robot", default="leo", metavar="NAME|FOLDER", help=about)
    add_files(evaluate)
    evaluate.set_defaults(do=_evaluate)
    training = commands.add_parser("train", help="learn PointNav by PPO (extra [train])")
    training.add_argument("config", type=Path, metavar="CONFIG", help="YAML (docs/gym.md)")
    training.set_defaults(do=_train)
    return parser


if __name__ == "__main__":
    sys.exit(main())
