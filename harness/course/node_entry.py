"""An episode of an entry that speaks ROS: its program hears the topics, in lock-step, and commands.

It gets its goals on /goal_pose, the next one when the one before is reached.
"""

from pathlib import Path

from geometry_msgs.msg import PoseStamped

from harness.base.errors import RunFailed
from harness.course.attempt import EpisodeResult, result_of
from harness.course.entry import Entry
from harness.course.referee import Referee
from harness.course.task import Case, Point, Task
from harness.episode.assembly import world_of
from harness.episode.batch import Batch
from harness.testing.process import Programs
from harness.testing.trial import Trial, TrialListener

GOAL_TOPIC, FRAME = "goal_pose", "world"
OUTPUT = "output.txt"


class _Watch(TrialListener):
    """Starts the entry's program, and shows the referee every batch."""

    def __init__(self, entry: Entry, referee: Referee, folder: Path) -> None:
        self._entry, self._referee, self._folder = entry, referee, folder

    def begin_programs(self, programs: Programs) -> None:
        """Starts the entry's command in its folder."""
        assert self._entry.about is not None  # noqa: S101 - as the caller makes sure
        programs.begin(self._entry.about.launch, self._folder, self._folder / OUTPUT)

    def take(self, batch: Batch) -> None:
        """Shows a batch to the referee."""
        self._referee.take(batch)


def drive_node(case: Case, task: Task, entry: Entry, folder: Path) -> EpisodeResult:
    """Drives an episode with an entry's node and returns how it went.

    Args:
        case: The episode.
        task: What it asks.
        entry: Whose command starts the node.
        folder: Where its files are.

    Raises:
        UsageError: Its node does not turn up.
    """
    assert entry.about is not None  # noqa: S101 - as the caller makes sure
    node, referee, failure = entry.about.node, Referee(task, world_of(task.run)), ""
    trial = Trial(task.run, listener=_Watch(entry, referee, folder), cmd_vel="auto")
    with trial:
        goals = trial.bridge.create_publisher(PoseStamped, GOAL_TOPIC, 10)
        trial.nodes.wait_until(lambda: node in trial.nodes.names())
        trial.join(node)
        told: Point | None = None
        try:
            while not referee.ending:
                if referee.goal is not None and referee.goal != told:
                    told = referee.goal
                    goals.publish(_message(told, trial.clock_ns))
                if not trial.advance():
                    break
        except RunFailed as error:
            failure = " ".join(str(error).split())
        return result_of(case, task, referee.drive(failure), trial.episode)


def _message(goal: Point, stamp_ns: int) -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id = FRAME
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp_ns, 10**9)
    message.pose.position.x, message.pose.position.y = goal
    message.pose.orientation.w = 1.0
    return message
