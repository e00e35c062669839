"""benchmarks/README.md: the text here, the figures from the tables of one run."""

import os
import platform
import re
from collections.abc import Mapping
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from benchmarks.measuring import Table
from benchmarks.registry import BENCHMARKS
from harness.base.version import __version__

README = Path(__file__).with_name("README.md")
PACKAGES = ("mujoco", "numpy", "numba", "ros-rclpy", "pybullet")

RESULTS, SOAK = "## Results", "## The soak"
SECTION = re.compile(r"<!-- (\w+) -->")  # before each benchmark's table
TEMPLATE = """\
# Benchmarks

```sh
make bench                           # all but memory, a few minutes
python -m benchmarks lidar runs      # some of them; --list names them
python -m benchmarks --hour          # with memory over a simulated hour
python -m benchmarks --quick         # does everything still work? The figures mean nothing
python -m benchmarks runs --write    # its table into this file; without names all of them
make soak                            # hours of broken sensors; its table at the end of this file
```

Written by `python -m benchmarks --write` and `make soak`: change benchmarks/readme.py, not this file.

## How to read it

- What counts are the **ratios**. The contestants take turns in every round, so what else the machine
  does hits all of them, and each figure is the median over the rounds. Absolute times hold for this
  machine only. A run through ROS 2 uses two cores where physics alone uses one: where the load average
  below is not near 0, its ratios are too low.
- *Scan*: `mj_multiRay` tests every triangle in a ray's bounding box, up to the far end of the map, as
  long as the ray stays within the heightfield's range of z: its cost grows with the square of map size
  over cell size. Here the hills are higher than the lidar, so most rays stay within. Over a nearly
  flat map they leave that range at once and `mj_multiRay` is cheap: the nearly flat scene
  shows the small ratio that is left. Ours walks the cells of the ray and costs much the same everywhere.
- PyBullet sees the terrain without the obstacles, and so do we in its rows. Its differences are its
  single precision, grazing beams included; its terrain is mirrored, because it splits cells along the
  other diagonal.
- *The same drive*: "physics alone" is nothing but `mj_step` under the recorded wheel commands, so its
  contacts and its path are those of the episode. The run through ROS 2 publishes the default topics
  over DDS to the real MetricsNode.
- *lost* counts every published message that a callback did not handle, best-effort topics included. It
  must be 0.
- *Learning environments*: "physics alone" is `mj_step` under the wheel commands of the same actions; the
  environments of a vector all stand in the same world and do the same, so that their physics costs what
  that of one does. A step is 50 ms with 640 beams, IMU and odometry. Times are the processor's, for
  others may share the machine; what uses two cores is timed by the clock on the wall, beside two that do
  nothing but steps of MuJoCo. Ant-v5 is Gymnasium's own (`pip install 'gymnasium[mujoco]'`).
- A figure that is *short* of its target says so; each title says the load average at its start.
- *Optional sensors*: a ray's cost is time of its core, that of the whole reading over its rays;
  `mj_multiRay` is asked for 200 of them. "As far as the busier core goes" is simulated time over the
  time on a core of the busier of the run's two processes: what a run does where each has a core.
- The targets are those of this project's design, for 2 cores.
- *Scenarios*: a run counts from the making of its world to its verdict. One whose expectations are of
  the truth alone takes no log, and no scans but the driver's. Processes start within their own row.
- *The soak* passes or fails; its speeds are a by-product. A lost message is one that the callbacks of
  some metrics node did not handle. "Bytes as without ROS": the log of each node against the one that
  `--direct` writes for the same drive with the same faults, on an undisturbed machine.
- PyBullet is the optional extra `[bench]`. Where it or ROS 2 is missing, the table says so.
"""


def write_readme(conditions: str, tables: Mapping[str, Table]) -> None:
    """Writes tables into the README; those of other benchmarks and the soak's stay.

    Args:
        conditions: Under which they were measured.
        tables: By the name of their benchmark.
    """
    text, soak, rest = README.read_text().partition(SOAK)
    words = SECTION.split(text.partition(RESULTS)[2])
    sections = dict(zip(words[1::2], words[2::2], strict=True))
    sections |= {name: f"\n{markdown(table)}\n{conditions}\n\n" for name, table in tables.items()}
    told = [f"<!-- {name} -->{sections[name]}" for name in BENCHMARKS if name in sections]
    README.write_text(f"{TEMPLATE}\n{RESULTS}\n\n{''.join(told)}{soak}{rest}")


def write_soak(conditions: str, table: Table) -> None:
    """Writes the soak's table into the README; everything else stays."""
    text = README.read_text().partition(SOAK)[0].rstrip()
    README.write_text(f"{text}\n\n{SOAK}\n\n{conditions}\n\n{markdown(table)}")


def conditions() -> str:
    """Machine, its load before the first round, date and versions."""
    versions = ", ".join(f"{name} {found}" for name in PACKAGES if (found := _version(name)))
    return (
        f"{os.cpu_count()} cores, {cpu_model()}, load average {os.getloadavg()[0]:.1f} at the start; "
        f"{date.today():%Y-%m-%d}. rover-harness {__version__}, Python {platform.python_version()}, "
        f"{versions}."
    )


def cpu_model() -> str:
    """The processor as the system names it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def markdown(table: Table) -> str:
    """The table as Markdown under its title."""
    rule = ("---", *("---:" for _ in table.columns[1:]))
    lines = (f"| {' | '.join(cells)} |" for cells in (table.columns, rule, *table.rows))
    return f"### {table.title}\n\n" + "\n".join(lines) + "\n"


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
