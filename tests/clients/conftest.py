"""Programs from outside, started beside a run of the harness; `make test-clients` installs them."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

from harness.base.message_types import read_message
from harness.run import main
from tests.support.documents import ROOT

CLIENTS = ROOT / "build" / "clients"
EXAMPLES = ROOT / "examples" / "clients"
NODE_CLIENT = CLIENTS / "node_modules" / "rclnodejs"
Run = Callable[..., tuple[str, dict[str, Any]]]  # options of harness.run -> its CSV and its manifest
SIM_TIME = ("--ros-args", "-p", "use_sim_time:=true")


def recorded(path: Path, *topics: str) -> list[tuple[str, int, Any]]:
    """Topic, stamp of the log [ns] and message of all that a recording holds of these topics."""
    with path.open("rb") as file:
        return [
            (channel.topic, message.log_time, read_message(message.data, schema.name))
            for schema, channel, message in make_reader(file).iter_messages(topics or None)
            if schema is not None
        ]


def libraries() -> str:
    """Where the wheels of ROS 2 keep what a program without their start-up has to find."""
    wheels = sorted(Path(sysconfig.get_path("purelib")).glob("ros_*.libs"))
    return os.pathsep.join([*map(str, wheels), str(Path(sys.prefix, "lib"))])


@dataclass(frozen=True)
class Clients:
    """How each program from outside is started.

    Attributes:
        folder: For what is built or written.
    """

    folder: Path

    def javascript(self, script: Path = EXAMPLES / "reflex.mjs") -> tuple[list[str], dict[str, str]]:
        if not (NODE_CLIENT / "build" / "Release" / "rclnodejs.node").is_file():
            pytest.skip("needs rclnodejs, built against the wheels: make test-clients")
        copied = shutil.copy(script, CLIENTS)  # modules are looked up from where the script is
        python = Path(sysconfig.get_config_var("LIBDIR"), sysconfig.get_config_var("LDLIBRARY"))
        path = os.pathsep.join([str(CLIENTS / "prefix" / "bin"), os.environ["PATH"]])
        return ["node", str(copied), *SIM_TIME], {
            "PATH": path,
            "AMENT_PREFIX_PATH": str(CLIENTS / "prefix"),
            "ROS_DISTRO": "kilted",
            "LD_LIBRARY_PATH": libraries(),
            "LD_PRELOAD": str(python),
        }

    def c(self) -> tuple[list[str], dict[str, str]]:
        if shutil.which("cc") is None:
            pytest.skip("needs a C compiler")
        program, build = self.folder / "reflex", EXAMPLES / "build_reflex.sh"
        built = subprocess.run(
            ["/bin/sh", build, sys.prefix, program], capture_output=True, text=True, check=False
        )
        if built.returncode == 2:
            pytest.skip(built.stderr.strip())
        assert (built.returncode, built.stderr) == (0, "")
        return [str(program)], {}

    def python(self, script: Path = EXAMPLES / "reflex.py") -> tuple[list[str], dict[str, str]]:
        return [sys.executable, str(script), *SIM_TIME], {}

    @contextmanager
    def running(self, client: tuple[Sequence[str], dict[str, str]]) -> Iterator[None]:
        """Runs a client, and says what it said when something fails."""
        words, more = client
        said = self.folder / "client.log"
        with said.open("w") as log:
            process = subprocess.Popen(
                words, env=os.environ | more, stdout=log, stderr=subprocess.STDOUT, cwd=self.folder
            )
        try:
            yield
            assert process.poll() is None, said.read_text()
        finally:
            process.kill()  # rclpy may lose a SIGTERM that comes while its executor goes to sleep
            process.wait()
            print(said.read_text())


@pytest.fixture
def clients(ros_domain: int, tmp_path: Path) -> Clients:  # noqa: ARG001 - sets the domain
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    return Clients(tmp_path)


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Runs `harness.run` with these options; gives the CSV and the manifest."""

    def run(*options: str, expected: int = 0) -> tuple[str, dict[str, Any]]:
        folder = tmp_path / "logs"
        shutil.rmtree(folder, ignore_errors=True)
        assert main([*options, "--log-dir", str(folder)]) == expected
        (manifest,) = folder.glob("*.json")
        return manifest.with_suffix(".csv").read_text(), json.loads(manifest.read_text())

    return run
