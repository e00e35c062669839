"""A user's CSV files or bag -> one recording that can be fitted to, or what it lacks in a line."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.ndimage import median_filter

from harness.base.delimited import read_csv
from harness.base.errors import UsageError
from harness.fit.likely import likely
from harness.robots import RoverSpec
from harness.validate.recordings.bags import recording_of_bag
from harness.validate.recordings.recording import APART, Recording, in_order, lag, moved
from harness.validate.recordings.tables import recording_of

NEEDED = "commands", "wheels"
LONG, MOST_LOST = 1.0, 0.2  # [s] without a sample is a gap; share of the time that gaps may take
SHORTEST = 10.0  # [s] that the series have in common
FEWEST = 50  # samples of the wheels
STANDS = 0.02  # [m/s]: wheels that stand are slower,
SLOWED = 0.2  # and slower than this share of the speed that the last command brought
PERIOD = 0.05  # [s] for which a command counts at least
SINCE = 0.3  # [s] before the next command for which wheels stand, where a rover stops without commands
TIMEOUT = 0.5  # [s] until a rover stops without commands, where its folder names no time
COLUMNS = "a CSV file says it by columns t, cmd_v, cmd_w, left_speed, right_speed (docs/real_rovers.md)"
MOST_NAMED = 8  # columns
TABLES = {".csv", ".tsv", ".txt", ".dat"}
FASTEST = 50.0  # [m/s] of wheels that are in the units that they are said to be


def read(paths: Sequence[Path], rover: RoverSpec, topics: Mapping[str, str]) -> Recording:
    """Returns a recording on one clock that begins at 0 with the first command.

    Single wrong samples (spikes, jumps of scan matching) are taken out by medians of three.

    Args:
        paths: Of CSV files that tell of the same drive, or of one bag.
        rover: That drove.
        topics: Of a bag, by the names of their series, where others would be taken.

    Raises:
        UsageError: It cannot be read, or lacks what a fit needs; the message says what.
    """
    for path in paths:
        if not path.exists():
            raise UsageError(f"{path} does not exist; give CSV files or a bag")
    name = paths[0].name
    if all(path.is_file() and TABLES & {*path.suffixes} for path in paths):
        if topics:
            raise UsageError("--topic is for bags; a CSV file's columns go by their names")
        recording = recording_of(paths, name.split(".csv")[0], rover.controller_radius)
        if not recording.series:
            names = ", ".join(read_csv(paths[0]).columns[:MOST_NAMED])
            raise UsageError(
                f"{name} has no commands and no wheels; no series is made of its columns {names}; "
                f"{COLUMNS}"
            )
    elif len(paths) > 1:
        raise UsageError("several recordings must be CSV files of one drive; give one bag")
    else:
        recording = recording_of_bag(paths[0], rover, topics)
    _check(recording, rover)
    recording = _stopped(_aligned(recording, rover), rover)
    return _begun(likely(recording, rover))


def _check(recording: Recording, rover: RoverSpec) -> None:
    """Checks that what is needed is there, moves, overlaps and is whole."""
    there, name = recording.series, recording.name
    if missing := [one for one in NEEDED if one not in there]:
        present = ", ".join(there) or "nothing that a rover's model is fitted to"
        joints = f"; wheels are a JointState with {', '.join(rover.wheel_joints)}, or an Odometry"
        if not recording.sources:
            hint = f"; {COLUMNS}, a bag by its types"
        else:
            hint = joints if "wheels" in missing else ""
        raise UsageError(f"{name} has no {' and no '.join(missing)}; it has {present}{hint}")
    spans = {one: (float(v[0, 0]), float(v[-1, 0])) for one, v in there.items()}
    begin, end = max(b for b, _ in spans.values()), min(e for _, e in spans.values())
    there_are = ", ".join(f"{one} {b:.1f} to {e:.1f} s" for one, (b, e) in spans.items())
    if end < begin:
        raise UsageError(f"{name}: clocks are apart, series do not overlap: {there_are}")
    if end - begin < SHORTEST:
        short = f"{end - begin:.1f} s are too short, give {SHORTEST:g} s"
        raise UsageError(f"{name}: {short}; it has {there_are}")
    wheels = recording.wheels
    if len(wheels) < FEWEST:
        raise UsageError(f"{name}: {len(wheels)} samples of the wheels are too few; give {FEWEST}")
    for one in set(there) - {"commands"}:
        pauses = np.diff(there[one][:, 0])
        lost = float(pauses[pauses > LONG].sum())
        if lost > MOST_LOST * (end - begin):
            mend = "cut out the part that is whole"
            raise UsageError(f"{name}: gaps of {lost:.0f} s in the {one}; {mend}")
    speed = float(np.median(np.abs(wheels[:, 1:]).max(axis=1)))
    if speed > FASTEST or not recording.commands[:, 1:].any():
        reason = f"wheels turn at {speed:.0f} m/s" if speed > FASTEST else "commands are all 0"
        raise UsageError(f"{name}: {reason}; give units in the columns' names, as left_wheel [rad/s]")


def _aligned(recording: Recording, rover: RoverSpec) -> Recording:
    """The recording with its IMU on the clock of the wheels, without single wrong samples."""
    smooth = {
        name: np.column_stack([v[:, 0], median_filter(v[:, 1:], size=(3, 1), mode="nearest")])
        for name, v in recording.series.items()
        if name != "commands"
    }
    recording = replace(recording, **smooth)  # type: ignore[arg-type]  # of series alone
    shift = (lag(recording, rover.track) if "imu" in smooth else None) or 0.0
    if abs(shift) > APART:
        late = f"the IMU turns {shift:+.2f} s after the wheels"
        raise UsageError(f"{recording.name}: clocks are apart, {late}")
    return replace(recording, imu=moved(recording.imu, -shift))


def _stopped(recording: Recording, rover: RoverSpec) -> Recording:
    """The recording with a command to stop where none came and the rover stood, as after a joystick.

    When its driver gave up waiting is not known: without what the wheels did until they stood.
    """
    commands, wheels = recording.commands, recording.wheels
    timeout = (rover.actuators and rover.actuators.command_timeout) or TIMEOUT
    times, speeds = wheels[:, 0], np.abs(wheels[:, 1:]).max(axis=1)
    wanted = np.abs(commands[:, 1:]) @ [1.0, rover.controller_separation / 2]
    whole, stops = np.full(len(wheels), True), list[float]()
    ends = np.append(commands[1:, 0], times[-1])
    rows = np.column_stack([commands[:, 0], ends, wanted])
    for last, end, most in rows[ends - commands[:, 0] > LONG]:
        after = (times > last) & (times <= end)
        before = after & (times > end - SINCE)
        brought = min(most, speeds[after].max(initial=0.0))
        stands = speeds < min(STANDS, SLOWED * brought)
        if before.any() and stands[before].all():
            stops.append(last + min(timeout, LONG))
            whole &= ~(~stands & (times > last + PERIOD) & (times < end))
    added = np.column_stack([stops, np.zeros((len(stops), 2))])
    commands = in_order(np.concatenate([commands, added]))
    return replace(recording, commands=commands, wheels=wheels[whole])


def _begun(recording: Recording) -> Recording:
    begin = float(recording.commands[0, 0])
    series = {name: moved(values, -begin) for name, values in recording.series.items()}
    return replace(recording, **series, steps=recording.steps - begin)  # type: ignore[arg-type]  # as above
