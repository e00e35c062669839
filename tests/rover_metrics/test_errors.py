import errno
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import pytest

from rover_metrics.errors import KnownError, LogError, is_worth_a_line, run_program
from rover_metrics.parser import OneLineParser

Capsys = pytest.CaptureFixture[str]

PACKAGE = Path(__file__).parents[2] / "rover_metrics"


class Failed(KnownError):
    exit_code = 1


HERE = f"(Python {sys.version.split()[0]}, {sys.executable})"


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (Failed("it left the map"), 1, "it left the map"),
        (LogError("a\nb"), 2, "a?b"),
        (OSError(errno.EACCES, "No", "/bag"), 2, "cannot use /bag: No; name another place"),
        (  # of a terminal's text into a full disk
            OSError(errno.ENOSPC, "No space left"),
            2,
            "cannot go on writing: No space left; free some, or write elsewhere",
        ),
        (ImportError("no rich", name="rich.table"), 2, f"no rich {HERE}; pip install 'rover-harness'"),
        (ImportError("no x", name="rclpy.node"), 2, f"no x {HERE}; pip install 'rover-harness[ros]'"),
        (ImportError("no x"), 2, f"no x {HERE}; pip install 'rover-harness'"),
        (
            FileNotFoundError(errno.ENOENT, "No"),  # of os.getcwd()
            2,
            "the current folder is gone; change to one that is there (cd)",
        ),
    ],
)
def test_a_known_error_ends_a_program_in_one_line(
    error: Exception, code: int, line: str, capsys: Capsys
) -> None:
    assert run_program("name", Mock(side_effect=error)) == code
    assert capsys.readouterr() == ("", f"name: {line}\n")


@pytest.mark.parametrize(
    "bug",
    [
        ValueError("x"),
        OSError(errno.EIO, "no file is named"),
        ImportError("cannot import name", name="harness.run"),
        ImportError("cannot import name", name="rover_metrics"),
    ],
)
def test_a_bug_keeps_its_trace(bug: Exception) -> None:
    with pytest.raises(type(bug)) as caught:
        run_program("name", Mock(side_effect=bug))
    assert caught.value is bug


@pytest.mark.parametrize(
    ("then", "code", "told"),
    [
        ("import no_such_library", 2, "name: No module named 'no_such_library' (Python "),
        ("raise errors.LogError('full')", 2, "name: full\n"),
        ("1 / 0", 1, "Traceback"),
    ],
)
def test_what_a_program_cannot_load_is_one_line(then: str, code: int, told: str) -> None:
    source = f"from rover_metrics import errors; errors.begin_program('name'); {then}"
    command = [sys.executable, "-S", "-c", source]
    run = subprocess.run(command, cwd=PACKAGE, capture_output=True, text=True, check=False)
    assert run.returncode == code
    assert run.stderr.startswith(told)
    assert run.stderr.count("\n") == 1 or code == 1


def test_a_count_is_worth_a_line_when_it_reaches_or_leaps_over_a_power_of_two() -> None:
    assert [now for now in range(1, 100) if is_worth_a_line(now - 1, now)] == [1, 2, 4, 8, 16, 32, 64]
    assert [now for now in range(5, 20) if is_worth_a_line(5, now)] == list(range(8, 20))
    assert not is_worth_a_line(4, 4)


def test_help_tells_the_default_of_each_option_as_it_would_be_typed() -> None:
    parser = OneLineParser(prog="x", description="One line.", epilog="Several\n  lines.")
    told = {0: "0", 0.1: "0.1", 90.0: "90", "50%": "50%", Path("a/b"): "a/b", ("p", "q"): "p q"}
    defaults: list[object] = [*told, None, "", []]
    for number, default in enumerate(defaults):
        parser.add_argument(f"--o{number}", default=default, metavar="V", help="text")
    parser.add_argument("--told", default=3, metavar="V", help="by default three")
    parser.add_argument("--switch", action="store_true", help="text")
    lines = parser.format_help().splitlines()
    helps = [line.partition("text")[2] for line in lines if line.startswith("  --")]
    assert helps == [*(f"; default: {text}" for text in told.values()), "", "", "", "", ""]
    assert lines[-2:] == ["Several", "  lines."]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("--spede 3", "unrecognized arguments: --spede 3; did you mean --speed; see --help"),
        ("--spede=3 x", "unrecognized arguments: --spede=3 x; did you mean --speed; see --help"),
        ("--wheels 6", "unrecognized arguments: --wheels 6; see --help"),
        ("6 --spede", "unrecognized arguments: 6 --spede; see --help"),
        ("--speed fast", "argument --speed: 'fast' is not valid; give a number; see --help"),
        ("--speed 1_0", "argument --speed: '1_0' is not valid; give a number; see --help"),
        ("--seed 1_0", "argument --seed: '1_0' is not valid; give a whole number; see --help"),
        ("--seed 1.5", "argument --seed: '1.5' is not valid; give a whole number; see --help"),
    ],
)
def test_a_wrong_word_is_told_with_the_mend(words: str, told: str, capsys: Capsys) -> None:
    parser = OneLineParser(prog="python -m harness.x")
    parser.add_argument("--speed", type=float)
    parser.add_argument("--seed", type=int)
    with pytest.raises(SystemExit) as end:
        parser.parse_args(words.split())
    assert end.value.code == 2
    assert capsys.readouterr().err == f"harness.x: {told}\n"


def test_a_program_of_many_commands_names_them(capsys: Capsys) -> None:
    parser = OneLineParser(prog="python -m harness.x")
    parser.add_subparsers(required=True, metavar="COMMAND").add_parser("check")
    with pytest.raises(SystemExit):
        parser.parse_args([])
    assert "(check)" in capsys.readouterr().err


def test_garbage_is_collected_from_the_work_on() -> None:
    code = "import gc; from rover_metrics.errors import begin_program, run_program\n"
    code += "begin_program('name'); print(gc.isenabled(), run_program('name', gc.isenabled))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False True\n"
