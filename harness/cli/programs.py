# PYTHON_ARGCOMPLETE_OK
"""The commands as they are installed: `rover run` and rover-run are `python -m harness.run`, and so on.

Light to import: a program is made ready (Ctrl-C, missing libraries) before its libraries are loaded.
"""

import importlib
import os
import sys
from functools import partial
from typing import NamedTuple

from harness.base.edge import begin_program
from harness.base.version import __version__
from rover_metrics.errors import unknown
from rover_metrics.parser import COMPLETED, OneLineParser


class Program(NamedTuple):
    """One command: the module that has its `main`, and what it does."""

    module: str
    about: str


PROGRAMS = {
    "run": Program("harness.run", "drive rovers over a terrain, log traversal metrics"),
    "scenario": Program("harness.scenario.__main__", "drives with expectations: which of them pass"),
    "robot": Program("harness.robot", "make a rover of a URDF or a template, check it"),
    "course": Program("harness.course.__main__", "scores on tracks, and receipts to drive again"),
    "tune": Program(
        "harness.tune.__main__", "thresholds of the metrics from drives whose truth is known"
    ),
    "analyze": Program("rover_metrics.analyze", "statistics, plots and comparisons of logs"),
    "view": Program(
        "harness.play", "a recording on the page of `run --live`, with a slider of its time"
    ),
    "replay": Program("rover_metrics.replay", "the metrics of a recording"),
    "social": Program("rover_metrics.social", "how near rovers came to people, from their logs"),
    "check": Program("harness.check", "whether two runs here have the same bytes"),
    "validate": Program("harness.validate.__main__", "the simulation against physics and real wheels"),
    "fit": Program("harness.fit.__main__", "the numbers of a rover from a recording of the real one"),
    "policy": Program("harness.gym.policy", "drive by a learnt policy, evaluate one, train one"),
    "topics": Program("harness.topics", "which topics there are, and how fast"),
    "teleop": Program("harness.teleop", "drive a rover by the keys of this terminal"),
    "call": Program("harness.call", "call a service, e.g. /harness/reset"),
}
COMPLETION = "completion"
VERBS = (*PROGRAMS, COMPLETION)
SHELLS = ("bash", "zsh", "fish")


def start(module: str) -> int:
    """Runs the command of a module with the arguments of this process; returns its exit code."""
    begin_program(module.removesuffix(".__main__").removeprefix("rover_metrics."))
    code: int = importlib.import_module(module).main()
    return code


def __getattr__(verb: str) -> partial[int]:
    """Returns what the script rover-VERB starts."""
    if verb not in PROGRAMS:
        raise AttributeError(verb)
    return partial(start, PROGRAMS[verb].module)


def rover() -> int:
    """Runs `rover VERB ...`; returns the verb's exit code."""
    parser = _parser()
    words = sys.argv[1:] if COMPLETED not in os.environ else _words_so_far()
    if words and words[0] in PROGRAMS:
        sys.argv = [f"rover {words[0]}", *words[1:]]
        return start(PROGRAMS[words[0]].module)
    if words[:1] == [COMPLETION]:
        return _completion(words[1:])
    options = parser.parse_args(["--help"] if words == ["help"] else words[:1])
    if options.verb is not None:
        parser.error(unknown("command", options.verb, VERBS))
    parser.print_help()
    return 0


def _parser() -> OneLineParser:
    width = max(map(len, PROGRAMS))
    verbs = "\n".join(f"  {verb:{width}}  {program.about}" for verb, program in PROGRAMS.items())
    parser = OneLineParser(
        prog="rover",
        usage="rover COMMAND ...",
        description=f"commands:\n{verbs}\n\nCOMMAND --help tells more.",
        epilog='Words are completed by a shell that has: eval "$(rover completion bash)", zsh or fish.',
    )
    verb = parser.add_argument("verb", nargs="?", metavar="COMMAND", help="one of the above")
    verb.completer = lambda **_: VERBS  # type: ignore[attr-defined] # argcomplete's
    parser.add_argument("--version", action="version", version=f"rover-harness {__version__}")
    return parser


def _words_so_far() -> list[str]:
    """The words before the one that the shell completes; tells the verb's parser where they begin."""
    line = os.environ["COMP_LINE"][: int(os.environ["COMP_POINT"])]
    words = line.split()[1:]
    if len(words) > 1 or line.endswith(" "):
        if words and words[0] in PROGRAMS:
            os.environ[COMPLETED] = str(int(os.environ[COMPLETED]) + 1)
        return words
    return []


def _completion(shells: list[str]) -> int:
    parser = OneLineParser(prog="rover completion", description="Prints what a shell evaluates.")
    about = f'{", ".join(SHELLS)}, e.g. eval "$(rover completion bash)"'
    parser.add_argument("kind", metavar="SHELL", choices=SHELLS, help=about)
    from argcomplete.shell_integration import shellcode  # noqa: PLC0415 - only this needs it

    scripts = ["rover", *(f"rover-{verb}" for verb in PROGRAMS)]
    print(shellcode(scripts, True, parser.parse_args(shells).kind))
    return 0
