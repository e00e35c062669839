import hashlib
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from types import FunctionType

import numba
import numpy as np
import pytest

from harness.base import compiled
from harness.robots.lidar import LidarSpec
from harness.sensors.lidar import Lidar
from harness.sensors.rays.bundle import RayBundle
from tests.harness.sensors import test_lidar as lidars


def test_no_run_imports_what_no_kernel_needs_which_stays_importable() -> None:
    code = (
        "import sys, harness.sensors.rays.arrays\n"
        "print(*(name in sys.modules for name in ('numba', 'coverage', 'scipy.linalg')))\n"
        "import coverage, scipy.linalg.cython_blas, numba.np.arraymath\n"
        "print(numba.misc.coverage_support.coverage_available, numba.np.arraymath._HAVE_BLAS)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True", "False", "False", "False", "True"]


KERNEL = "from harness.base import compiled\ndouble = compiled.kernel('f8(f8)')(lambda x: 2 * x)\n"
TOLD = "harness: {}: neither the installation nor the user's cache can be written (NUMBA_CACHE_DIR names"


def test_where_nothing_can_be_written_kernels_are_kept_in_a_temporary_folder_of_the_user_alone(
    tmp_path: Path,
) -> None:
    (tmp_path / "one_kernel.py").write_text(KERNEL)
    (tmp_path / "__pycache__").touch()  # a file, in which nobody makes a file, whatever his powers
    (tmp_path / "temp").mkdir()
    unwritable = {"HOME": "/proc/nobody", "XDG_CACHE_HOME": "/proc/nobody", "TMPDIR": f"{tmp_path}/temp"}
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    environment |= unwritable | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    command = [sys.executable, "-c", "import one_kernel; print(one_kernel.double(2.5))"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    folder = tmp_path / "temp" / f"rover_harness_kernels_{os.getuid()}"
    assert (done.stdout, done.stderr.count("\n")) == ("5.0\n", 1)
    assert done.stderr.startswith(TOLD.format(f"compiled kernels are kept in {folder}"))
    assert folder.stat().st_mode & 0o777 == 0o700
    assert len(list(folder.rglob("*.nbc"))) == 1


def test_a_function_of_nobody_compiles_beside_the_kernels() -> None:
    assert numba.njit(FunctionType((lambda x: 2 * x).__code__, {}))(2) == 4


def scans() -> str:
    """A hash of what lidars see."""
    rng, digest = np.random.default_rng(8), hashlib.sha256()
    for n, tilt in ((9, 0.0), (30, 0.3), (90, 2.0)):
        world = lidars.terrain_spec(0.2 * rng.normal(size=(n, n)), 0.2)
        lidars.add_random_obstacles(world, rng, 0.1 * n)
        lidars.add_rover(world, 0.5)
        scene = lidars.compiled(world)
        lidars.place_rover(scene, np.array([0.3, -0.2, 0.4]), tilt, rng)
        lidar = Lidar(scene[0], LidarSpec(beams=90))
        directions = rng.normal(size=(200, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        pose = np.vstack([scene[1].site("lidar").xpos, scene[1].site("lidar").xmat.reshape(3, 3)])
        ranges = RayBundle(lidar.surroundings, directions, 8.0).cast(scene[1], pose)
        digest.update(lidar.scan(scene[1]).tobytes() + ranges.tobytes())
    return digest.hexdigest()


def test_what_is_compiled_gives_the_bits_that_python_gives() -> None:
    plain = subprocess.run(
        [sys.executable, "-c", f"import {__name__} as here; print(here.scans())"],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert plain.stdout.split() == [scans()]


@pytest.mark.parametrize("trap", ["open to others", "a link", "a file"])
def test_a_temporary_folder_that_others_could_fill_is_not_trusted(
    trap: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder, elsewhere = tmp_path / f"rover_harness_kernels_{os.getuid()}", tmp_path / "elsewhere"
    elsewhere.mkdir(mode=0o700)
    if trap == "a link":
        folder.symlink_to(elsewhere)
    elif trap == "a file":
        folder.touch(mode=0o600)
    else:
        folder.mkdir()
        folder.chmod(0o750)
    assert compiled._temporary_cache() is None
    assert capsys.readouterr().err.startswith(TOLD.format("kernels are compiled anew at each start"))
    folder.rename(tmp_path / "away")
    for said in (1, 0):  # once
        assert compiled._temporary_cache() == str(folder)
        assert capsys.readouterr().err.count("\n") == said


HELPER = "from harness.base import compiled\nFACTOR = 3\nhelp = compiled.inlined(lambda x: {} * x)\n"
BORROWING = (
    "from harness.base import compiled\nfrom helper import FACTOR, help\n"
    "times = compiled.kernel('f8(f8)')(lambda x: FACTOR * help(x))\n"
)
# A child for each helper knows as little of the others as a process that is started anew.
CHANGING = """
import os, sys
import harness.base.compiled
for at, helper in enumerate(sys.argv[1:]):
    with open("helper.py", "w") as file:
        file.write(helper)
    os.utime("helper.py", ns=(at, 10**9 * at))  # for Python's own cache
    if not os.fork():
        import borrowing
        print(borrowing.times(1.0), flush=True)
        os._exit(0)
    os.wait()
"""


def test_a_kernel_in_the_cache_is_renewed_when_a_helper_or_a_number_of_another_file_changes(
    tmp_path: Path,
) -> None:
    (tmp_path / "borrowing.py").write_text(BORROWING)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    helpers = [HELPER.format(2), HELPER.format(5), HELPER.format(5).replace("3", "4")]
    command = [sys.executable, "-c", CHANGING, *helpers]
    done = subprocess.run(
        command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert [*map(float, done.stdout.split())] == [6.0, 15.0, 20.0]


START = """
import sys
import numba.core.event as event
from harness import Run, run_episode
with event.install_recorder("numba:compile") as compiled:
    run = dict(terrain="rocky", soil="dry_sand", driver="mppi", sensors=["lidar3d", "height_scan"])
    run_episode(Run.of(**run, actors=["anna=random"], duration=0.1), sys.argv[1])
print([at.data["dispatcher"] for _, at in compiled.buffer])
"""


def test_the_second_start_compiles_nothing(tmp_path: Path) -> None:
    command = [sys.executable, "-c", START, str(tmp_path)]
    for _ in range(2):  # the first one compiles what no start has compiled before
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        if done.stdout.splitlines()[-1] == "[]":
            return
    pytest.fail(done.stdout)
