"""What goes out on /tf, and what comes in from others; rosbags reads and writes the messages."""

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.waiting import PATIENCE

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.base.errors import RunFailed
from harness.base.message_types import typestore
from harness.messages.transforms import TF_MESSAGE, transform_fill, transforms_bytes
from harness.robots.frames.tree import Description, Edge
from harness.ros import frames
from harness.ros.bridge import Bridge
from harness.ros.context import spin_until
from harness.ros.foreign_type import forget_missing_definition, message_type
from harness.ros.frames import NO_TYPE
from harness.samples import Tick, Transforms
from tests.support.ros import Ros

BASE = ("odom", "base_footprint")
WHEEL = ("base_link", "wheel_FL_link")
OWN = Description((), (BASE, WHEEL), owns_odom=True, urdf="<robot/>")
MAPPED = Description((Edge("map", "odom"),), (WHEEL,), owns_odom=False, urdf="")

names = st.text("abc_/é", min_size=1, max_size=9)
numbers = st.floats(allow_nan=True)


def read(data: bytes) -> list[tuple[Any, ...]]:
    """Stamp [ns], parent, child and the seven values of each transform."""
    message: Any = typestore().deserialize_cdr(data, TF_MESSAGE)
    told = []
    for one in message.transforms:
        t, r, stamp = one.transform.translation, one.transform.rotation, one.header.stamp
        values = (t.x, t.y, t.z, r.x, r.y, r.z, r.w)
        told.append((stamp.sec * 10**9 + stamp.nanosec, one.header.frame_id, one.child_frame_id, values))
    return told


@given(
    st.lists(st.tuples(names, names), max_size=4),
    st.integers(0, 2**31 * 10**9 - 1),
    st.lists(numbers, min_size=28, max_size=28),
)
def test_a_sample_becomes_the_bytes_that_rosbags_reads_as_its_frames(
    pairs: list[tuple[str, str]], stamp_ns: int, values: list[float]
) -> None:
    count = len(pairs)
    fill = transform_fill(pairs)
    translation, rotation = tuple(values[: 3 * count]), tuple(values[12 : 12 + 4 * count])
    fill(Transforms(5, translation[::-1], rotation[::-1]))  # another one before
    told = read(fill(Transforms(stamp_ns, translation, rotation)))
    expected = [
        (stamp_ns, *pair, translation[3 * n : 3 * n + 3] + rotation[4 * n : 4 * n + 4])
        for n, pair in enumerate(pairs)
    ]
    assert repr(told) == repr(expected)  # NaN too


def advance(bridge: Bridge, seconds: int) -> None:
    """A tick at a full second, with the pose of the base."""
    stamp = seconds * 10**9
    sample = Transforms(stamp, (float(seconds), 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    tick = Tick(stamp, (sample,))
    bridge.advance(tick, tick, listeners=())


def rival(ros: Ros, name: str, *told: Edge) -> Any:  # noqa: ANN401 - rclpy has no types
    """Another node, which says on /tf what it says whenever it is asked to."""
    node = ros.node(name)
    publisher = node.create_publisher(message_type(TF_MESSAGE), "tf", 10)
    forget_missing_definition()
    return SimpleNamespace(speak=lambda: publisher.publish(transforms_bytes(told)))


def test_a_second_owner_of_the_base_is_named_with_the_mend_and_no_other_publisher_is(
    ros: Ros,
) -> None:
    bridge = ros.bridge()
    bridge.describe(OWN)
    amcl = rival(ros, "amcl", Edge("map", "odom"), Edge("base_link", "arm_link"))
    seconds = iter(range(1, 1_000_000))

    def watched() -> bool:
        advance(bridge, next(seconds))
        return bool(bridge.frames._watched and list(bridge.subscriptions)[-1].get_publisher_count() == 2)

    assert spin_until(bridge.executor, watched, PATIENCE)
    for _ in range(20):
        amcl.speak()
        advance(bridge, next(seconds))
        bridge.executor.spin_once(timeout_sec=0.01)
    ekf = rival(ros, "ekf", Edge("odom", "base_footprint"))

    def refused() -> bool:
        ekf.speak()
        advance(bridge, next(seconds))
        return False

    with pytest.raises(RunFailed) as told:
        spin_until(bridge.executor, refused, PATIENCE)
    assert str(told.value) == (
        "/tf has odom -> base_footprint from /amcl or /ekf too, and a frame has one owner: "
        "stop it there, or give --odom-tf none here"
    )


@pytest.mark.parametrize(
    ("description", "told", "mend"),
    [
        (OWN, Edge("map", "base_footprint"), "give --odom-tf none here"),
        (Description((), (WHEEL,), owns_odom=False, urdf=""), Edge(*BASE), None),
        (OWN, Edge("map", "odom"), None),
        (MAPPED, Edge("map", "odom"), "give no --map-tf here"),
    ],
)
def test_what_has_one_owner_is_what_this_run_tells_of_odom_and_map(
    ros: Ros, description: Description, told: Edge, mend: str | None
) -> None:
    bridge = ros.bridge()
    bridge.describe(description)
    bridge.frames.hear(transforms_bytes([told]))
    if mend is None:
        bridge.frames.refuse_rivals()
        return
    with pytest.raises(
        RunFailed, match=f"from another node too, and a frame has one owner.* or {mend}$"
    ):
        bridge.frames.refuse_rivals()


def test_without_the_type_one_line_says_so_and_the_rest_goes_on(
    ros: Ros, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(frames, "message_type", lambda _: None)
    bridge = ros.bridge()
    bridge.describe(OWN)
    advance(bridge, 1)
    published = bridge.published()
    assert capfd.readouterr().err.count(NO_TYPE) == 1
    assert (published["/robot_description"], published["/clock"]) == (1, 1)
    assert not {"/tf", "/tf_static"} & set(published)
