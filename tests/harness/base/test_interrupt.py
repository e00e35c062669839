import signal
from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from harness.base.interrupt import ALARMS, GRACE, HANDLED, Interrupted, Overdue, StopRequest


def test_signal_ends_the_command_at_once_while_it_starts() -> None:
    with StopRequest(), pytest.raises(Interrupted) as caught:
        signal.raise_signal(signal.SIGINT)
    assert caught.value.exit_code == 130


def test_second_signal_interrupts_even_while_deferred() -> None:
    with StopRequest() as stop, stop.deferred():
        assert stop.exit_code == 0
        signal.raise_signal(signal.SIGTERM)
        assert (stop.signal, stop.exit_code) == (signal.SIGTERM, 143)
        with pytest.raises(Interrupted):
            signal.raise_signal(signal.SIGINT)


def test_after_the_deferral_a_signal_ends_the_command_at_once_again() -> None:
    with StopRequest() as stop:
        with stop.deferred():
            pass
        with pytest.raises(Interrupted):
            signal.raise_signal(signal.SIGTERM)


def test_previous_handlers_return() -> None:
    before = [signal.getsignal(number) for number in HANDLED]
    with StopRequest():
        during = [signal.getsignal(number) for number in HANDLED]
        assert all(a is not b for a, b in zip(before, during, strict=True))
    assert [signal.getsignal(number) for number in HANDLED] == before
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


@pytest.fixture
def hangup() -> Iterator[None]:
    """SIGHUP as most terminals leave it, whoever started this run."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.usefixtures("hangup")
def test_a_closed_terminal_is_a_request_too_except_under_nohup() -> None:
    with StopRequest() as stop, stop.deferred():
        signal.raise_signal(signal.SIGHUP)
        assert stop.signal is signal.SIGHUP
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with StopRequest() as stop:
        signal.raise_signal(signal.SIGHUP)
        assert stop.signal is None


@pytest.mark.usefixtures("hangup")
def test_outputs_on_a_closed_terminal_go_nowhere(monkeypatch: pytest.MonkeyPatch) -> None:
    moved: list[tuple[int, int]] = []
    monkeypatch.setattr("harness.base.interrupt.os.isatty", lambda fd: fd == 2)
    monkeypatch.setattr("harness.base.interrupt.os.dup2", lambda *fds: moved.append(fds))
    with StopRequest() as stop, stop.deferred():
        signal.raise_signal(signal.SIGTERM)
    assert moved == []
    with StopRequest() as stop, stop.deferred():
        signal.raise_signal(signal.SIGHUP)
    ((_, output),) = moved
    assert output == 2


def test_a_request_that_nobody_answers_is_overdue_again_and_again() -> None:
    def hang() -> None:
        with StopRequest() as stop, stop.deferred():
            signal.raise_signal(signal.SIGINT)
            first, again = signal.getitimer(signal.ITIMER_REAL)
            assert 0.0 < first <= again == GRACE / ALARMS
            for _ in range(ALARMS - 1):  # one is as long as this process was stopped
                signal.raise_signal(signal.SIGALRM)
            for _ in range(2):
                with pytest.raises(Overdue, match="stopped by SIGINT") as caught:
                    signal.raise_signal(signal.SIGALRM)
                assert caught.value.exit_code == 130
            raise RuntimeError("what a C++ binding makes of it")

    with pytest.raises(Interrupted):
        hang()
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_an_error_of_its_own_stays_what_it_is() -> None:
    def fail() -> None:
        with StopRequest() as stop, stop.deferred():
            signal.raise_signal(signal.SIGINT)
            raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        fail()


def test_a_sleep_is_as_long_as_asked_and_ends_with_a_request(monkeypatch: pytest.MonkeyPatch) -> None:
    now, naps, stop = [100.0], list[float](), StopRequest()

    def nap(seconds: float) -> None:
        naps.append(seconds)
        now[0] += seconds
        if now[0] > 200.0:
            stop.signal = signal.SIGTERM

    wall = SimpleNamespace(monotonic=lambda: now[0], sleep=nap)
    monkeypatch.setattr("harness.base.interrupt.time", wall)
    stop.sleep(0.25)
    assert naps == pytest.approx([0.1, 0.1, 0.05])
    now[0] = 199.95
    stop.sleep(5.0)
    assert now[0] == pytest.approx(200.05)
