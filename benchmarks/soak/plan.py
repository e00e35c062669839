"""How long each scenario of the soak lasts, and which sensors break when."""

from dataclasses import dataclass

DISTURBANCES = (  # one after the other, again and again
    "imu:nan@{}+5",
    "scan:dropout@{}+10",
    "pose:freeze@{}+10",
    "odometry:huge=0.2@{}+10",
    "scan:empty@{}+2",
    "imu:duplicate=3@{}+5",
    "scan:latency=0.2@{}+20",
    "pose:empty@{}+2",
    "scan:beams=3@{}+2",
    "imu:stamp-shift=-1@{}+3",
    "scan:stuck=0.1@{}+2",
    "pose:nan@{}+2",
    "scan:spike@{}+10",
)


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Simulated seconds of each scenario, and how its world is disturbed.

    Attributes:
        long: Of the runs whose memory is watched.
        stopped: Of the run whose node is stopped and continued.
        many: Of the run with many nodes.
        starved: Of the runs with and without competing load.
        nodes: How many are many.
        fault_every: Simulated seconds from the beginning of one fault to that of the next.
        world: What harness.run is told of where and how it drives.
    """

    long: int
    stopped: int
    many: int
    starved: int
    nodes: int
    fault_every: int
    world: tuple[str, ...] = ("--terrain", "gravel", "--timestep", "0.005")  # no tipping over

    @property
    def longest(self) -> int:
        """The longest scenario [simulated s]."""
        return max(self.long, self.stopped, self.many, self.starved)

    def words(self, seconds: int) -> list[str]:
        """What harness.run is told for a scenario; all faults that begin by its end."""
        words = [*self.world, "--duration", str(seconds)]
        for index, start in enumerate(range(1, seconds + 1, self.fault_every)):
            words += ["--fault", DISTURBANCES[index % len(DISTURBANCES)].format(start)]
        return words


FULL = Plan(long=7200, stopped=300, many=60, starved=300, nodes=10, fault_every=30)
QUICK = Plan(long=120, stopped=20, many=5, starved=20, nodes=2, fault_every=2)
