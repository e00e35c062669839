"""Makes docs/performance.png: where the time of a tick goes, measured now.

python -m benchmarks.ticks_picture docs/performance.png
"""

import sys
from pathlib import Path

from matplotlib import pyplot as plt

from benchmarks.ticks import PARTS, ROBOTS, spent
from harness.spec.run import Run

SECONDS = 20.0  # simulated
COLORS = ("#1f3b57", "#3c6e91", "#7fa8c4", "#b5651d", "#d18f4e", "#e3b98a", "#8a8f3c", "#c3c68b")


def main(picture: Path) -> None:
    """Drives each robot and draws a bar of it."""
    figure, axes = plt.subplots(figsize=(9.0, 2.9), layout="constrained")
    for place, robot in enumerate(ROBOTS):
        begin, parts = 0.0, spent(Run.of(robot=robot, duration=SECONDS))
        for part, color in zip(PARTS, COLORS, strict=True):
            width = 1e6 * parts[part]
            axes.barh(place, width, left=begin, color=color, label="" if place else part)
            axes.text(begin + width / 2, place, f"{width:.0f}", ha="center", va="center", color="white")
            begin += width
    axes.set_yticks(range(len(ROBOTS)), ROBOTS)
    axes.invert_yaxis()
    axes.set_xlabel("processor time of a tick of 10 ms [us]")
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside upper center", ncols=4, frameon=False, fontsize=8)
    figure.savefig(picture, dpi=120)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
