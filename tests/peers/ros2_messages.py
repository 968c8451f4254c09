"""Reads and writes messages of ROS 2 with rosbags, which has its own definitions and its own CDR.

In: lines of JSON on stdin, each with a `type` and its `bytes` in hexadecimal. Out: for each a line with the `fields` that
were read, and the `bytes` that rosbags writes of them.
"""

import json
import sys

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

# rosbags has no control_msgs and no services of actions. These are the definitions of control_msgs 4 and 5 (Humble to
# Kilted), and the services that rosidl makes of an action.
DEFINITIONS = {
    "control_msgs/msg/JointTolerance": "string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration\n",
    "control_msgs/msg/JointComponentTolerance": """string joint_name
uint16 component
float64 position
float64 velocity
float64 acceleration
""",
    "control_msgs/msg/GripperCommand": "float64 position\nfloat64 max_effort\n",
    "control_msgs/action/FollowJointTrajectory_Goal": """trajectory_msgs/JointTrajectory trajectory
trajectory_msgs/MultiDOFJointTrajectory multi_dof_trajectory
control_msgs/JointTolerance[] path_tolerance
control_msgs/JointComponentTolerance[] component_path_tolerance
control_msgs/JointTolerance[] goal_tolerance
control_msgs/JointComponentTolerance[] component_goal_tolerance
builtin_interfaces/Duration goal_time_tolerance
""",
    "control_msgs/action/FollowJointTrajectory_Result": "int32 error_code\nstring error_string\n",
    "control_msgs/action/GripperCommand_Goal": "control_msgs/GripperCommand command\n",
    "control_msgs/action/GripperCommand_Result": "float64 position\nfloat64 effort\nbool stalled\nbool reached_goal\n",
    "control_msgs/action/ParallelGripperCommand_Goal": "sensor_msgs/JointState command\n",
    "control_msgs/action/ParallelGripperCommand_Result": """sensor_msgs/JointState state
bool stalled
bool reached_goal
""",
    "std_srvs/srv/Trigger_Request": "",
    "std_srvs/srv/Trigger_Response": "bool success\nstring message\n",
    "action_msgs/srv/CancelGoal_Request": "action_msgs/GoalInfo goal_info\n",
    "action_msgs/srv/CancelGoal_Response": "int8 return_code\naction_msgs/GoalInfo[] goals_canceling\n",
}
for action in "FollowJointTrajectory", "GripperCommand", "ParallelGripperCommand":
    name = f"control_msgs/action/{action}"
    identity = "unique_identifier_msgs/UUID goal_id\n"
    DEFINITIONS[f"{name}_SendGoal_Request"] = f"{identity}control_msgs/action/{action}_Goal goal\n"
    DEFINITIONS[f"{name}_SendGoal_Response"] = "bool accepted\nbuiltin_interfaces/Time stamp\n"
    DEFINITIONS[f"{name}_GetResult_Request"] = identity
    DEFINITIONS[f"{name}_GetResult_Response"] = f"int8 status\ncontrol_msgs/action/{action}_Result result\n"


def plain(value):
    """Returns what JSON can carry of a message."""
    if hasattr(value, "__msgtype__"):
        # Constants have names in capitals.
        return {name: plain(field) for name, field in vars(value).items() if name.islower() and name != "__msgtype__"}
    if hasattr(value, "tolist"):
        return value.tolist()
    return [plain(item) for item in value] if isinstance(value, list) else value


def main():
    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, text in DEFINITIONS.items():
        # It would file it under `msg`.
        (fields,) = get_types_from_msg(text, name).values()
        store.register({name: fields})
    for line in sys.stdin:
        said = json.loads(line)
        message = store.deserialize_cdr(bytes.fromhex(said["bytes"]), said["type"])
        written = bytes(store.serialize_cdr(message, said["type"])).hex()
        print(json.dumps({"fields": plain(message), "bytes": written}))


if __name__ == "__main__":
    main()
