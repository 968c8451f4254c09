"""Tells where MuJoCo has the links of an arm that a URDF file describes.

Shares no code with fabc. Standard input: `{"urdf": FILE, "joints": [NAME, ...], "tip": LINK, "angles": [[...], ...]}`,
angles in radians, in the order of the names. Standard output: for each row the frame of the tip as a position in metres
and the rows of a rotation matrix, and the height of the lowest corner of each link behind the first joint's own, all in
the frame of the file's root. Meshes are read from the folder `meshes`, if it is given.
"""

import json
import pathlib
import re
import sys

import mujoco
import numpy as np

asked = json.load(sys.stdin)
path = pathlib.Path(asked["urdf"])
text = path.read_text()
# Visual shapes are in formats that MuJoCo does not read, and links without mass are refused.
text = re.sub(r"<visual>.*?</visual>", "", text, flags=re.DOTALL)
options = 'fusestatic="false" boundmass="0.01" boundinertia="0.0001" balanceinertia="true" strippath="true"'
meshes = pathlib.Path(asked["meshes"]).resolve()
text = text.replace("</robot>", f'<mujoco><compiler {options} meshdir="{meshes}"/></mujoco></robot>')
model = mujoco.MjModel.from_xml_string(text)
data = mujoco.MjData(model)
addresses = [model.joint(name).qposadr[0] for name in asked["joints"]]
tip = model.body(asked["tip"]).id
first = model.joint(asked["joints"][0]).bodyid[0]


def is_behind(body):
    while body not in (0, first):
        body = model.body_parentid[body]
    return body == first


def corners(geom):
    """The corners of a mesh or a box, in its own frame."""
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = model.geom_dataid[geom]
        begin, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        return model.mesh_vert[begin : begin + count]
    assert model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_BOX, model.geom_type[geom]
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    return signs * model.geom_size[geom]


behind = [
    (geom, corners(geom))
    for geom in range(model.ngeom)
    if model.geom_bodyid[geom] != first and is_behind(model.geom_bodyid[geom])
]


def row(angles):
    data.qpos[addresses] = angles
    mujoco.mj_kinematics(model, data)
    lowest = [data.geom_xpos[geom][2] + (points @ data.geom_xmat[geom].reshape(3, 3)[2]).min() for geom, points in behind]
    return {
        "position_m": data.xpos[tip].tolist(),
        "rotation": data.xmat[tip].reshape(3, 3).tolist(),
        "lowest_m": float(min(lowest)),
    }


json.dump([row(angles) for angles in asked["angles"]], sys.stdout)
