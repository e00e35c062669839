#!/bin/sh
# Runs the suite of rover_metrics against the wheels of ROS 2 Jazzy, in an environment of its own without
# MuJoCo, on Python 3.10 (Humble's) where there is one; then all that speaks ROS of the harness, on the Python
# of .venv with Jazzy in the place of Kilted. Called by `make test-jazzy`; PYTHON=... chooses the first one.
set -eu
cd "$(dirname "$0")/.."

fail() {
    echo "test-jazzy: $1" >&2
    exit 2
}

usable() {
    "$1" -c 'import ensurepip, sys, venv; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 13))' >/dev/null 2>&1
}

find_python() {
    for candidate in ${PYTHON:-python3.10 "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.10.*/bin/python \
        python3.12 python3.11 python3.13 python3}; do
        if usable "$candidate"; then
            echo "$candidate"
            return
        fi
    done
    return 1
}

# Another distribution's wheels, or a sourced /opt/ros, leave paths behind that break this rclpy.
unset _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH PYTHONPATH AMENT_PREFIX_PATH

python=$(find_python) || fail "needs Python 3.10 to 3.13 with venv; name one: make test-jazzy PYTHON=/path/to/python3.10"
venv=build/jazzy-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
tools/pinned.sh jazzy "$python" "$venv"
echo "test-jazzy: $("$venv/bin/python" --version), rclpy $("$venv/bin/python" -m pip list 2>/dev/null |
    sed -n 's/^ros-rclpy  *//p')"
PYTHONPATH=.:rover_metrics "$venv/bin/python" -m pytest tests/rover_metrics "$@"

# What is not ROS comes from .venv, behind Jazzy's wheels.
tools/pinned.sh jazzy
version=$(.venv/bin/python -c 'import sys; print("python%d.%d" % sys.version_info[:2])')
packages=build/environments/jazzy/lib/$version/site-packages
echo "$PWD/.venv/lib/$version/site-packages" >"$packages/zz_harness.pth"
echo "test-jazzy: the harness on $version, with rclpy of Jazzy"
PYTHONPATH="$PWD:$PWD/rover_metrics" exec build/environments/jazzy/bin/python -m pytest -n 3 --dist worksteal \
    tests/harness/ros tests/harness/testing tests/harness/scenario tests/e2e "$@"
