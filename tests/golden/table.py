"""The golden runs: the lines of runs.txt as what a user would write on a command line."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

from harness.drivers import DRIVERS
from harness.faults.kinds import OF_COMMANDS, OF_MOTORS, OF_SENSORS, OF_THE_CLOCK, OF_WHEELS
from harness.sensors.noise import PRESETS
from harness.sensors.table import OPTIONAL
from harness.world.terrains import TERRAINS

TABLE = Path(__file__).with_name("runs.txt")
NONE = "-"
# Others are folders, made for the tests.
OWN_ROBOTS = {"leo": "leo", "zero": "rover_zero4wd", "a200": "husky", "jackal": "jackal"}
STAGED = ("ram", "reverse_into", "graze", "swing", "pass_by")
AREA = ["--goal-area", "-3,3,-3,3"]
DRIVER = {
    "area": ["--driver", "goal", *AREA],
    "policy": ["--driver", "policy:{policy}", *AREA],
}
TERRAIN = {
    "dem": ["--terrain", "{dem}", "--terrain-size", "14", "12"],
    "sdf": ["--terrain", "{sdf}", "--rock", "plank*"],
    "rough": ["--terrain", "{dem}", "--terrain-size", "14", "12", "--terrain-roughness", "D"],
    "mesh": ["--terrain", "{mesh}", "--mesh-unit", "cm", "--terrain-cell", "0.2"],
}
PEOPLE = {
    "points": ["--actor", "a=3,0/3,3:push=1", "--actor", "b=random:within=4"],
    "push": ["--actor", "d=0,1.2/4,-1.2:push=1,speed=1.5", "--actor", "b=social:within=3,push=1"],
    "social": ["--actor", "c=social:within=3,speed=0.7"],
}
METRICS = {
    "extended": ["--extended"],
    "params": ["--params", "{params}"],
    "both": ["--extended", "--params", "{params}"],
    "of_one": ["--extended", "--params", "{of_one}"],  # of a fleet
}
TF = {
    "wheels": ["--odom-tf", "wheels"],
    "none": ["--odom-tf", "none"],
    "3d": ["--odom-tf-3d", "--map-tf"],
}
OTHER_NUMBERS = ["--imu-rate", "100", "--lidar-beams", "90", "--timestep", "0.005"]
OTHER_NUMBERS += ["--datum", "-33.9,18.4,40"]
MISSION = {
    "targets": [
        "--target",
        "aruco:x=3,y=0.3,height=0.5",
        "--target",
        "gate",
    ],
    "route": ["--target", "gate:x=1,y=0.2", "--route", "0.5,0/gate/-1,0:radius=0.3,within=2"],
    "meet": ["--target", "post:x=1.7,y=0.15", "--target", "mallet:x=0.5,y=0.1"],
    "done": [
        *("--target", "gate:x=1.2,y=0,width=1.6", "--target", "post:x=2.6,y=0.6"),
        *("--route", "0.4,0/gate/@38.4064,-110.79188:radius=0.3,stop=true"),
    ],
    "stop": ["--target", "gate:x=1,y=0.2", "--route", "1.8,0/gate:stop=true"],
}
PLAN: dict[str, dict[str, Any]] = {  # what no command line says
    "cmd_vel": {"commands": ((0.0, 0.4, 0.3), (1.0, -0.2, -0.5), (2.0, 0.5, 0.0))},
    "goal": {"goals": ((0.2, 2.0, 1.0, 0.0), (1.6, -1.0, 2.0, 1.5))},
}
PLAN |= dict.fromkeys(("beeline", "gap", "dwa", "mppi"), PLAN["goal"])


@dataclass(frozen=True)
class GoldenRun:
    """A line of the table.

    Attributes:
        values: Its words, by column.
    """

    values: dict[str, str]

    def __getattr__(self, column: str) -> str:
        try:
            return self.values[column]
        except KeyError:
            raise AttributeError(column) from None

    @property
    def name(self) -> str:
        """What the references know it by."""
        return "-".join(self.values[column] for column in ("no", "robot", "terrain", "driver"))

    @property
    def plan(self) -> dict[str, Any]:
        """What happens when, by the names of the fields of a plan."""
        is_led = self.mission in ("route", "stop", "done") and self.driver == "goal"
        plan = {} if is_led else dict(PLAN.get(self.driver, {}))
        plan |= {} if self.reset == NONE else {"resets": (float(self.reset),)}
        link: dict[str, Any] = {"link_losses": ((0.8, 1.0),), "aborts": (2.2,), "resumes": (2.6,)}
        steered: dict[str, Any] = {
            "drivers": ((0.6, "goal"), (1.6, "")),
            "goals": ((0.6, 2.0, 1.0, 0.0),),
        }
        return plan | {"link": link, "helm": steered}.get(self.mission, {})

    @property
    def is_fleet(self) -> bool:
        """Whether there are two rovers."""
        return self.fleet != NONE

    @property
    def is_thorough(self) -> bool:
        """Whether it is also driven with a sensor more, and as a fleet through ROS again."""
        return int(self.no) % 6 == 0

    @property
    def is_drawn(self) -> bool:
        """Whether its camera draws, which takes longer than all else; on soil each does."""
        return int(self.no) % 3 == 0

    @property
    def duration(self) -> float:
        """Simulated seconds: enough for an encounter, one after another, and what is due after two."""
        if self.mission in ("meet", "done") or self.driver in STAGED:
            return 5.0 if self.mission == NONE else 7.0
        return 2.4 if self.mission == NONE and "@2" not in self.fault and self.reset != "2.6" else 3.0

    @property
    def is_read(self) -> bool:
        """Whether its recording is played and read, too; these runs are neither thorough nor drawn."""
        return int(self.no) % 3 == 1

    def words(self, files: dict[str, Path]) -> list[str]:
        """Returns the arguments of harness.run, with these files for the names in braces."""
        robot = OWN_ROBOTS.get(self.robot, f"{{{self.robot}}}")
        words = ["--duration", str(self.duration), "--seed", str(int(self.no))]
        words += TERRAIN.get(self.terrain, ["--terrain", self.terrain])
        words += DRIVER.get(self.driver, ["--driver", self.driver])
        words += [] if self.sensors == NONE else ["--sensors", self.sensors.replace("+", ",")]
        words += [] if self.noise == NONE else ["--noise", self.noise]
        faults = [] if self.fault == NONE else self.fault.split(";")
        words += [word for fault in faults for word in ("--fault", fault)]
        words += ["--fault", "camera:rate=0.6"] if "camera" in self.sensors else []  # drawing is slow
        words += PEOPLE.get(self.people, []) + METRICS.get(self.metrics, []) + TF.get(self.tf, [])
        words += [] if self.numbers == NONE else OTHER_NUMBERS
        words += MISSION.get(self.mission, [])
        soil, _, keep = self.soil.partition(":")
        words += [] if self.soil == NONE else ["--soil", soil]
        words += ["--keep-ruts"] if keep else []
        actuators, _, surface = self.motors.partition(":")
        words += [] if self.motors == NONE else ["--actuators", actuators]
        words += ["--surface", surface] if surface else []
        words += ["--namespace", "below"] if self.ros == "namespace" else []
        words += self._fleet(robot) if self.is_fleet else ["--robot", robot]
        return [word.format(**files) for word in words]

    def _fleet(self, robot: str) -> list[str]:
        if self.fleet in ("twin", "close"):
            behind = ",x=-1.1,y=0" if self.fleet == "close" else ""  # to where the first one began
            return ["--rover", f"{robot}:a", "--rover", f"{robot}:b{behind}"]
        other = "rover_zero4wd" if self.robot == "leo" else "leo"
        sensors = "gnss" if self.sensors == NONE else self.sensors.replace("gnss+", "") + "+gnss"
        own = f"driver=straight,noise=white,sensors={sensors},fault=imu:nan=0.5"
        own += ",x=0.55,y=2.1" if self.fleet == "onto" else ""  # its left wheels go over a rock
        return ["--rover", f"{robot}:a", "--rover", f"{other}:b,{own}"]


def read_table() -> tuple[GoldenRun, ...]:
    """Returns the runs in their order."""
    lines = [line.split() for line in TABLE.read_text().splitlines() if not line.startswith("#")]
    rows = (line + [NONE] * (len(lines[0]) - len(line)) for line in lines[1:])
    return tuple(GoldenRun(dict(zip(lines[0], row, strict=True))) for row in rows)


RUNS = read_table()


def kind(column: str, value: str) -> str:
    """Returns what a value is a case of; pairs of these are covered."""
    sensor, _, name = value.partition(":")
    groups = {
        "terrain": {"posts": "hazards", "maze": "hazards", "rough": "dem"}
        | dict.fromkeys(("flat", "slope", "rolling", "gravel", "washboard", "dunes"), "open"),
        "robot": {"sojourner": "husky", "a200": "husky", "jackal": "husky", "rk4": "leo"},
        "metrics": {"of_one": "both"},
        "people": {"push": "social"},
        "fleet": {"close": "twin", "onto": "mixed"},
        "mission": dict.fromkeys((*MISSION, "link", "helm"), NONE),  # each in a run of its own
        "soil": dict.fromkeys(("dry_sand", "dry_sand:keep", "firm", "terrain", "{mixed}"), NONE),
        "sensors": {"battery": NONE, "lidar2d+camera+battery": "lidar2d+camera"},
        "motors": dict.fromkeys(("real", "real:sandy_loam", "real:snow"), NONE),
        "reset": {"2.6": "1.3", "1.35": "1.3"},
        "driver": dict.fromkeys(STAGED, "staged") | {"policy": "area"},
    }
    if column == "driver" and value not in ("area", "policy", "goal", "cmd_vel", *STAGED):
        return "own"
    if column != "fault" or value == NONE:
        return groups.get(column, {}).get(value, value)
    if sensor in ("cmd_vel", "motor.left", "motor.right", "wheel.front_left"):
        return "stream"
    if sensor == "clock" or sensor in OPTIONAL.shipped:
        return "clock" if sensor == "clock" else "optional"
    fault = next(kind for kind in OF_SENSORS if kind.name == name.partition("=")[0].partition("@")[0])
    return "values" if fault.of_values else "stream"


def is_possible(pair: Iterable[tuple[str, str]]) -> bool:
    """Returns whether two kinds of values can stand in one run."""
    given = dict(pair)
    if given.get("driver") == "staged" and given.get("terrain") not in (None, "rocky", "hazards", "sdf"):
        return False  # there is nothing to meet
    if given.get("fleet", NONE) != NONE and given.get("ros", NONE) != NONE:
        return False  # a fleet has its own namespaces
    return given != {"fault": "optional", "sensors": NONE}


def missing_pairs() -> list[tuple[tuple[str, str], ...]]:
    """Returns the pairs of kinds that no run has."""
    kinds_of = [[(c, kind(c, v)) for c, v in run.values.items() if c != "no"] for run in RUNS]
    there = {pair for values in kinds_of for pair in combinations(values, 2)}
    columns = [sorted({values[index] for values in kinds_of}) for index in range(len(kinds_of[0]))]
    possible = [
        (one, other)
        for first, second in combinations(columns, 2)
        for one in first
        for other in second
        if is_possible((one, other))
    ]
    return [pair for pair in possible if pair not in there]


def missing_values() -> set[str]:
    """Returns the registered terrains, drivers, sensors, presets and faults that no run has."""
    of = {column: {run.values[column] for run in RUNS} for column in RUNS[0].values}
    sensors = {name for value in of["sensors"] for name in value.split("+")}
    each = [fault for some in of["fault"] for fault in some.split(";")]
    faults = {fault.partition("@")[0].partition("=")[0] for fault in each}
    of_clock = {f"clock:{kind.name}" for kind in OF_THE_CLOCK}
    return {
        *(set(TERRAINS) - of["terrain"]),
        *(set(DRIVERS) - of["driver"] - {"policy"}),
        *(set(OPTIONAL.shipped) - sensors),
        *(set(PRESETS) - of["noise"]),
        *(
            {kind.name for kind in (*OF_SENSORS, *OF_COMMANDS, *OF_MOTORS, *OF_WHEELS)}
            - {name.partition(":")[2] for name in faults}
        ),
        *(of_clock - faults),
    }
