"""Reads a Wavefront .obj text from standard input with trimesh and prints what it found, as JSON.

Shares no code with fabc. Nothing is stated about the file: trimesh takes it as it would take anybody's.
"""

import json
import sys

import trimesh

mesh = trimesh.load_mesh(sys.stdin.buffer, file_type="obj")
uv = mesh.visual.uv
print(
    json.dumps(
        {
            "vertices": len(mesh.vertices),
            "faces": len(mesh.faces),
            "area_m2": mesh.area,
            "faces_up": bool((mesh.face_normals[:, 2] > 0.999).all()),
            "winding_agrees": bool(mesh.is_winding_consistent),
            # Vertices less edges plus faces: 1 for a disc, 0 for a ring.
            "euler_number": int(mesh.euler_number),
            "bounds_m": mesh.bounds.tolist(),
            # The texture lies on the cloth as seen from above: u grows with x, v with y.
            "uv_of_back_right": uv[(mesh.vertices[:, 0] + mesh.vertices[:, 1]).argmax()].tolist(),
        }
    )
)
