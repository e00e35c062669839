"""What rover_metrics.analyze does: reads logs, computes, writes and prints results."""

import argparse
import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from rover_metrics.analysis.logs.header import Skipped, UnreadableLog, read_header
from rover_metrics.analysis.logs.log import Log, TimeAxis
from rover_metrics.analysis.logs.reading import read_log
from rover_metrics.analysis.metric import ALL, METRICS, choose
from rover_metrics.analysis.options import parse
from rover_metrics.analysis.outcome import analyse
from rover_metrics.analysis.output import page_of, prepare_folder, save_all
from rover_metrics.analysis.pairing import Pairs, pair
from rover_metrics.analysis.program import different, hand_over, inside, read_each
from rover_metrics.analysis.study import Options, Study, labels
from rover_metrics.analysis.tables import sheets
from rover_metrics.errors import RoverMetricsError, counted
from rover_metrics.log.files import write_whole
from rover_metrics.sheet.sheet import Sheet

SOCIAL = "social_log"  # how the names of logs begin that `social` reads


def analyze(options: argparse.Namespace) -> int:
    """Does what the options ask for; returns 0 if every log was analysed, 1 if any was skipped."""
    study, skipped, code = _read(options)
    if not study.logs:
        return code
    if options.plots or options.save_outliers or options.csv or options.latex:
        prepare_folder(options.output)  # before the work, which may take a while
    result = replace(analyse(study), skipped=tuple(skipped))
    wanted = {"as_csv": options.csv, "as_latex": options.latex, "outliers": options.save_outliers}
    files = save_all(study, result, options.output, **wanted)
    written = [f"{counted(len(files), 'file')} in {options.output}"] if files else []
    if options.page is not None:
        write_whole(options.page, page_of(study, result))
        written.append(f"page: {options.page}")
    complete = replace(result, files=tuple(map(str, files)))
    hand_over(options.json, complete.to_json, sheets(result), "; ".join(written))
    return code


def page_of_log(path: Path, more: Sequence[Sheet]) -> str:
    """Returns the page of one log as `analyze LOG --page` writes it, and `more` tables."""
    study, _, _ = _read(parse([str(path)]))
    return page_of(study, analyse(study), more)  # of no rows: the other tables alone


def _read(options: argparse.Namespace) -> tuple[Study, list[Skipped], int]:
    """The study of every log that can be read, those that cannot, and the exit code."""
    groups = tuple(options.group_names) if options.versus else ("all logs",)
    both = (inside(named, "*.csv", without=SOCIAL) for named in (options.logs, options.versus))
    paths = [different("analyze", named) for named in both]
    metrics = choose(options.metrics, _headers([*paths[0], *paths[1]]))
    logs: list[Log] = []
    skipped: list[Skipped] = []
    code = 0
    for group, of_group in zip(groups, paths, strict=False):
        read = partial(read_log, metrics=metrics, gap=options.gap)
        readable, unreadable, worst = read_each("analyze", of_group, read)
        code = max(code, worst)
        logs += [replace(log, group=group) for log in readable]
        skipped += unreadable
    logs = [replace(log, label=name) for log, name in zip(logs, labels(logs), strict=True)]
    known = {
        column for log in logs for column, values in log.columns.items() if np.isfinite(values).any()
    }
    chosen = Options(
        metrics=tuple(each for each in metrics if each.code in METRICS or each.column in known),
        confidence=options.confidence_level,
        iqr_multiplier=options.iqr_multiplier,
        remove_outliers=options.remove_outliers,
        unit=options.unit,
        ranked=ALL in map(str.casefold, options.metrics),
        plots=tuple(options.plots),
        axis=TimeAxis(options.normalize, options.fixed_interval),
    )
    return Study(tuple(logs), groups, chosen, _pairs(options, logs, skipped)), skipped, code


def _headers(paths: Sequence[Path]) -> Iterator[list[str]]:
    """Yields the column names of the logs that have them; others are reported when they are read."""
    for path in paths:
        with contextlib.suppress(UnreadableLog):
            yield read_header(path)


def _pairs(options: argparse.Namespace, logs: Sequence[Log], skipped: Sequence[Skipped]) -> Pairs:
    if not options.versus or options.unit == "episode":
        return ()
    if skipped and options.pair_by == "order":
        skip = f"{skipped[0].path} was skipped; leave out its partner too"
        raise RoverMetricsError(f"--pair-by order: {skip}")
    first, second = ([log for log in logs if log.group == group] for group in options.group_names)
    return pair(first, second, options.pair_by)
