"""An episode of an entry that speaks ROS: its program hears the topics, in lock-step, and commands.

It gets its goals on /goal_pose, the next one when the one before is reached.
"""

from pathlib import Path

from harness.base.errors import RunFailed
from harness.course.entry import EntryFile
from harness.course.referee import Referee
from harness.course.result import EpisodeResult, result_of
from harness.course.task import Case, Task
from harness.episode.assembly import world_of
from harness.episode.batch import Batch
from harness.testing.listener import TrialListener
from harness.testing.process import Programs
from harness.testing.trial import Trial

OUTPUT = "output.txt"


class _Watch(TrialListener):
    """Starts the entry's program, and shows the referee every batch."""

    def __init__(self, about: EntryFile, referee: Referee, folder: Path) -> None:
        self._about, self._referee, self._folder = about, referee, folder

    def begin_programs(self, programs: Programs) -> None:
        """Starts the entry's command in its folder."""
        programs.begin(self._about.launch, self._folder, self._folder / OUTPUT)

    def take(self, batch: Batch) -> None:
        """Shows a batch to the referee."""
        self._referee.take(batch)


def drive_node(case: Case, task: Task, about: EntryFile, folder: Path) -> EpisodeResult:
    """Drives an episode with an entry's node and returns how it went.

    Args:
        case: The episode.
        task: What it asks.
        about: The entry, whose command starts the node.
        folder: Where its files are.

    Raises:
        UsageError: Its node does not turn up.
    """
    referee, failure = Referee(task, world_of(task.run)), ""
    with Trial(task.run, listener=_Watch(about, referee, folder), cmd_vel="auto") as trial:
        commands = trial.bridge.commands

        def is_heard() -> bool:
            """Whether the node's commands are heard, of either type."""
            of_it = (own for own in trial.bridge.subscriptions if own.topic_name == commands.topic)
            return commands.look_around() and any(own.get_publisher_count() for own in of_it)

        trial.nodes.wait_until(lambda: about.node in trial.nodes.names() and is_heard())
        trial.join(about.node)
        try:
            while not referee.ending and trial.advance():
                pass
        except RunFailed as error:
            failure = " ".join(str(error).split())
        return result_of(case, task, referee.drive(failure), trial.episode)
