"""What is odd about a recording: samples that count all the same, units, lengths of other drives.

A node counts the former, too. A robot of somebody else may have the others, of which no sample is wrong
by itself.
"""

import math
from collections import Counter, defaultdict
from typing import Any

from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.extended.traffic_columns import IMU, ODOMETRY, POSE, SCAN
from rover_metrics.health.rejections import ZERO_OR_LESS
from rover_metrics.health.watches import StampWatch
from rover_metrics.session import Remark
from rover_metrics.timing import NANOSECONDS
from rover_metrics.topics import Source, stamp_ns, vector

BATTERY = "sensor_msgs/msg/BatteryState"
ABOUT = 0.1  # of 1 g
NO_GRAVITY = 0.5  # [m/s^2]: less than a third of the Moon's
MOST_ANGLES = 7.0  # [rad] of a scan, a little more than a turn
MOST_TURNING = 3.0  # [rad/s] on average, half a turn a second: no rover
LEAST_WAY, MOST_RATIO = 1.0, 3.0  # [m] of a drive of which two lengths are compared; of these
LONGEST_STEP = NANOSECONDS  # between two odometries; in longer ones nobody knows what happened


class Oddities:
    """Takes each message that was played; `notes` are a line each."""

    def __init__(self) -> None:
        self._counted = Counter[tuple[str, str]]()  # by topic and finding
        self._stamps = defaultdict[str, StampWatch](StampWatch)  # by topic
        self._imu, self._accelerations, self._rates, self._samples = "", 0.0, 0.0, 0
        self._odometry, self._way, self._latest, self._has_poses = "", 0.0, 0, False
        self._battery, self._powers, self._states = "", 0.0, 0

    def stamped(self, topic: str, stamp_ns: int) -> None:
        """Takes the stamp of a message [ns], once for each."""
        if (finding := self._stamps[topic].take(stamp_ns)) is not None:
            self._counted[topic, finding[0]] += 1

    def add(self, source: Source, topic: str, parsed: Any, remark: Remark | None) -> None:  # noqa: ANN401
        """Takes a message, and what the session said of it."""
        if remark is not None:
            if remark.left_out:
                return
            self._counted[topic, remark.finding] += 1
        if source.name == IMU:
            self._imu, self._samples = topic, self._samples + 1
            self._accelerations += math.hypot(*vector(parsed.linear_acceleration))
            self._rates += math.hypot(*vector(parsed.angular_velocity))
        elif source.name == ODOMETRY:
            stamp = stamp_ns(parsed)
            if 0 < stamp - self._latest <= LONGEST_STEP:
                speed = math.hypot(*vector(parsed.twist.twist.linear))
                self._odometry = topic
                self._way += speed * (stamp - self._latest) / NANOSECONDS
            self._latest = stamp
        elif source.name == POSE:
            self._has_poses = True
        elif source.message_type == BATTERY and math.isfinite(parsed.voltage * parsed.current):
            self._battery, self._states = topic, self._states + 1
            self._powers -= parsed.voltage * parsed.current
        elif source.name == SCAN and abs(parsed.angle_increment) * len(parsed.ranges) > MOST_ANGLES:
            self._counted[topic, "angles of more than a turn, as if in degrees"] += 1

    def notes(self, metrics: TraversalMetrics) -> list[str]:
        """Returns what is odd, beside what the metrics made of it."""
        notes = []
        for (topic, finding), count in sorted(self._counted.items()):
            mend = "; if 0 stands for no return, make it inf (REP-117)" * (finding == ZERO_OR_LESS)
            notes.append(f"{topic}: {count:,} messages: {finding}{mend}")
        if self._samples:
            notes += self._of_imu(self._accelerations / self._samples, self._rates / self._samples)
        if self._powers < 0.0:
            notes.append(
                f"{self._battery}: {self._powers / self._states:.1f} W on average, as of one that is "
                "charged; a current is negative while it discharges (sensor_msgs/BatteryState)"
            )
        shorter, longer = sorted((self._way, metrics.total_distance))
        if self._odometry and self._has_poses and longer > max(LEAST_WAY, MOST_RATIO * shorter):
            notes.append(
                f"poses go {metrics.total_distance:.2f} m, the speeds of {self._odometry} "
                f"{self._way:.2f} m: is one of them empty, or in other units?"
            )
        return notes

    def _of_imu(self, acceleration: float, rate: float) -> list[str]:
        notes = []
        if abs(acceleration - 1.0) < ABOUT:
            notes.append(f"{self._imu}: accelerations of {acceleration:.2f} on average look like g")
        elif acceleration < NO_GRAVITY:
            notes.append(f"{self._imu}: accelerations of {acceleration:.2f} on average lack gravity")
        if rate > MOST_TURNING:
            notes.append(f"{self._imu}: rates of {rate:.1f} on average look like deg/s")
        return [f"{note}; columns and thresholds are of m/s2 and rad/s" for note in notes]
