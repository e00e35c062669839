"""A receipt as a table."""

import math

from harness.course.receipt import Receipt
from harness.course.summary import Mean
from rover_metrics.sheet.sheet import NONE, Sheet, formatted


def sheet_of(receipt: Receipt) -> Sheet:
    """Returns a row a track: its score with its interval, and what stands beside it."""
    rows = (
        {
            "track": name,
            "score": f"{track.score.mean:.3f}",
            "95 %": interval(track.score),
            "success": f"{track.success.mean:.0%}",
            "SPL": f"{track.spl.mean:.3f}",
            "time": formatted(track.seconds, ".1f"),
            "risk": formatted(track.risk_s_per_goal, ".2f"),
            "tilt": f"{math.degrees(track.tilt_p95):.1f}",
            "runs": str(len(track.episodes)),
        }
        for name, track in receipt.tracks.items()
    )
    about = (
        "time: of successes [s]; risk: near hazards for each goal [s]; tilt: its 95th percentile [deg]"
    )
    return Sheet.of(rows, receipt.entry, caption=about)


def interval(value: Mean) -> str:
    """Returns the 95 % interval of a mean; a dash without one."""
    if value.low is None or value.high is None:
        return NONE
    return f"{value.low:.3f} to {value.high:.3f}"
