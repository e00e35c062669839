#!/bin/sh
# Makes .venv and installs the project into it at the pinned versions. Called by the Makefile; running
# it again is harmless. PYTHON=... chooses the interpreter.
set -eu
cd "$(dirname "$0")/.."

fail() {
    echo "setup: $1" >&2
    exit 2
}

usable() {
    "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' >/dev/null 2>&1
}

version_of() {
    "$1" --version 2>/dev/null || echo none
}

find_python() {
    for candidate in ${PYTHON:-python3 python3.12 python3.13 python3.11}; do
        if usable "$candidate"; then
            echo "$candidate"
            return
        fi
    done
    return 1
}

asked=${PYTHON:-python3}
python=$(find_python) || fail "needs Python 3.11, 3.12 or 3.13, found $(version_of "$asked") ($asked).
Install one (Debian, Ubuntu: apt install python3.12 python3.12-venv; macOS: brew install python@3.12)
or name it: make PYTHON=/path/to/python3.12"

"$python" -c 'import ensurepip, venv' 2>/dev/null || fail "$python has no venv module.
Install it (Debian, Ubuntu: apt install python3-venv)"

# A system rclpy (a sourced ROS 2) must not meet the one from PyPI in one interpreter.
if "$python" -c 'import rclpy' 2>/dev/null; then
    site=--system-site-packages
else
    site=
fi
[ -x .venv/bin/python ] || "$python" -m venv $site .venv
if .venv/bin/python -c 'import rclpy, sys; sys.exit(rclpy.__file__.startswith(sys.prefix))' 2>/dev/null; then
    left_out='^ros-'
    echo "setup: using the ROS 2 that $python imports already"
else
    left_out='^$'
fi
awk -v left_out="$left_out" '/^[^ #]/ { keep = $0 !~ left_out } keep' requirements.txt >.venv/requirements.txt

# Every file that is fetched must have the hash in a lock. What builds comes first, so that nothing is
# fetched unseen to build this project and the few dependencies that have no wheel.
install() {
    .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-build-isolation "$@" ||
        fail "pip could not install what $locked pins, see above. A hash that does not match means that the
index serves another file than the one that was locked: do not use it. Wanted on purpose? make lock"
}
locked=tools/build.txt
install --require-hashes --requirement "$locked"
locked=requirements.txt
install --require-hashes --requirement .venv/requirements.txt
.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps --editable .
# Compiles the lidar's kernels into their cache, so that the first run need not.
.venv/bin/python -c 'import harness.sensors.lidar'
touch .venv/.ready
