#!/bin/sh
# Prints in one line what the tests against ROS 1 lack, or nothing if they can run.
#
# Debian packages ROS 1: its master, its Python nodes, actionlib and the generator of Python messages. If this user may
# install packages without a password, this script installs the missing ones, unless FABC_NO_INSTALL=1. OpenSSL's
# development files do not belong to ROS; fabc's feature `ros` is built with them (deps.sh).
set -u
packages="python3-rosmaster python3-rospy python3-actionlib python3-genpy python3-sensor-msgs python3-trajectory-msgs"
packages="$packages ros-std-msgs ros-geometry-msgs ros-actionlib-msgs ros-trajectory-msgs libssl-dev pkg-config"

# Checks the files that the tests name, in the same places.
lacks() {
    if ! /usr/bin/python3 -c "import actionlib, genpy, rospy, sensor_msgs.msg, trajectory_msgs.msg" 2>/dev/null; then
        echo "ROS 1 for /usr/bin/python3"
    elif [ ! -e /usr/bin/rosmaster ] || [ ! -e /usr/lib/genpy/genmsg_py.py ]; then
        echo "rosmaster or genpy"
    elif [ ! -e /usr/share/actionlib_msgs/msg/GoalID.msg ] || [ ! -e /usr/share/trajectory_msgs/msg/JointTrajectory.msg ]; then
        echo "the definitions of ROS's messages"
    elif ! pkg-config --exists openssl 2>/dev/null; then
        echo "OpenSSL's development files or pkg-config"
    fi
}

missing=$(lacks)
[ -n "$missing" ] || exit 0
if [ "$(id -u)" = 0 ]; then
    as_root=
elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
    as_root=sudo
else
    as_root=nobody
fi
if [ "${FABC_NO_INSTALL:-0}" = 0 ] && [ "$as_root" != nobody ] && command -v apt-get >/dev/null; then
    echo "installing ROS 1 from this system's packages, which takes half a minute" >&2
    # shellcheck disable=SC2086  # `packages` is a list, `as_root` may be nothing
    install() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $packages >&2; }
    # The package list may be absent, or older than the mirror.
    install || { $as_root apt-get update -qq >&2 && install; }
    missing=$(lacks)
fi
[ -z "$missing" ] || echo "$missing is missing (Debian: apt-get install --no-install-recommends $packages)"
