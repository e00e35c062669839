"""An entry that is a ROS 2 program: driven in lock-step, judged as any other, the same again."""

import sys
from pathlib import Path

import pytest

from harness.course.__main__ import main
from harness.course.receipt import read_receipt

pytestmark = pytest.mark.usefixtures("ros_domain")
SHORT = ("--track", "barn", "--seeds", "1", "--jobs", "1")  # it ends where the rover touches something
WORDS = f"[{sys.executable}, node.py, --ros-args, -p, use_sim_time:=true]"
NODE = '''
import math
import rclpy
from geometry_msgs.msg import PoseArray, PoseStamped, Twist
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data

class Mine(Node):
    """Turns to its goal while it drives there."""

    def __init__(self):
        super().__init__("mine")
        self.goal = None
        self.commands = self.create_publisher(Twist, "cmd_vel", 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(PoseStamped, "goal_pose", self.head_for, latched)
        self.create_subscription(PoseArray, "rover/pose_array", self.drive, qos_profile_sensor_data)

    def head_for(self, message):
        self.goal = message.pose.position

    def drive(self, message):
        if self.goal is None:
            return
        pose, twist = message.poses[0], Twist()
        turned = pose.orientation
        yaw = 2 * math.atan2(turned.z, turned.w)
        bearing = math.atan2(self.goal.y - pose.position.y, self.goal.x - pose.position.x)
        error = math.remainder(bearing - yaw, math.tau)
        twist.linear.x, twist.angular.z = 1.0 * max(0.0, math.cos(error)), max(-1.0, min(1.0, 2 * error))
        self.commands.publish(twist)

rclpy.init()
rclpy.spin(Mine())
'''


def entry(folder: Path, said: str, program: str = NODE) -> str:
    folder.mkdir()
    (folder / "node.py").write_text(program)
    (folder / "requirements.txt").write_text("")
    (folder / "entry.yaml").write_text(f"{said}\nlock: requirements.txt\n")
    return str(folder)


def test_a_program_drives_and_its_receipt_is_verified(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    own = entry(tmp_path / "own", f"launch: {WORDS}\nnode: /mine")
    assert main(["run", own, *SHORT, "--out", str(tmp_path)]) == 0
    (episode,) = read_receipt(tmp_path / "own.json").tracks["barn"].episodes
    assert episode.ending == "contact"
    assert episode.path > 1.0
    again = ["verify", str(tmp_path / "own.json"), "--entry", own, "--jobs", "1", "--seed", "1"]
    assert main(again) == 0, capfd.readouterr().out


def test_a_program_that_ends_is_told_in_a_line_and_in_the_midst_of_a_drive_in_its_receipt(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    own = entry(tmp_path / "own", f"launch: [{sys.executable}, -c, 'exit(7)']\nnode: /mine")
    assert main(["run", own, *SHORT, "--out", str(tmp_path)]) != 0
    assert len(capfd.readouterr().err.splitlines()) == 1
    program = NODE.replace("self.commands.publish(twist)", "raise SystemExit")
    own = entry(tmp_path / "late", f"launch: {WORDS}\nnode: /mine", program)
    assert main(["run", own, *SHORT, "--out", str(tmp_path)]) == 1
    (episode,) = read_receipt(tmp_path / "late.json").tracks["barn"].episodes
    assert "ended" in episode.ending
