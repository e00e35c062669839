"""Environments in several processes: mistakes, a process that dies, Ctrl-C; nothing is left behind."""

import contextlib
import multiprocessing
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import InvalidAction, ResetNeeded

from harness.base.errors import RunFailed, UsageError
from tests.support.waiting import PATIENCE, wait_until

ID = "RoverHarness/PointNav-v0"
STILL = np.zeros((3, 2), np.float32)


def test_a_mistake_in_one_process_changes_nothing_in_any(small: dict[str, Any]) -> None:
    with contextlib.closing(gymnasium.make_vec(ID, num_envs=3, processes=2, **small)) as envs:
        with pytest.raises(ResetNeeded, match="no episode to step"):
            envs.step(STILL)
        first = envs.reset(seed=4)[1]
        with pytest.raises(InvalidAction, match="finite numbers"):
            envs.step(np.array([[0.5, 0.5], [0.5, 0.5], [0.0, np.nan]], np.float32))
        with pytest.raises(InvalidAction, match="actions of shape"):
            envs.step(np.zeros((3, 3), np.float32))
        with pytest.raises(UsageError, match="off the map"):
            envs.reset(options={"start": (50.0, 0.0, 0.0)})
        told = envs.step(STILL)[4]
        assert told["reward_terms"]["action_rate"].tolist() == [0.0] * 3
        moved = np.abs(told["x_position"] - first["start"][:, 0])
        assert moved.max() < 0.1


def test_a_function_that_no_process_can_be_sent_is_told(small: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match=r"FILE\.py:NAME"):
        gymnasium.make_vec(ID, num_envs=2, processes=2, reward_fn=lambda *_: {}, **small)


def test_a_process_that_dies_is_told_and_takes_the_others_with_it(small: dict[str, Any]) -> None:
    envs = gymnasium.make_vec(ID, num_envs=3, processes=2, **small)
    envs.reset(seed=1)
    victim, *_ = multiprocessing.active_children()
    os.kill(victim.pid or 0, signal.SIGKILL)
    with pytest.raises(RunFailed, match=re.escape("died (exit code -9)")):
        envs.step(STILL)
    assert not multiprocessing.active_children()
    with pytest.raises(RuntimeError, match="closed"):
        envs.step(STILL)
    envs.close()


STEPPING = """
import gymnasium, numpy as np, multiprocessing, harness.gym
if __name__ == "__main__":
    envs = gymnasium.make_vec("RoverHarness/PointNav-v0", num_envs=2, processes=2, lidar_beams=8)
    envs.reset(seed=1)
    print(*(child.pid for child in multiprocessing.active_children()), flush=True)
    while True:
        envs.step(np.zeros((2, 2), np.float32))
"""


def started(script: Path, text: str) -> "subprocess.Popen[str]":
    """A script that has two environments, in a process each, of which it is the first."""
    script.write_text(text)
    return subprocess.Popen(
        [sys.executable, str(script)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )


def test_a_script_that_fails_between_two_steps_ends(tmp_path: Path) -> None:
    text = STEPPING.replace("while True:", "raise SystemExit(7)").partition("        envs.step")[0]
    with started(tmp_path / "failing.py", text) as process:
        try:
            assert process.wait(PATIENCE) == 7
        finally:
            process.kill()
        assert process.stdout is not None
        children = [int(pid) for pid in process.stdout.read().split()]
    wait_until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in children))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_whichever_way_the_command_ends_no_process_and_no_memory_is_left(
    number: signal.Signals, tmp_path: Path
) -> None:
    with started(tmp_path / "stepping.py", STEPPING) as process:
        assert process.stdout is not None
        children = [int(pid) for pid in process.stdout.readline().split()]
        assert len(children) == 1
        mapped = Path(f"/proc/{process.pid}/maps").read_text()
        shared = set(re.findall(r"/dev/shm/\S+", mapped))  # noqa: S108 - to be looked at
        for pid in (process.pid, *(children if number == signal.SIGINT else ())):  # as a terminal does
            os.kill(pid, number)
        assert process.wait(PATIENCE) != 0
    wait_until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in children))
    assert not [path for path in shared if Path(path).exists()]
