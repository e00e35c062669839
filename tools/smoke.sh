#!/bin/sh
# Installs the wheel of build/release (`make dist`) on each supported Python that is there, and drives with it outside
# the checkout, without ROS and through it. Called by `make smoke`; PYTHONS="..." chooses the interpreters.
set -eu
cd "$(dirname "$0")/.."

wheel=$(echo "$PWD"/build/release/*.whl)
[ -f "$wheel" ] || { echo "smoke: no wheel in build/release; make dist builds it" >&2 && exit 2; }

# Another interpreter's ROS wheels leave paths behind that break this one's rclpy.
unset _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH PYTHONPATH AMENT_PREFIX_PATH

find_python() {
    for candidate in ${PYTHONS:-"python$1" "${PYENV_ROOT:-$HOME/.pyenv}"/versions/"$1".*/bin/python}; do
        if "$candidate" -c "import ensurepip, sys, venv; sys.exit('%d.%d' % sys.version_info[:2] != '$1')" \
            >/dev/null 2>&1; then
            echo "$candidate"
            return
        fi
    done
    return 1
}

tried=0
for version in 3.11 3.12 3.13; do
    python=$(find_python "$version") || { echo "smoke: no Python $version here: not tried" && continue; }
    place=$PWD/build/smoke-$version
    rm -rf "$place"
    "$python" -m venv "$place"
    # The versions of the lock without their hashes: the wheel just built has none.
    sed -n 's/^\([A-Za-z0-9].*==.*[^ ]\) *\\$/\1/p' requirements.txt >"$place/versions.txt"
    "$place/bin/pip" install --quiet --disable-pip-version-check --constraint "$place/versions.txt" "$wheel[ros,gym]"
    (
        cd "$place"
        bin/rover-run --direct --duration 5 --log-dir direct
        bin/rover-run --duration 5 --log-dir ros
        cmp direct/metrics_log_*.csv ros/metrics_log_*.csv
        bin/python -c "import gymnasium, harness.gym; gymnasium.make('RoverHarness/RoboTerrain-v0').reset(seed=1)"
    )
    echo "smoke: Python $version drives, with and without ROS to the same bytes"
    tried=$((tried + 1))
    rm -rf "$place"
done
[ "$tried" -gt 0 ] || { echo "smoke: no supported Python here" >&2 && exit 2; }
