"""Loaded once by the fork server: what its children then need not load."""

import contextlib
import gc
from importlib import import_module

from harness.base.errors import UsageError

for _module in (
    "harness.episode.episode",
    "harness.episode.direct",
    "harness.run",
    "harness.cli.run_command",
):
    import_module(_module)
with contextlib.suppress(ImportError, UsageError):  # without the extra [gym]
    import_module("harness.gym.point_nav")
    import_module("harness.gym.many")
with contextlib.suppress(ImportError):  # without ROS there is less to load
    import_module("harness.ros.session")
    import_module("rover_metrics.metrics_node")

from harness.cli.options import parse_run

parse_run(["--direct"])  # makes pydantic's classes and the parser, and reads the rover

gc.freeze()  # else each child would copy the whole heap as it ends
