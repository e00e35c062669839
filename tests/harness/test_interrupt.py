import signal

import pytest

from harness.interrupt import Interrupted, StopRequest


def test_signal_ends_the_command_at_once_while_it_starts() -> None:
    with StopRequest(), pytest.raises(Interrupted) as caught:
        signal.raise_signal(signal.SIGINT)
    assert caught.value.exit_code == 130


def test_first_signal_is_remembered_while_deferred() -> None:
    with StopRequest() as stop, stop.deferred():
        signal.raise_signal(signal.SIGTERM)
        assert stop.signal is signal.SIGTERM
    assert stop.exit_code == 143


def test_second_signal_interrupts_even_while_deferred() -> None:
    with StopRequest() as stop, stop.deferred():
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(Interrupted):
            signal.raise_signal(signal.SIGINT)


def test_previous_handlers_return() -> None:
    before = signal.getsignal(signal.SIGINT)
    with StopRequest():
        assert signal.getsignal(signal.SIGINT) is not before
    assert signal.getsignal(signal.SIGINT) is before


def test_no_signal_means_exit_code_zero() -> None:
    with StopRequest() as stop:
        assert stop.exit_code == 0
