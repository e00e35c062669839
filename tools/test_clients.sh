#!/bin/sh
# Drives with programs from outside and hands our recordings to others: nodes of rclnodejs, of C and of Python's threads,
# lidar odometry, a planner, viewers' readers. Called by `make test-clients`. What cannot be installed here is said by the
# tests that skip for lack of it.
set -eu
cd "$(dirname "$0")/.."

root=$PWD
place=build/clients
prefix=$root/$place/prefix
tools/pinned.sh clients

# rclnodejs takes the place of the program `ros2` for a ROS 2's, and builds against what lies below: the wheels do.
mkdir -p "$prefix/bin"
for folder in include lib share; do ln -sfn "$root/.venv/$folder" "$prefix/$folder"; done
printf '#!/bin/sh\n' >"$prefix/bin/ros2"
chmod +x "$prefix/bin/ros2"

node_client() {
    command -v npm >/dev/null || { echo "test-clients: no npm: tests of Node.js skip" && return; }
    if [ ! "$place/.npm" -nt tools/clients/package-lock.json ]; then
        cp tools/clients/package.json tools/clients/package-lock.json "$place/"
        npm ci --prefix "$place" --ignore-scripts --no-audit --no-fund --loglevel=error
        touch "$place/.npm"
    fi
    package=$place/node_modules/rclnodejs
    [ -d "$package/generated" ] && [ -f "$package/build/Release/rclnodejs.node" ] && return
    headers=$(dirname "$(dirname "$(readlink -f "$(command -v node)")")")
    [ -f "$headers/include/node/node_api.h" ] || headers=/usr
    (
        cd "$package"
        export PATH="$prefix/bin:$root/.venv/bin:$PATH" AMENT_PREFIX_PATH="$prefix" ROS_DISTRO=kilted
        ../.bin/node-gyp rebuild --nodedir="$headers" --jobs=2 --loglevel=error
        # It loads what was built, and removes it where that fails.
        LD_LIBRARY_PATH=$(find "$root"/.venv/lib/python3*/site-packages -maxdepth 1 -name 'ros_*.libs' | paste -sd:):$prefix/lib
        LD_PRELOAD=$(python -c 'import sysconfig as s; print(s.get_config_var("LIBDIR"), s.get_config_var("LDLIBRARY"), sep="/")')
        export LD_LIBRARY_PATH LD_PRELOAD
        node scripts/generate_messages.cjs
    ) >"$place/build.log" 2>&1 || {
        echo "test-clients: rclnodejs was not built, its tests skip: $(tail -n 1 "$place/build.log")"
        rm -rf "$package/generated"
    }
}

node_client
version=$(.venv/bin/python -c 'import sys; print("%d.%d" % sys.version_info[:2])')
PYTHONPATH="$PWD/build/environments/clients/lib/python$version/site-packages" \
    exec .venv/bin/python -m pytest -p no:randomly tests/clients "$@"
