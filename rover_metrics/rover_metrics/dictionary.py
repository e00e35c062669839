"""Command: the data dictionary of the log, made from the code that writes it.

python -m rover_metrics.dictionary
"""

import sys
from collections.abc import Iterable, Sequence

from rover_metrics.core.columns import ROBOTERRAIN_COLUMNS, Column
from rover_metrics.core.thresholds import THRESHOLD_INFO
from rover_metrics.extended.metrics import ALL_COLUMNS
from rover_metrics.extended.settings import EXTENDED_INFO
from rover_metrics.parser import OneLineParser
from rover_metrics.sheet.render import markdown
from rover_metrics.sheet.sheet import Sheet

HEAD = """# What the columns of a metrics log mean

A log has one row per second of ROS time, numbers rounded to four decimals. The first twelve columns
are those of RoboTerrain, with its names, order and meaning. a is the specific force that an IMU
measures, gravity included, w the angular velocity; frames and units follow REP-103.

*Same at any rate* says whether a sensor that runs faster or slower gives the same value. What is not
finite or impossible counts in no column but *Rejected*.
"""

EXTENDED_HEAD = """With `extended_columns:=true` (`harness.run --extended`,
`rover_metrics.replay --extended`) these follow, with their units in their names. An empty cell means
that there was nothing to say: no such topic, no sample since the row before, no footprint. It never
stands for 0. *Since the row before* is one second, unless the clock jumped.
"""

THRESHOLDS_HEAD = """Parameters of `metrics_node`, which can be changed while it runs; the
`.json` beside a log keeps the values at its end.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    _parser().parse_args(arguments)
    print(dictionary(), end="")
    return 0


def _parser() -> OneLineParser:
    about = "Prints what the columns of a log and the thresholds mean, as Markdown."
    return OneLineParser(prog="python -m rover_metrics.dictionary", description=about)


def dictionary() -> str:
    """Returns the data dictionary as Markdown."""
    parts = (
        HEAD,
        "## The twelve\n",
        _columns((each.name, each) for each in ROBOTERRAIN_COLUMNS),
        "## Extended columns\n",
        EXTENDED_HEAD,
        _columns((each.header, each) for each in ALL_COLUMNS),
        "## Thresholds\n",
        THRESHOLDS_HEAD,
        _thresholds(),
    )
    return "\n".join(parts)


def _columns(columns: Iterable[tuple[str, Column]]) -> str:
    rows = (
        (f"`{header}`", each.unit, each.meaning, each.formula, each.source, each.rate_invariant)
        for header, each in columns
    )
    titles = ("column", "unit", "meaning", "formula", "source", "same at any rate")
    return markdown(Sheet(titles, tuple(rows)))


def _thresholds() -> str:
    extended = {name: EXTENDED_INFO[name] for name in ("footprint_threshold", "gravity")}
    rows = (
        (f"`{name}`", f"{p.default:g}", p.unit, f"{p.minimum:g} to {p.maximum:g}", p.description)
        for name, p in {**THRESHOLD_INFO, **extended}.items()
    )
    return markdown(Sheet(("parameter", "default", "unit", "valid", "meaning"), tuple(rows)))


if __name__ == "__main__":
    sys.exit(main())
