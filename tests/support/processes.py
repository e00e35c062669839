"""`--processes N`: the tests in N processes, which are forked from the one that has collected them.

Where each process collects for itself (pytest-xdist), each imports all that any test needs, once more:
on two cores a tenth of the time of this suite.
"""

import os
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import groupby
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import Any

import pytest

NUMBER = "PYTEST_PROCESS"  # of a process, in its environment
FORK = get_context("fork")
PORTIONS = 4  # of what is left, for each process: the fewer tests are left, the fewer are given out

PATIENCE = 10.0  # [s] for a process to end its test once nobody waits for it

Portion = tuple[int, int]  # the first test in the order of collection, and the one after the last
NOTHING = (0, 0)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--processes", type=int, default=1, help="that share the tests; 1: this one alone")


def pytest_configure(config: pytest.Config) -> None:
    processes = config.getoption("processes")
    if processes > 1 and not config.option.usepdb:
        config.pluginmanager.register(_Parent(config, processes))


def portions(files: Sequence[object], processes: int) -> Iterator[Portion]:
    """Yields what is given out at once: tests of one file, which share its fixtures.

    Args:
        files: The file of each test, in the order of collection.
        processes: How many share the tests.
    """
    start = 0
    for _, tests in groupby(files):
        end = start + len(list(tests))
        while start < end:
            most = max(1, (len(files) - start) // (PORTIONS * processes))
            yield start, min(start + most, end)
            start = min(start + most, end)


class _Parent:
    """Gives out tests and reports what the processes tell of them."""

    def __init__(self, config: pytest.Config, processes: int) -> None:
        self._config, self._processes = config, processes
        self._left: deque[Portion] = deque()
        self._running: dict[Connection, tuple[Any, Portion]] = {}  # each process, with what it has to do
        self._started = 0

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool | None:
        if session.testsfailed or self._config.option.collectonly:
            return None  # it is said, or shown, as without processes
        self._left.extend(portions([item.path for item in session.items], self._processes))
        _folders(self._config).getbasetemp()  # made once, for all
        try:
            for _ in range(min(self._processes, len(self._left))):
                self._start(session)
            while self._running:
                for ready in wait(list(self._running)):
                    assert isinstance(ready, Connection)
                    self._hear(session, ready)
        finally:
            for pipe, (process, _) in self._running.items():
                pipe.close()  # which it hears after its test
                process.join(PATIENCE)
                process.kill()
        return True

    def _start(self, session: pytest.Session) -> None:
        here, there = FORK.Pipe()
        child, others = _Child(session, there, self._started), [here, *self._running]
        process = FORK.Process(target=child.work, args=(others,))
        process.start()
        there.close()
        self._started += 1
        self._running[here] = process, NOTHING

    def _hear(self, session: pytest.Session, pipe: Connection) -> None:
        process, (first, end) = self._running[pipe]
        try:
            told = pipe.recv()
        except (EOFError, ConnectionResetError):
            del self._running[pipe]
            process.join()
            if first < end:
                self._tell_of_the_lost(session, process.exitcode, first, end)
            return
        if told is None:
            self._running[pipe] = process, self._left.popleft() if self._left else NOTHING
            pipe.send(self._running[pipe][1])
        elif isinstance(told, int):
            self._running[pipe] = process, (told, end)
        else:
            self._tell(session, told)

    def _tell(self, session: pytest.Session, told: dict[str, Any]) -> None:
        report = self._config.hook.pytest_report_from_serializable(config=self._config, data=told)
        self._config.hook.pytest_runtest_logreport(report=report)
        if session.shouldfail:
            raise session.Failed(session.shouldfail)

    def _tell_of_the_lost(self, session: pytest.Session, code: int, first: int, end: int) -> None:
        """A test that ended its process has failed; another process does the rest."""
        item = session.items[first]
        words = f"the process of this test ended with {code}"
        report = pytest.TestReport(item.nodeid, item.location, {}, "failed", words, "call")
        self._config.hook.pytest_runtest_logreport(report=report)
        if first + 1 < end:
            self._left.appendleft((first + 1, end))
        if self._left:
            self._start(session)


def _folders(config: pytest.Config) -> pytest.TempPathFactory:
    factory: pytest.TempPathFactory = config._tmp_path_factory  # type: ignore[attr-defined] # of tmpdir
    return factory


class _Child:
    """Runs the tests that it is given."""

    def __init__(self, session: pytest.Session, parent: Connection, number: int) -> None:
        self._session, self._parent, self._number = session, parent, number
        self._last = session.items[0]

    def work(self, others: Sequence[Connection]) -> None:
        """Until no tests are left; `others` are the ends of pipes that are not of this process."""
        for other in others:
            other.close()  # else no process would hear the end of the one that gives out tests
        self._settle(self._session.config)
        with suppress(EOFError, OSError, KeyboardInterrupt):  # nobody wants to know more
            try:
                while (portion := self._next()) != NOTHING:
                    self._run(*portion)
            finally:
                self._tear_down()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        config = self._session.config
        self._parent.send(config.hook.pytest_report_to_serializable(config=config, report=report))

    def _settle(self, config: pytest.Config) -> None:
        """Makes what this process shares with its parent its own: terminal, files, temporary folder."""
        os.environ[NUMBER] = str(self._number)
        plugins = config.pluginmanager
        plugins.unregister(plugins.get_plugin("terminalreporter"))
        plugins.register(self)
        capture: Any = plugins.get_plugin("capturemanager")
        capture.stop_global_capturing()
        capture.start_global_capturing()
        capture.suspend_global_capture()
        folder = _folders(config).mktemp(f"process{self._number}", numbered=False)
        _folders(config)._basetemp = folder

    def _next(self) -> Portion:
        self._parent.send(None)
        portion: Portion = self._parent.recv()
        return portion

    def _run(self, first: int, end: int) -> None:
        for index in range(first, end):
            self._parent.send(index)
            self._last = self._session.items[index]
            # What is set up for the session stays for the next portion, and nothing else.
            after: Any = self._session.items[index + 1] if index + 1 < end else self._session
            self._last.config.hook.pytest_runtest_protocol(item=self._last, nextitem=after)

    def _tear_down(self) -> None:
        """Ends what was set up for the session; what goes wrong is told as of the last test."""
        teardown = self._session._setupstate.teardown_exact
        call = pytest.CallInfo.from_call(lambda: teardown(None), "teardown", KeyboardInterrupt)
        if call.excinfo:
            hook = self._last.config.hook
            hook.pytest_runtest_logreport(
                report=hook.pytest_runtest_makereport(item=self._last, call=call)
            )
