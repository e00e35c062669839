"""Where an IMU is on a rover and how it is turned: by gravity at rest, by forces of turns and starts."""

import numpy as np
from scipy.spatial.transform import Rotation

from harness.fit.estimate import CERTAIN, Estimate, minimise
from harness.robots import RoverSpec
from harness.robots.model import compiled_alone
from harness.validate.recordings.recording import Recording, Series, at

STILL = 0.02, 0.05  # [m/s] of both sides, [rad/s]
FEWEST = 20  # samples at rest
STRIDE = 0.4  # [s] over which forces are means
TOLERANCE = 0.1  # [m/s^2]
LEAST = 0.15  # least rms of the change of speed [m/s^2], and of w^2 [rad^2/s^2], for an estimate
AXES = "roll", "pitch", "yaw"
FAR = 2.0  # [m] from the rover's middle at most


def mount(rover: RoverSpec, recording: Recording) -> list[Estimate]:
    """Returns roll, pitch and yaw [rad], x and y [m] of an IMU in the rover's root body.

    At rest it reads R^T (0, 0, g), R = Rz(yaw) Ry(pitch) Rx(roll), if the ground is level and its
    accelerometers have no bias, which shows in neither. Driving at v and w it reads besides, at
    (x, y) from the middle about which the rover turns, (v' - w^2 x - w' y, v w + w' x - w^2 y).
    """
    (x, y, _), turned = placed(rover)
    keys = ("imu.roll", "imu.pitch", "imu.yaw", "imu.x", "imu.y")
    units, now = ("rad",) * 3 + ("m",) * 2, (*turned, x, y)
    blank = [
        Estimate(f"IMU {key[4:]}", unit, key, value, scale=0.05)
        for key, unit, value in zip(keys, units, now, strict=True)
    ]
    imu = recording.imu
    if len(imu) < 2 or np.isnan(imu).any():
        return [one.unknown("an IMU with six axes is missing") for one in blank]
    stands = np.abs(at(recording.wheels, imu[:, 0])) < STILL[0]
    calm = np.abs(imu[:, 1:4] - np.median(imu[:, 1:4], axis=0)) < STILL[1]
    still = stands.all(axis=1) & calm.all(axis=1)
    if still.sum() < FEWEST:
        return [one.unknown("standing still is missing") for one in blank]
    rest = imu[still]
    ax, ay, az = np.median(rest[:, 4:], axis=0).tolist()
    roll, pitch = float(np.arctan2(ay, az)), float(np.arctan2(-ax, np.hypot(ay, az)))
    spread, gravity = float(rest[:, 4:].std(axis=0).max()), np.hypot(np.hypot(ax, ay), az)
    error = CERTAIN * spread / gravity / np.sqrt(len(rest))
    leaning = [one.judged(v, error, "") for one, v in zip(blank, (roll, pitch), strict=False)]
    level = Rotation.from_euler("xyz", (roll, pitch, 0.0))
    rates, forces = level.apply(imu[:, 1:4] - np.median(rest[:, 1:4], axis=0)), level.apply(imu[:, 4:])
    return leaning + _aside(blank[2:], recording.wheels, imu[:, 0], rates[:, 2], forces[:, :2])


def _aside(
    blank: list[Estimate], wheels: Series, times: Series, w: Series, forces: Series
) -> list[Estimate]:
    """Yaw, x and y of an IMU that is level, from its yaw rate and its horizontal forces."""
    edges = np.arange(max(times[0], wheels[0, 0]), min(times[-1], wheels[-1, 0]), STRIDE)
    v = np.column_stack([wheels[:, 0], wheels[:, 1:].mean(axis=1)])
    part = np.digitize(times, edges)
    count = np.bincount(part, minlength=edges.size + 1)[1:-1]
    known = count > 1

    def means(values: Series) -> Series:
        sums = np.bincount(part, weights=values, minlength=edges.size + 1)[1:-1]
        return (sums / np.maximum(count, 1))[known]

    speed = np.interp(edges, *v.T)
    changing = (np.diff(speed) / STRIDE)[known]
    turning = (np.diff(np.interp(edges, times, w)) / STRIDE)[known]
    square, across = means(w**2), means(w * np.interp(times, *v.T))
    felt = np.column_stack([means(forces[:, 0]), means(forces[:, 1])])
    moves = (np.sqrt(np.mean(changing**2)) > LEAST) or (np.sqrt(np.mean(across**2)) > LEAST)
    spins = np.sqrt(np.mean(square**2)) > LEAST
    if not (moves and spins):
        lack = "turns" if moves else "changes of speed, or arcs,"
        return [one.unknown(f"{lack} are missing") for one in blank]

    def residuals(values: Series) -> Series:
        yaw, x, y, along, aside = values
        ahead = along * changing - square * x - turning * y
        left = aside * across + turning * x - square * y
        c, s = np.cos(yaw), np.sin(yaw)
        off = np.column_stack([c * ahead + s * left, c * left - s * ahead]) - felt
        return (off / TOLERANCE).ravel()

    start = np.array([0.0, 0.0, 0.0, 1.0, 1.0])
    reach = np.array([np.pi, FAR, FAR, 3.0, 3.0])
    begins = [start + yaw * np.eye(5)[0] for yaw in (0.0, np.pi / 2, -np.pi / 2, np.pi - 0.01)]
    fits = [minimise(residuals, one, (start - reach, start + reach), np.full(5, 1e-4)) for one in begins]
    values, halves, *_ = min(fits, key=lambda fit: fit.cost)
    return [
        one.judged(value, half, "faster turns and starts are missing")
        for one, value, half in zip(blank, values.tolist(), halves.tolist(), strict=False)
    ]


def placed(rover: RoverSpec) -> tuple[list[float], list[float]]:
    """Returns where a rover has its IMU in the root body: x, y, z [m]; roll, pitch, yaw [rad]."""
    _, data = compiled_alone(rover)
    site = data.site("imu")
    angles = Rotation.from_matrix(site.xmat.reshape(3, 3)).as_euler("xyz")
    return site.xpos.tolist(), angles.tolist()
