"""A pytest session that runs chosen tests again and again, each time in a fork of the collected one."""

import functools
import gc
import importlib
import json
import os
import signal
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import coverage
import pytest

_MEMOISED = type(functools.cache(int))
ALONE = "ros_domain"  # tests that use this fixture wait for discovery
Lines = dict[str, dict[int, set[str]]]  # file -> line -> tests
OPTIONS = (
    *("-q", "-s", "--tb=no", "--assert=plain", "-p", "no:cacheprovider"),
    *("-W", "ignore::pytest.PytestAssertRewriteWarning"),
)
DIED = "time-out or crash"


@dataclass
class Trace:
    """What tests cover and cost.

    Attributes:
        lines: The tests that execute a line, also by way of a fixture that they share; by file.
        costs: Seconds of each test that passes, with its fixtures.
        slow: Tests that are used only for what no other test covers.
    """

    lines: Lines = field(default_factory=dict)
    costs: dict[str, float] = field(default_factory=dict)
    slow: set[str] = field(default_factory=set)

    def add(self, other: "Trace") -> None:
        """Takes in what other tests cover."""
        self.costs |= other.costs
        self.slow |= other.slow
        for file, lines in other.lines.items():
            for line, tests in lines.items():
                self.lines.setdefault(file, {}).setdefault(line, set()).update(tests)

    def save(self, path: Path) -> None:
        """Writes it to a file."""
        lines = {
            file: {line: sorted(t) for line, t in lines.items()} for file, lines in self.lines.items()
        }
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps([lines, self.costs, sorted(self.slow)]))

    @classmethod
    def load(cls, path: Path) -> "Trace":
        """Reads one that was saved."""
        files, costs, slow = json.loads(path.read_text())
        lines = {file: {int(n): set(t) for n, t in lines.items()} for file, lines in files.items()}
        return cls(lines, costs, set(slow))


class Failed(Exception):
    """The first test of a mutant that failed."""


class Session:
    """The plugin: `serve` is called once everything is collected.

    Args:
        serve: Gets this session.
    """

    def __init__(self, serve: Callable[["Session"], None]) -> None:
        self._serve = serve
        self._cover: coverage.Coverage | None = None
        self._failed: set[str] = set()
        self._watch: Callable[[str], None] = self._failed.add
        self._fixture_costs: dict[str, float] = {}
        self._contexts: list[str] = []
        self._error: Exception | None = None
        self.items: dict[str, pytest.Item] = {}
        self.is_whole = True  # whether everything could be collected

    def run(self, arguments: list[str]) -> int:
        """Collects tests and serves.

        Raises:
            RuntimeError: Serving failed.
        """
        code = int(pytest.main([*OPTIONS, *arguments], plugins=[self]))
        if self._error is not None:
            raise RuntimeError("the session failed") from self._error
        return code

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection(self) -> None:
        """Property tests always try the same examples, and do not look for the smallest that fails."""
        hypothesis = importlib.import_module("hypothesis")
        phases = [hypothesis.Phase.explicit, hypothesis.Phase.generate]
        hypothesis.settings.register_profile(
            "mutants", hypothesis.settings(), database=None, derandomize=True, phases=phases
        )
        hypothesis.settings.load_profile("mutants")

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Serves instead of running everything."""
        gc.unfreeze()  # what a conftest.py has frozen is not among gc.get_objects()
        self.items = {item.nodeid: item for item in session.items}
        try:
            self._serve(self)
        except Exception as error:  # noqa: BLE001 - pytest would only print it
            self._error = error
        return True

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Notes a file that cannot be imported, whose tests are not among the items then."""
        self.is_whole = self.is_whole and not report.failed

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Notes a failure, of set-up and tear-down too."""
        if report.failed:
            self._watch(report.nodeid)

    def first_failure(self, tests: list[tuple[str, float]]) -> str:
        """The first of the tests that fails, or nothing; to be called in a fork.

        Args:
            tests: Names, and the seconds that each should take at most.
        """

        def stop(test: str) -> None:
            raise Failed(test)

        self._watch = stop
        items = [self.items[test] for test, _ in tests]
        try:
            for (_, seconds), item, next_item in zip(tests, items, [*items, None][1:], strict=True):
                signal.setitimer(signal.ITIMER_PROF, seconds)  # ends the process
                signal.setitimer(signal.ITIMER_REAL, 20 * seconds)
                item.config.hook.pytest_runtest_protocol(item=item, nextitem=next_item)
        except Failed as failed:
            return str(failed)
        except (KeyboardInterrupt, pytest.exit.Exception):
            return DIED
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
            signal.setitimer(signal.ITIMER_REAL, 0)
        return ""

    def trace(self, tests: list[str], include: list[str]) -> Trace:
        """Runs tests, to be called in a fork.

        Args:
            tests: Names.
            include: Patterns of the files whose lines are looked at.
        """
        memoised = [one for one in gc.get_objects() if type(one) is _MEMOISED]
        cover = self._cover = coverage.Coverage(data_file=None, include=include, config_file=False)
        cover.set_option("run:disable_warnings", ["no-data-collected"])
        cover.start()
        found, items = Trace(), [self.items[test] for test in tests]
        users: dict[str, set[str]] = {}
        for item, next_item in zip(items, [*items, None][1:], strict=True):
            for function in memoised:
                function.cache_clear()
            self._contexts = []
            self._switch(item.nodeid)
            began = _seconds()
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=next_item)
            found.costs[item.nodeid] = _seconds() - began
            for context in _fixtures(item):
                users.setdefault(context, set()).add(item.nodeid)
                found.costs[item.nodeid] += self._fixture_costs.get(context, 0.0)
            if ALONE in getattr(item, "fixturenames", ()):
                found.slow.add(item.nodeid)
        cover.stop()
        found.costs = {test: cost for test, cost in found.costs.items() if test not in self._failed}
        data = cover.get_data()
        for file in data.measured_files():
            lines = found.lines[file] = {}
            for line, contexts in data.contexts_by_lineno(file).items():
                tests_of = (users.get(context, {context}) for context in contexts)
                lines[line] = {test for some in tests_of for test in some if test in found.costs}
        return found

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Iterator[None]:
        """What a shared fixture executes is covered by all that use it, not by the first of them."""
        if self._cover is None or fixturedef.scope == "function":
            return (yield)
        self._switch(_context(fixturedef))
        began = _seconds()
        try:
            return (yield)
        finally:
            self._fixture_costs[self._contexts.pop()] = _seconds() - began
            self._cover.switch_context(self._contexts[-1])

    def _switch(self, context: str) -> None:
        assert self._cover is not None  # noqa: S101 - for the type checker
        self._contexts.append(context)
        self._cover.switch_context(context)


def _context(fixture: object) -> str:
    return f"fixture {id(fixture)}"


def _fixtures(item: pytest.Item) -> set[str]:
    """Contexts of all fixtures that a test may use."""
    info: Any = getattr(item, "_fixtureinfo", None)
    definitions = info.name2fixturedefs.values() if info else ()
    return {_context(fixture) for some in definitions for fixture in some}


def _seconds() -> float:
    """Processor time so far, of ended children too; waiting, maybe for others, counts for little."""
    times = os.times()
    return sum(times[:4]) + times.elapsed / 10
