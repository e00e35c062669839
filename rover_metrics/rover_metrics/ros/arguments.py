"""The options behind `--ros-args` on a command line, separated and checked without rclpy."""

import argparse
import difflib
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from rover_metrics.errors import shown
from rover_metrics.log.documents import DocumentError, read_yaml
from rover_metrics.parser import OneLineParser

START, END = "--ros-args", "--"
_WITH_VALUE = (
    *("-p", "--param", "-r", "--remap", "--params-file", "-e", "--enclave"),
    *("--log-level", "--log-config-file", "--log-file-name"),
)
_SWITCHES = tuple(
    f"--{verb}-{sink}-logs"
    for sink in ("rosout", "stdout", "external-lib")
    for verb in ("enable", "disable")
)
_SOURCE = re.compile(r", at /[^ ,]+:\d+")  # where rcl's authors would look
_REMAPPING = re.compile(r"\S+?:=(?!(\S*/)?\d)\S+")  # no part of a name begins with a digit
OPTIONS = (*_WITH_VALUE, *_SWITCHES)


def split_ros_args(words: Iterable[str]) -> tuple[list[str], list[str]]:
    """Separates the words of a command line as ROS nodes do: its own, and each `--ros-args ... [--]`."""
    own, ros, behind = list[str](), list[str](), False
    for word in words:
        behind = behind or word == START
        (ros if behind else own).append(word)
        behind = behind and word != END
    return own, ros


def parsed_beside_ros(
    parser: OneLineParser, words: Iterable[str]
) -> tuple[argparse.Namespace, list[str]]:
    """Returns the options of a program that a parser knows, and the checked words for ROS.

    It leaves the program where one of either is not valid.
    """
    own, ros = split_ros_args(words)
    if (wrong := complaint(ros, parser._option_string_actions)) is not None:  # noqa: SLF001 - all options
        parser.error(wrong)
    return parser.parse_args(own), ros


def check_words(name: str, words: Iterable[str]) -> None:
    """Leaves a node's program after --help, or where a word is not ROS's; it has none of its own."""
    OneLineParser(
        prog=name,
        usage=f"{name} [-h] [{START} -p NAME:=VALUE -r FROM:=TO --params-file FILE ...]",
        description="Logs the traversal metrics of a rover once a second, until a signal ends it. Its "
        "parameters, and how topics are renamed, stand behind --ros-args; docs/parameters.md has all.",
    ).parse_args(split_ros_args(words)[0])


def complaint(words: Sequence[str], own: Iterable[str] = ()) -> str | None:
    """Returns what is wrong with the options behind `--ros-args`, with the nearest valid one.

    A parameter file is read within bounds, before rcl reads it. The options of the command itself, its
    `own`, stand elsewhere.
    """
    behind, option = False, ""  # the one that awaits its value
    for word in words:
        if option and (wrong := _invalid(option, word)):
            return wrong
        if option:
            option = ""
        elif word == START or (behind and word == END):
            behind = word == START
        elif behind and word in _WITH_VALUE:
            option = word
        elif behind and word not in _SWITCHES:
            return _unknown(word, tuple(own))
    return None


def refusal(error: Exception) -> str:
    """Returns why rclpy does not start, in one line, with the mend where it says none."""
    reason = " ".join(str(error).split())
    mend = "; ROS_LOG_DIR names another folder" if re.search("log(ging)? directory", reason) else ""
    return _SOURCE.sub("", reason) + mend


def _invalid(option: str, value: str) -> str | None:
    """What is wrong with the value of an option, as far as it is known before rcl reads it."""
    try:
        if option == "--params-file":
            read_yaml(Path(value))
    except DocumentError as error:
        return f"cannot read parameters from {value}: {error}"
    # Else rcl would print a line of its own beside the error.
    if option in ("-r", "--remap") and not _REMAPPING.fullmatch(value):
        return f"{option} '{shown(value)}' is not valid; give FROM:=TO, e.g. scan:=front/scan"
    return None


def _unknown(word: str, own: Sequence[str]) -> str:
    option = word.partition("=")[0]
    if option in own:
        return (
            f"{option} stands behind {START}, where options are ROS's; give it before, or behind {END}"
        )
    (nearest,) = difflib.get_close_matches(option, (*OPTIONS, *own), n=1, cutoff=0.0)
    where = f", before {START}" if nearest in own else ""
    return f"{START} knows no '{word}'; did you mean {nearest}{where}?"
