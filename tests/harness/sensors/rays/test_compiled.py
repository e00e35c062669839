import subprocess
import sys


def test_no_run_imports_coverage_which_stays_importable() -> None:
    code = (
        "import sys, harness.sensors.rays.compiled\n"
        "print('numba' in sys.modules, 'coverage' in sys.modules)\n"
        "import coverage, numba.misc.coverage_support as support\n"
        "print(support.coverage_available)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True", "False", "False"]
