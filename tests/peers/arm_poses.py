"""Tells where MuJoCo has the links of the Kinova Jaco that dm_control carries.

Shares no code with fabc. Standard input: `{"angles": [[six angles in radians], ...]}`. Standard output: what the model
is, and for each row the frames of its six links, of its wrist (`wristsite`) and of its grip (`gripsite` of the hand
mounted there), each as a position in metres and the rows of a rotation matrix, in the frame of the arm's base.

Only dm_control's model files are used, and they are found without importing it: its own layer over MuJoCo wants a
certain version of that.
"""

import importlib.util
import json
import pathlib
import sys

import mujoco

folder = pathlib.Path(importlib.util.find_spec("dm_control").origin).parent / "third_party" / "kinova"
arm = mujoco.MjModel.from_xml_path(str(folder / "jaco_arm.xml"))
hand = mujoco.MjModel.from_xml_path(str(folder / "jaco_hand.xml"))
arm_data, hand_data = mujoco.MjData(arm), mujoco.MjData(hand)
mujoco.mj_kinematics(hand, hand_data)


def pose(position, matrix):
    return {"position_m": position.tolist(), "rotation": matrix.reshape(3, 3).tolist()}


def poses(angles):
    assert len(angles) == arm.nq == 6
    arm_data.qpos[:] = angles
    mujoco.mj_kinematics(arm, arm_data)
    wrist, grip = arm_data.site("wristsite"), hand_data.site("gripsite")
    turn = wrist.xmat.reshape(3, 3)
    links = [arm_data.body(f"b_{number}") for number in range(1, 7)]
    return {
        "links": [pose(link.xpos, link.xmat) for link in links],
        "wrist": pose(wrist.xpos, wrist.xmat),
        "grip": pose(wrist.xpos + turn @ grip.xpos, turn @ grip.xmat.reshape(3, 3)),
    }


joints = [arm.joint(f"joint_{number}") for number in range(1, 7)]
print(
    json.dumps(
        {
            "fingers": sum(hand.joint(number).name.startswith("finger_") for number in range(hand.njnt)),
            "limits_rad": [joint.range.tolist() if arm.jnt_limited[joint.id] else None for joint in joints],
            "poses": [poses(angles) for angles in json.load(sys.stdin)["angles"]],
        }
    )
)
