"""The commands as they are installed: rover-run is `python -m harness.run`, and so on.

Light to import: a program is made ready (Ctrl-C, missing libraries) before its libraries are loaded.
"""

import importlib
from functools import partial

from harness.cli.edge import begin_program


def start(module: str) -> int:
    """Runs the command of a module with the arguments of this process; returns its exit code."""
    begin_program(module.removesuffix(".__main__").removeprefix("rover_metrics."))
    code: int = importlib.import_module(module).main()
    return code


run = partial(start, "harness.run")
tune = partial(start, "harness.tune.__main__")
scenario = partial(start, "harness.scenario.__main__")
check = partial(start, "harness.check")
robot = partial(start, "harness.robot")
validate = partial(start, "harness.validate.__main__")
topics = partial(start, "harness.topics")
call = partial(start, "harness.call")
course = partial(start, "harness.course.__main__")
policy = partial(start, "harness.gym.policy_node")
analyze = partial(start, "rover_metrics.analyze")
replay = partial(start, "rover_metrics.replay")
social = partial(start, "rover_metrics.social")
