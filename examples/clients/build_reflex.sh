#!/bin/sh
# Builds reflex.c against a ROS 2 below PREFIX: build_reflex.sh PREFIX [PROGRAM]. PREFIX is a virtual environment with
# the wheels of ROS 2, or /opt/ros/DISTRO.
set -eu
prefix=$1
include=$(find "$prefix/include" -mindepth 1 -maxdepth 1 -type d -exec printf -- '-I%s ' {} \;)
libraries="$prefix/lib $(find "$prefix"/lib/python3*/site-packages -maxdepth 1 -name 'ros_*.libs' 2>/dev/null || true)"
search=$(for folder in $libraries; do printf -- '-L%s -Wl,-rpath,%s ' "$folder" "$folder"; done)
# The wheels' librcl needs Python's type support, and that the symbols of libpython; no interpreter is started.
python=
if [ -x "$prefix/bin/python" ]; then
    python=$("$prefix/bin/python" -c 'import sysconfig as s; print(s.get_config_var("LIBDIR"), s.get_config_var("LDLIBRARY"), sep="/")')
    case $python in
    *.so*) python="-Wl,--no-as-needed,-rpath,$(dirname "$python") $python" ;;
    *) echo "build_reflex.sh: $prefix/bin/python has no shared libpython, which the wheels' librcl needs" >&2 && exit 2 ;;
    esac
fi
# shellcheck disable=SC2086 - lists of flags
exec "${CC:-cc}" -std=gnu11 -O2 -Wall -Wextra -o "${2:-reflex}" "$(dirname "$0")/reflex.c" $include $search $python \
    -Wl,--allow-shlib-undefined,--disable-new-dtags -lrcl -lrcutils -lrosidl_runtime_c \
    -lgeometry_msgs__rosidl_typesupport_c -lgeometry_msgs__rosidl_generator_c \
    -lsensor_msgs__rosidl_typesupport_c -lsensor_msgs__rosidl_generator_c -lm
