"""Nodes of other client libraries in lock-step: nothing lost, the same bytes as with a node of rclpy."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest

from harness.run import main
from tests.clients.conftest import Clients, Run

DRIVE = ("--terrain", "posts", "--driver", "cmd_vel", "--duration", "4")
EFFECT = ("--wait-for-topic", "/cmd_vel")
ASK = ("--wait-for", "/reflex")
SCANS = 4 * 20
THREADED = Path(__file__).with_name("threaded.py")


@pytest.mark.parametrize(("name", "wait"), [("javascript", ASK), ("javascript", EFFECT), ("c", EFFECT)])
def test_a_foreign_node_drives_what_it_hears_to_the_bytes_of_a_node_of_rclpy(
    clients: Clients, run: Run, name: str, wait: tuple[str, ...]
) -> None:
    foreign = getattr(clients, name)()
    with clients.running(clients.python()):
        reference, _ = run(*DRIVE, *ASK)
    with clients.running(foreign):
        csv, manifest = run(*DRIVE, *wait)
    assert csv == reference
    assert manifest["commands"]["taken"] == SCANS
    assert manifest["topics"]["/scan"] == {"published": SCANS, "received": SCANS, "lost": 0}
    assert sum(topic["lost"] for topic in manifest["topics"].values()) == 0


def test_an_answer_from_a_thread_of_its_own_repeats_only_where_time_waits_for_the_answer(
    clients: Clients, run: Run
) -> None:
    csv = []
    for wait in (EFFECT, EFFECT, ("--wait-for", "/threaded")):
        with clients.running(clients.python(THREADED)):
            csv.append(run(*DRIVE, *wait)[0])
    assert csv[0] == csv[1]
    assert csv[2] != csv[0]  # the node was asked, answered, and was still at work


def test_an_output_that_does_not_come_ends_the_run_and_names_who_should_have_sent_it(
    clients: Clients, run: Run, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    spin_until = import_module("harness.ros.context").spin_until

    def hurried(executor: object, condition: Callable[[], bool], patience: float) -> bool:
        """Where the publisher has been found, who hears the input would have been, too."""
        is_last = condition.__name__ == "_input_is_heard"
        return bool(spin_until(executor, condition, 0.5 if is_last else patience))

    with clients.running(clients.python()):
        csv, manifest = run(
            *DRIVE, "--wait-for-topic", "/cmd_vel,timeout=0.5", "--fault", "scan:dropout", expected=0
        )
        assert len(csv.splitlines()) == 5  # what was not asked need not be answered
        with monkeypatch.context() as patch:
            patch.setattr("harness.ros.effect.spin_until", hurried)
            assert main([*DRIVE, "--wait-for-topic", "/cmd_vel,newer-than=/joint_states"]) == 2
    assert manifest["commands"]["taken"] == 0
    silent, more = clients.python(THREADED)
    with clients.running(([*silent[:2], "silent", *silent[2:]], more)):
        run(*DRIVE, "--wait-for-topic", "/cmd_vel,timeout=0.5", expected=1)
    unheard, missing = (line for line in capfd.readouterr().err.splitlines() if "harness.run: " in line)
    assert "/joint_states" in unheard
    assert all(name in missing for name in ("/cmd_vel", "/scan", "/threaded"))


@pytest.mark.parametrize(
    "effect",
    ["/cmd_vel,newer-than=/nothing", "/cmd_vel,timeout=-1", "/cmd_vel,soon", ",", "/cmd_vel,x=1"],
)
@pytest.mark.usefixtures("clients")
def test_an_effect_that_cannot_be_awaited_is_told_in_a_line(
    effect: str, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main([*DRIVE, "--wait-for-topic", effect]) == 2
    last = capfd.readouterr().err.splitlines()[-1]
    assert last.startswith("harness.run: ")
