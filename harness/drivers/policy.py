"""The driver of a trained policy: a small network in a file of numpy arrays, no learning library.

The file (.npz) has `weights_0`, `bias_0`, `weights_1`, ... of its layers, shapes (in, out) and (out,),
and the name of the `activation` between them. It takes what RoverHarness/PointNav-v0 observes, array
after array in the order of their names, and gives that environment's action.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import ClassVar
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError, find_named
from harness.base.made_of_files import Files, made_of_files
from harness.drivers import point_nav
from harness.drivers.base import DriverContext, Observation
from harness.drivers.beeline import Beeline
from harness.robots import RoverSpec
from harness.samples import LIDAR_RANGE_MAX, Sample, Twist
from rover_metrics.errors import reason_of

LIMITS = point_nav.limits(LIDAR_RANGE_MAX)
MOST_BYTES = 2**26  # unpacked
SAFELY = 0.9  # of how near an area or a route wants it: where it stands it is near enough
BESIDE_LIDAR = sum(len(low) for name, (low, _) in LIMITS.items() if name != "lidar")

Floats = NDArray[np.float32]


ACTIVATIONS: dict[str, Callable[[Floats], Floats]] = {
    "tanh": np.tanh,
    "relu": lambda values: np.maximum(values, np.float32(0.0)),
}


@dataclass(frozen=True, eq=False)
class Policy:
    """A network of dense layers."""

    # weights, shape (in, out), and bias, shape (out,), of each
    layers: tuple[tuple[Floats, Floats], ...]
    activation: str = "tanh"  # between two layers; one of ACTIVATIONS

    @property
    def beams(self) -> int:
        """Beams of the lidar that it was made for."""
        return len(self.layers[0][0]) - BESIDE_LIDAR

    def act(self, observation: Mapping[str, Floats]) -> Floats:
        """Returns the action, (2,) of -1 to 1, for an observation of PointNav; UsageError for others."""
        values = np.concatenate([observation[name] for name in sorted(observation)])
        if len(values) != (inputs := len(self.layers[0][0])):
            raise UsageError(
                f"the policy was made for other spaces: it takes {inputs} numbers, not {len(values)}; "
                f"make PointNav with lidar_beams={self.beams} and without optional parts"
            )
        for index, (weights, bias) in enumerate(self.layers):
            if index:
                values = ACTIVATIONS[self.activation](values)
            # Summed input by input: the order in which BLAS sums differs between makes of processors.
            values = (values[:, None] * weights).sum(axis=0) + bias
        return point_nav.clipped(values, -1.0, 1.0)

    def command(
        self,
        readings: Mapping[type[Sample], Sample],
        goal: point_nav.Point,
        rover: RoverSpec,
        stands_within: float = point_nav.GOAL_RADIUS,
    ) -> Twist:
        """Returns the command for what was read: to stand at the goal.

        Args:
            readings: The last of each of point_nav.SENSED.
            goal: In the world [m].
            rover: Whose largest speeds an action is a share of.
            stands_within: How near to the goal [m]; PointNav ends where it does if left out.
        """
        values = point_nav.observed(readings, goal, LIDAR_RANGE_MAX)
        arrays = {name: point_nav.clipped(values[name], *ends) for name, ends in LIMITS.items()}
        if arrays["goal"][0] < stands_within:
            return Twist()
        return point_nav.commanded(self.act(arrays).tolist(), rover)


def write_policy(path: Path | str, policy: Policy) -> None:
    """Writes a policy as the driver reads it."""
    arrays: dict[str, NDArray[np.generic]] = {"activation": np.array(policy.activation)}
    for index, (weights, bias) in enumerate(policy.layers):
        arrays |= {f"weights_{index}": weights, f"bias_{index}": bias}
    np.savez_compressed(path, **arrays)  # type: ignore[arg-type]  # its own keyword is of another type


def read_policy(file: Path | str) -> Policy:
    """Returns the policy of a file; UsageError if it holds none for point navigation."""
    path = Path(file)
    if path.exists() and not path.is_file():
        raise UsageError(f"policy {path} is not a file; give an .npz file")
    try:
        return _read(path)
    except OSError as error:
        raise UsageError(
            f"policy {path} cannot be read: {reason_of(error)}; give an .npz file"
        ) from error


@made_of_files(4)
def _read(path: Path) -> tuple[Policy, Files]:
    try:
        with ZipFile(path) as packed:
            is_small = sum(member.file_size for member in packed.infolist()) <= MOST_BYTES
        with np.load(path, allow_pickle=False) as archive:
            arrays = dict(archive) if is_small else {}
    except OSError:
        raise
    except Exception as error:  # zip files and arrays raise anything at all over a damaged file
        raise UsageError(f"policy {path} is no .npz file of arrays; see docs/gym.md") from error
    if not is_small:
        raise UsageError(f"policy {path} holds more than {MOST_BYTES >> 20} MiB; give a smaller one")
    count = sum(name.startswith("weights_") for name in arrays)
    names = [f"{kind}_{index}" for index in range(max(count, 1)) for kind in ("weights", "bias")]
    missing = [name for name in ("activation", *names) if name not in arrays]
    if missing:
        raise UsageError(f"policy {path} lacks {', '.join(missing)}; see docs/gym.md")
    if wrong := [name for name in names if arrays[name].dtype.kind not in "fiu"]:
        raise UsageError(f"policy {path}: {', '.join(wrong)} are no numbers; see docs/gym.md")
    floats = [arrays[name].astype(np.float32) for name in names]
    layers = tuple(zip(floats[::2], floats[1::2], strict=True))
    activation = str(arrays["activation"])
    find_named(f"policy {path}: activation", activation, ACTIVATIONS)
    _check_shapes(path, layers)
    return Policy(layers, activation), [path]


def _check_shapes(path: Path, layers: tuple[tuple[Floats, Floats], ...]) -> None:
    size = layers[0][0].shape[0] if layers[0][0].ndim else 0
    for index, (weights, bias) in enumerate(layers):
        if weights.ndim != 2 or weights.shape != (size, bias.size) or bias.ndim != 1:
            shapes = f"{weights.shape} and {bias.shape}"
            raise UsageError(f"policy {path}: layer {index} of {shapes} does not take {size} numbers")
        size = bias.size
    finite = all(np.isfinite(array).all() for layer in layers for array in layer)
    if size != 2 or len(layers[0][0]) <= BESIDE_LIDAR or not finite:
        raise UsageError(
            f"policy {path} was made for other spaces, {len(layers[0][0])} inputs and {size} outputs; "
            f"give one with {BESIDE_LIDAR} inputs and one a beam, 2 outputs, and finite numbers"
        )


class PolicyDriver(Beeline):
    """Drives to each goal that it is given as its policy does; stands there, and before any."""

    summary: ClassVar[str] = "drives to each /goal_pose as a policy trained on PointNav does"
    senses: ClassVar[frozenset[type[Sample]]] = point_nav.SENSED
    file: ClassVar[Path]

    def __init__(self, context: DriverContext) -> None:
        super().__init__(context)
        self._policy = read_policy(self.file)
        self._stands_within = min(point_nav.GOAL_RADIUS, SAFELY * context.reach)
        beams = len(context.bearings)
        if beams != self._policy.beams:
            raise UsageError(
                f"policy {self.file} is for {self._policy.beams} beams, the lidar has {beams}; "
                f"give --lidar-beams {self._policy.beams}"
            )

    def command(self, observation: Observation) -> Twist:
        """Returns the policy's command."""
        if self._goal is None or not observation.readings.keys() >= point_nav.SENSED:
            return Twist()
        return self._policy.command(observation.readings, self._goal, self.rover, self._stands_within)


@lru_cache(maxsize=4)
def driver_of(file: Path) -> type[PolicyDriver]:
    """Returns the driver of the policy in a file."""
    return type(f"PolicyDriver[{file.name}]", (PolicyDriver,), {"file": file})
