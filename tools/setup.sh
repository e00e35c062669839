#!/bin/sh
# Makes .venv and installs the project into it at the pinned versions: everything, or with `run` what a run needs.
# Called by the Makefile; running it again is harmless. PYTHON=... chooses the interpreter.
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

kernels="sensors.rays.bundle physics.aside" # what takes longest to compile, each without the others
case ${1:-} in
run) wanted=tools/run.txt compile= done=.venv/.runs ;;
*) wanted=requirements.txt compile=--compile-bytecode done=".venv/.runs .venv/.ready" kernels="$kernels soil.press_kernel soil.rig_kernel" ;;
esac

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

# pins LOCK [NAMES [OTHERS]]: the pins of a lock that match NAMES, but for OTHERS, with their hashes.
pins() {
    awk -v names="${2:-.}" -v others="${3:-^$}" '/^[^ #]/ { keep = $0 ~ names && $0 !~ others } keep' "$1"
}

# Every file that is fetched must have the hash in a lock, whoever fetches it.
pip() {
    .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-build-isolation "$@"
}

uv() {
    .venv/bin/python -m uv pip install --quiet --python .venv/bin/python --system-certs --no-build-isolation $compile "$@"
}

install() {
    "$installer" "$@" && return
    if [ $installer = uv ]; then
        installer=pip
        echo "setup: uv could not, see above; pip tries, which takes longer"
        pip "$@" && return
    fi
    fail "pip could not install what $locked pins, see above. A hash that does not match means that the
index serves another file than the one that was locked: do not use it. Wanted on purpose? make lock"
}

# uv needs a fifth of pip's time. It asks the index that pip is configured for.
index=$(.venv/bin/python -m pip config list | sed -n "s/^.*\.index-url='\(.*\)'$/\1/p" | tail -n 1)
[ -z "$index" ] || export UV_DEFAULT_INDEX="$index"
pins requirements.txt '^uv==' >.venv/uv.txt
installer=uv
pip --no-deps --only-binary :all: --require-hashes --requirement .venv/uv.txt || {
    installer=pip
    echo "setup: no uv for this machine, see above; pip installs, which takes longer"
}

# What builds comes first, so that nothing is fetched unseen to build this project and the few dependencies that have
# no wheel.
locked=tools/build.txt
install --require-hashes --requirement "$locked"
pins "$wanted" . "$left_out" >.venv/requirements.txt
locked=$wanted
install --require-hashes --requirement .venv/requirements.txt
install --no-deps --editable .

# Compiles kernels into their cache, each in a process of its own, and what a run imports, so that the first need not.
unset PYTHONDONTWRITEBYTECODE
for kernel in $kernels; do
    .venv/bin/python -c "import harness.$kernel" &
done
wait
.venv/bin/python -c 'import harness.run, harness.sensors.lidar, rover_metrics.session'
touch $done
