"""What a command says of a mistake."""

from collections.abc import Callable, Sequence

import pytest


def complaint(
    main: Callable[[list[str]], int], words: Sequence[str], capsys: pytest.CaptureFixture[str]
) -> str:
    """Returns the one line of a command line that is refused, with exit code 2."""
    try:
        code: object = main(list(words))
    except SystemExit as leaving:  # argparse's way
        code = leaving.code
    told = capsys.readouterr().err
    assert code == 2
    assert told.count("\n") == 1
    assert "Traceback" not in told
    return told


def without_progress(told: str) -> list[str]:
    """The lines of stderr but for those of progress, which come where a run takes long."""
    return [line for line in told.splitlines() if not line.endswith(" s left")]
