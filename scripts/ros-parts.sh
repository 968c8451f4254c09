#!/bin/sh
# Prints in one line what the tests against ROS 1 lack, or nothing if they can run.
#
# Debian packages ROS 1: its master, its Python nodes, actionlib and the generator of Python messages (deps.sh, `peers`).
set -u

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
[ -z "$missing" ] || echo "$missing is missing (make deps FEATURES=peers)"
