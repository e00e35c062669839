"""The simulator's side: worlds, rovers, sensors, episodes and their bridge to ROS 2.

What is named here is for use from elsewhere (docs/api.md), and is loaded when it is asked for.
"""

import importlib
from typing import TYPE_CHECKING

from harness.base.version import __version__ as __version__

if TYPE_CHECKING:
    from harness.base.errors import HarnessError as HarnessError
    from harness.base.errors import RunFailed as RunFailed
    from harness.base.errors import UsageError as UsageError
    from harness.episode.batch import Batch as Batch
    from harness.episode.episode import Episode as Episode
    from harness.episode.result import RunResult as RunResult
    from harness.episode.run import run_episode as run_episode
    from harness.spec.run import Run as Run

_PLACES = {
    "Batch": "harness.episode.batch",
    "Episode": "harness.episode.episode",
    "HarnessError": "harness.base.errors",
    "Run": "harness.spec.run",
    "RunFailed": "harness.base.errors",
    "RunResult": "harness.episode.result",
    "UsageError": "harness.base.errors",
    "run_episode": "harness.episode.run",
}
__all__ = list(_PLACES)


def __getattr__(name: str) -> object:
    if name == "EpisodeConfig":  # what scripts written for 0.1 call
        return __getattr__("Run").of  # type: ignore[attr-defined]  # the class Run
    if name not in _PLACES:
        raise AttributeError(f"module 'harness' has no attribute '{name}'; public: {', '.join(__all__)}")
    return getattr(importlib.import_module(_PLACES[name]), name)
