import subprocess
import sys


def test_the_process_that_publishes_an_episode_loads_neither_mujoco_nor_compiled_kernels() -> None:
    script = (
        "import sys, harness.run, harness.ros.session;"
        "print(sorted({'mujoco', 'numba'} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"
