"""What holds for every golden run. Each invariant yields a line for each thing that is not so."""

import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from mcap.reader import make_reader

from harness.base.sim_time import period_ticks
from harness.episode.assembly import actor_names, sensor_rows
from harness.episode.result import RunResult
from harness.robots import find_rover
from harness.samples import ActorPoses, Imu, Transforms
from harness.sensors.table import ATTITUDE
from harness.spec.rover import CMD_VEL
from harness.spec.run import Run
from tests.golden.evidence import Evidence, Message

DUE = ("world", "outcome/status", "truth", "thresholds", "simulated_s", "wall_s", "lost", "rows", "log")
DUE_OF_METRICS = ("last_row", "first_row_s")  # where they are in the process of the run
VOLATILE = {
    *("command", "versions", "wall_s", "paused_s", "waited_s", "real_time_factor", "first_row_s", "log")
}
NOT_REACHED = ("/reached_s", "/stop_distance")  # of what a mission did not come to
OF_SENSORS = {"arguments", "topics", "recording"}
OF_DRIVE = ("arguments", "world", "truth", "simulated_s", "outcome")
PLACED = ("LaserScan", "PointCloud2", "Imu", "NavSatFix", "MagneticField", "FluidPressure", "GridMap")
TICKS_PER_SECOND = 100
NO_VALUE = re.compile(r"(?<!:)\b(nan|NaN|None|null|undefined)\b")  # but for a fault, as in scan:nan


def ros_is_direct(evidence: Evidence) -> Iterator[str]:
    """Through ROS as without: log, social log, stream and truth."""
    for direct, ros in zip(evidence.direct, evidence.ros, strict=False):
        yield from _same(direct, ros, "through ROS")
        yield from _same_keys(direct.manifest, ros.manifest, OF_DRIVE, "through ROS")


def replay_is_the_log(evidence: Evidence) -> Iterator[str]:
    """A recording gives the log again."""
    for ros, replayed in zip(evidence.ros, evidence.replayed, strict=True):
        if ros.csv != replayed:
            yield f"{ros.name} replay: {first_difference(ros.csv, replayed)}"


def recording_without_ros_is_that_of_ros(evidence: Evidence) -> Iterator[str]:
    """Each topic but images has the same messages at the same times, with ROS or not."""
    # Of a node in another process nothing is recorded, and only ROS has names that diagnostics repeat.
    left_out = ("image_raw", *["rover/metrics"] * (evidence.run.ros in ("elsewhere", "namespace")))
    space = "/below" if evidence.run.ros == "namespace" else ""
    ros, direct = (by_topic(some) for some in (evidence.messages, evidence.recorded))
    direct = {name if name == "/clock" else space + name: some for name, some in direct.items()}
    for topic in sorted(ros.keys() | direct.keys()):
        one, other = ros.get(topic, []), direct.get(topic, [])
        if one != other and not topic.endswith(left_out):
            at = next((a for a, b in zip(one, other, strict=False) if a != b), (0, b""))
            yield f"{topic} without ROS: {len(one)} messages became {len(other)}, from {at[0]} ns on"


def by_topic(messages: Iterable[Message]) -> dict[str, list[tuple[int, bytes]]]:
    """Returns time [ns] and bytes of the messages of each topic."""
    found: dict[str, list[tuple[int, bytes]]] = {}
    for message in messages:
        found.setdefault(message.topic, []).append((message.time_ns, message.data))
    return found


def recording_is_indexed(evidence: Evidence) -> Iterator[str]:
    """The end of a recording tells how many messages there are, and has one definition of each type."""
    if evidence.recording is not None:
        with evidence.recording.open("rb") as file:
            index = make_reader(file).get_summary()
        assert index is not None
        assert index.statistics is not None
        types, count = [schema.name for schema in index.schemas.values()], index.statistics.message_count
        if count != len(evidence.recorded) or sorted(types) != sorted({*types}):
            yield f"a recording of {count} of {len(evidence.recorded)} messages has the types {types}"


def second_recording_is_the_same(evidence: Evidence) -> Iterator[str]:
    """What the nodes of several rovers publish stands in the same places of a recording."""
    if len(set(evidence.recordings)) > 1:
        yield f"two recordings differ: {', '.join(str(len(each)) for each in evidence.recordings)} bytes"


def second_run_is_the_same_but_for_its_sensor(evidence: Evidence) -> Iterator[str]:
    """The same arguments give the same bytes; what a sensor adds, or a recording, stands beside them."""
    for direct, more in zip(evidence.direct, evidence.with_extra, strict=bool(evidence.with_extra)):
        yield from _same(direct, more, f"with a {evidence.extra}")
        same = sorted(direct.manifest.keys() - OF_SENSORS)
        yield from _same_keys(direct.manifest, more.manifest, same, f"with a {evidence.extra}")


def nothing_is_missing(evidence: Evidence) -> Iterator[str]:
    """No null in a manifest and no NaN in a log where a value is due."""
    hosted = (*DUE, *DUE_OF_METRICS)
    for way, each, due in (
        ("direct", evidence.direct, hosted),
        (f"with a {evidence.extra}", evidence.with_extra, hosted),
        ("ROS", evidence.ros, hosted if evidence.run.ros != "elsewhere" else DUE),
    ):
        for driven in each:
            for place, value in flat(driven.manifest):
                endless = place.startswith("last_row/") and ",inf," in driven.csv  # null in JSON
                may_lack = endless or ("/mission/" in place and place.endswith(NOT_REACHED))
                if value is None and place.startswith(due) and not may_lack:
                    yield f"{driven.name} {way}: null in the manifest at {place}"
            logs = driven.csv + driven.social.replace("nan", "", 1)  # no speed before the second row
            for word in re.findall(r"\b(?i:nan|none|null)\b", logs):
                yield f"{driven.name} {way}: {word} in a log"
            rows = driven.csv.count("\n") - 1
            if rows < 1 or driven.manifest["rows"] not in (rows, 0 if way == "ROS" else rows):
                yield f"{driven.name} {way}: {rows} rows in the log"


def manifest_repeats_the_run(evidence: Evidence) -> Iterator[str]:
    """What a manifest says of its rover is the run, when it is read again."""
    run = evidence.options.run
    for way, some in (("direct", evidence.direct), ("ROS", evidence.ros)):
        for driven, rover in zip(some, run.rovers, strict=bool(some)):
            said = {**driven.manifest["arguments"]}
            place = said.pop("number"), said.pop("world_robot")
            if place != (run.rovers.index(rover), run.rover.robot if rover.name else ""):
                yield f"{driven.name} {way}: stands at {place}"
            if (again := Run.of(**said)) != run.but(rovers=(rover,)):
                both = (one.model_dump(mode="json") for one in (run.but(rovers=(rover,)), again))
                yield from (f"{driven.name} {way}: {line}" for line in differing(*both))


def page_is_whole(evidence: Evidence) -> Iterator[str]:
    """No null and no NaN on the page of a run, on which everything is drawn that is named."""
    for driven, page in zip(evidence.direct, evidence.pages, strict=True):
        (figures,) = re.findall(r'id="figures">(.*?)</script>', page, re.DOTALL)
        shown = re.sub(r"<(script|style).*?</\1>", "", page, flags=re.DOTALL)
        for line in filter(NO_VALUE.search, shown.split("\n")):
            yield f"{driven.name}: on the page stands {line.strip()}"
        for name, figure in json.loads(figures).items():
            if f'id="{name}"' not in shown:
                yield f"{driven.name}: the page has no place for {name}"
            for trace in figure["data"]:
                if all(y is None for y in trace["y"]):
                    yield f"{driven.name}: {name} has an empty {trace['name']}"


def nothing_is_lost(evidence: Evidence) -> Iterator[str]:
    """Every message has been handled by who listens, and nothing failed."""
    for driven in (*evidence.direct, *evidence.ros):
        if driven.result.failure or driven.manifest["outcome"]["status"] != "complete":
            yield f"{driven.name}: {driven.manifest['outcome']}"
        for topic, count in driven.manifest["topics"].items():
            if count["lost"] or count["received"] not in (None, count["published"]):
                yield f"{topic}: {count}"
    for driven, space in zip(evidence.ros, evidence.namespaces, strict=False):
        if driven.manifest["topics"][f"{space}/scan"]["received"] is None:
            yield f"{space}/scan: nobody listens"


def counts_are_rates_times_duration(evidence: Evidence) -> Iterator[str]:
    """Each topic has as many messages as its sensor's rate says; a fault of its own excuses it."""
    recorded = Counter(message.topic for message in evidence.messages)
    for driven, space in zip(evidence.ros, evidence.namespaces, strict=False):
        expected = expected_counts(evidence, driven.result, space)
        published = {t: c["published"] for t, c in driven.manifest["topics"].items()}
        for topic, count in expected.items():
            if count is not None and recorded[topic] != count:
                yield f"{topic}: {recorded[topic]} recorded, {count} expected"
        for topic, count in published.items():
            if recorded[topic] != count:
                yield f"{topic}: {recorded[topic]} recorded, {count} published"
        for topic in recorded.keys() - expected.keys():
            if topic.startswith(f"{space}/") and (space or not evidence.run.is_fleet):
                yield f"{topic} was not expected"


def expected_counts(evidence: Evidence, result: RunResult, space: str) -> dict[str, int | None]:
    """Returns how many messages each topic of a rover has; None for whatever a fault leaves of it."""
    faulty = {fault.sensor.removesuffix(ATTITUDE) for fault in result.rover.faults}
    rover, total, due = find_rover(result.rover.robot), result.run.total_ticks, set[int]()
    expected: dict[str, int | None] = {}
    for row in sensor_rows(result.rover):
        if row.sample in (Transforms, ActorPoses):
            continue
        period = period_ticks(result.rover.imu_rate if row.sample is Imu else row.rate_on(rover))
        due |= {tick for tick in range(1, total + 1) if tick % period == 0}
        for topic in row.topics:
            expected[f"{space}/{topic.name}"] = None if row.fault in faulty else total // period
    people = total * 30 // TICKS_PER_SECOND
    expected |= {f"{space}/{name}/pose": people for name in actor_names(result.run.world)}
    if result.run.plan.route is not None and result.rover.driver == CMD_VEL:
        expected[f"{space}/goal_pose"] = None  # as often as way points are reached or missed
    joints = {tick for tick in range(1, total + 1) if tick % 5 == 0}
    owns_odom = evidence.options.ros.frames.odom_tf != "none"
    told = (due if owns_odom else set()) | joints  # every rover's wheels are frames that move
    expected[f"{space}/tf"] = None if "tf" in faulty else len(told)
    silent = any((fault.sensor, fault.kind) == ("clock", "dropout") for fault in result.rover.faults)
    expected["/clock"] = None if silent else total
    once = ("tf_static", "robot_description", "map")
    expected |= {f"{space}/{name}": 1 for name in once}
    if evidence.run.ros != "elsewhere":
        expected[f"{space}/rover/metrics"] = None
    return expected


def every_scan_is_placeable(evidence: Evidence) -> Iterator[str]:
    """Frames lead from each reading to odom by transforms of its very stamp that came before it."""
    for space in evidence.namespaces if evidence.ros else ():
        yield from _unplaceable(evidence, space)


def _unplaceable(evidence: Evidence, space: str) -> Iterator[str]:
    parents: dict[str, str] = {}
    fixed, told = set[str](), dict[str, int]()
    owns_odom = evidence.options.ros.frames.odom_tf != "none"
    root = "odom" if owns_odom else None
    excused = {fault.sensor for rover in evidence.options.run.rovers for fault in rover.faults}
    for message in evidence.messages:
        if message.topic in (f"{space}/tf", f"{space}/tf_static"):
            for one in message.content.transforms:
                parents[one.child_frame_id] = one.header.frame_id
                told[one.child_frame_id] = stamp_of(one)
                if message.topic.endswith("static"):
                    fixed.add(one.child_frame_id)
        elif message.type_name.rpartition("/")[2] in PLACED and message.topic.startswith(f"{space}/"):
            name = message.topic.removeprefix(space).split("/")[1]
            if not excused & {name, "tf", "clock"}:
                yield from _path(message, parents, told, fixed, root)
    roots = {parent for parent in parents.values() if parent not in parents}
    if len(roots) != 1:
        yield f"{space}: the frames have the roots {sorted(roots)}"


def _path(
    message: Message, parents: dict[str, str], told: dict[str, int], fixed: set[str], root: str | None
) -> Iterator[str]:
    frame, stamp = message.content.header.frame_id, stamp_of(message.content)
    while frame in parents and frame != root:
        if frame not in fixed and parents[frame] == "odom" and told[frame] != stamp:
            yield f"{message.topic} at {stamp}: {frame} is known at {told[frame]}"
        frame = parents[frame]
    if root is not None and frame != root:
        yield f"{message.topic} at {stamp}: leads to {frame}, not to {root}"


def nothing_is_left_behind(evidence: Evidence) -> Iterator[str]:
    """The folder holds logs with their records, and nothing else."""
    for file in evidence.files:
        if not re.fullmatch(r"(\w+/)?(metrics_log|social/social_log)_\d+_\d+\.(csv|json)", file):
            yield f"left behind: {file}"


INVARIANTS: tuple[Callable[[Evidence], Iterator[str]], ...] = (
    nothing_is_missing,
    manifest_repeats_the_run,
    page_is_whole,
    nothing_is_lost,
    second_run_is_the_same_but_for_its_sensor,
    recording_is_indexed,
    second_recording_is_the_same,
    recording_without_ros_is_that_of_ros,
    ros_is_direct,
    replay_is_the_log,
    counts_are_rates_times_duration,
    every_scan_is_placeable,
    nothing_is_left_behind,
)


def stamp_of(message: Any) -> int:  # noqa: ANN401 - rosbags makes its classes
    """Returns the stamp of a message's header [ns]."""
    return int(message.header.stamp.sec * 10**9 + message.header.stamp.nanosec)


def flat(value: Any, place: str = "") -> Iterator[tuple[str, Any]]:  # noqa: ANN401 - any JSON value
    """Yields each leaf of a JSON value with where it is, as in topics//scan/lost."""
    if not isinstance(value, dict | list):
        yield place, value
        return
    for key, item in value.items() if isinstance(value, dict) else enumerate(value):
        yield from flat(item, f"{place}/{key}" if place else str(key))


def differing(one: Any, other: Any) -> Iterator[str]:  # noqa: ANN401 - two JSON values
    """Yields each leaf that is not the same in both."""
    before, after = dict(flat(one)), dict(flat(other))
    for place in sorted(before.keys() | after.keys()):
        if before.get(place) != after.get(place):
            yield f"{place}: {before.get(place)} became {after.get(place)}"


def first_difference(one: str, other: str) -> str:
    """Returns the first cell in which two logs differ, by column and row."""
    header, *_ = one.splitlines()
    for number, (a, b) in enumerate(zip(one.splitlines(), other.splitlines(), strict=False)):
        cells = zip(header.split(","), a.split(","), b.split(","), strict=False)
        for column, left, right in cells:
            if left != right:
                return f"row {number}, {column}: {left} became {right}"
    return f"{len(one.splitlines())} lines became {len(other.splitlines())}"


def _same(one: Any, other: Any, how: str) -> Iterator[str]:  # noqa: ANN401 - two Driven
    for kind in ("csv", "social"):
        before, after = getattr(one, kind), getattr(other, kind)
        if before != after:
            yield f"{one.name} {how}: {kind} {first_difference(before, after)}"
    if one.stream != other.stream:
        yield f"{one.name} {how}: another stream of samples ({one.samples}, then {other.samples})"


def _same_keys(
    one: dict[str, Any], other: dict[str, Any], keys: Iterable[str], how: str
) -> Iterator[str]:
    for key in sorted(set(keys) - VOLATILE - {"social_log", "recording"}):
        yield from (f"{how}: manifest {line}" for line in differing({key: one[key]}, {key: other[key]}))
