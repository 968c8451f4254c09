"""MuJoCo's cloth as a world for fabc: a foreign simulator that answers lines of JSON (docs/worlds.md).

pip install mujoco numpy
fabc run tasks/double_triangle.fab --world exec:"python3 docs/examples/mujoco_world.py"

The cloth is a flex, an elastic sheet of vertices some 16 mm apart; fabc's finer grid is interpolated from it. The
pictures are drawn from the particles with numpy, so no graphics card is needed. Lengths are metres, times seconds.
"""
import hashlib
import json
import queue
import struct
import sys
import threading
import zlib

import mujoco
import numpy as np

SPACING = 0.016  # between vertices; finer cloth folds better and takes far longer
RADIUS, RESTING = 0.003, 0.005  # height above the table of a flat cloth's vertices, and of fabc's particles
STEP = 0.01
SPEED, LIFT, LOW = 0.25, 0.05, 0.015  # of the hand: its speed, how high it carries, where it lets go
REACH = 0.02  # a pick farther than this from every vertex misses
REST_SPEED, MOST_SETTLING = 0.02, 4.0  # the cloth rests below this speed, or is taken to after this time
MODEL = """<mujoco><option timestep="{step}" cone="elliptic" integrator="discrete" iterations="20" tolerance="1e-6"/>
<size memory="500M"/>
<worldbody><geom type="plane" size="2 2 .1" friction="1.5"/><body name="hand" mocap="true"/>
  <flexcomp name="cloth" type="direct" dim="2" mass="0.05" radius="{radius}" point="{points}" element="{triangles}">
    <contact contype="1" conaffinity="1" selfcollide="auto" friction="0.75"/>
    <edge equality="true" solref="0.015 1"/>
  </flexcomp></worldbody>
<equality><connect name="grip" body1="hand" body2="cloth_0" anchor="0 0 0" active="false" solref="0.005 1" 
  solimp="0.99 0.999 0.001"/></equality></mujoco>"""
ORANGE, PINK, LIGHT, DARK = (232, 140, 52), (240, 160, 190), (228, 226, 222), (206, 204, 200)


def resampled(grid, shape):
    """Interpolates a grid of points, [rows, columns, 3], to another number of rows and columns."""
    for axis, count in enumerate(shape):
        at = np.linspace(0, grid.shape[axis] - 1, count)
        low = np.minimum(at.astype(int), grid.shape[axis] - 2)
        part = (at - low).reshape([-1 if it == axis else 1 for it in range(3)])
        grid = np.take(grid, low, axis) * (1 - part) + np.take(grid, low + 1, axis) * part
    return grid


class World:
    def __init__(self):
        self.interrupt = threading.Event()
        self.data = None

    def hello(self, question):
        self.folder = question["folder"]
        # Every setting stands in this file, so that one hash says both.
        code = open(__file__, "rb").read() + mujoco.__version__.encode() + np.__version__.encode()
        code = hashlib.sha256(code).hexdigest()[:16]
        return {"name": "mujoco", "parameters": code, "code": code, "particles": True}

    def reset(self, question):
        start, self.camera, self.picker = question["start"], question["camera"], question["picker"]
        grid = start["grid"]
        self.fine = (grid["dimy"], grid["dimx"])
        size = [(count - 1) * grid["spacing_m"] for count in self.fine]
        rows, columns = (max(3, round(side / SPACING) + 1) for side in size)
        ends = np.array([[[-1, 1], [1, 1]], [[-1, -1], [1, -1]]]) / 2 * size[::-1]
        flat = resampled(np.dstack([ends, np.full((2, 2), RADIUS)]), (rows, columns))
        triangles = []
        for row in range(rows - 1):
            for column in range(columns - 1):
                a = row * columns + column
                b, c, d = a + 1, a + columns + 1, a + columns
                # Diagonals alternate, so that the cloth is as soft one way as the other.
                triangles += [a, c, b, a, d, c] if (row + column) % 2 == 0 else [a, d, b, b, d, c]
        listed = {"points": " ".join(map(str, flat.ravel())), "triangles": " ".join(map(str, triangles))}
        self.model = mujoco.MjModel.from_xml_string(MODEL.format(step=STEP, radius=RADIUS, **listed))
        self.data = mujoco.MjData(self.model)
        self.shape, self.seconds = (rows, columns), 0.0
        self.first = self.model.body("cloth_0").id
        self.grip, self.hand = self.model.eq("grip").id, self.model.body("hand").mocapid[0]
        if start["lie"] == "positions":
            # A vertex slides along x, y and z from where it lies in the flat cloth.
            lies = np.load(start["positions"]).astype(float).reshape(*self.fine, 3)
            lies[:, :, 2] += RADIUS - RESTING
            self.data.qpos[:] = (resampled(lies, self.shape) - flat).ravel()
        mujoco.mj_forward(self.model, self.data)
        return {}

    def surface(self, shape):
        """Returns fabc's particles, [rows, columns, 3]."""
        surface = resampled(self.data.flexvert_xpos.reshape(*self.shape, 3), shape)
        return surface + [0, 0, RESTING - RADIUS]

    def step(self):
        if self.interrupt.is_set():
            raise InterruptedError
        mujoco.mj_step(self.model, self.data)
        self.seconds += STEP

    def move(self, to):
        begin = self.data.mocap_pos[self.hand].copy()
        steps = max(1, int(np.ceil(1.5 * np.linalg.norm(to - begin) / (SPEED * STEP))))
        for number in range(1, steps + 1):
            share = number / steps
            self.data.mocap_pos[self.hand] = begin + (to - begin) * (3 * share**2 - 2 * share**3)
            self.step()

    def act(self, question):
        pick, place = np.array(question["pick"]), np.array(question["place"])
        points, begun = self.data.flexvert_xpos.reshape(-1, 3), self.seconds
        away = np.hypot(*(points - pick)[:, :2].T)
        done = {"pick": question["pick"], "place": question["place"], "grasp": "missed", "duration_s": 0.0}
        if away.min() > REACH:
            return done
        # The uppermost layer; of its vertices the nearest one.
        near = np.flatnonzero(away < away.min() + 0.006)
        near = near[points[near, 2] > points[near, 2].max() - 0.004]
        vertex = near[away[near].argmin()]
        self.model.eq_obj2id[self.grip] = self.first + vertex
        self.model.eq_data[self.grip, :6] = 0
        taken = points[vertex].copy()
        self.data.mocap_pos[self.hand] = taken
        self.data.eq_active[self.grip] = 1
        high = taken[2] + LIFT
        # It rises while it begins to go, so that the corner rolls over and does not drag.
        self.move(np.array([*(taken + 0.15 * (place - taken))[:2], high]))
        self.move(np.array([*place[:2], high]))
        if self.picker == "put_down":
            self.move(np.array([*place[:2], max(taken[2], LOW)]))
        self.data.eq_active[self.grip] = 0
        settling = self.seconds
        while self.seconds - settling < MOST_SETTLING:
            self.step()
            fastest = np.linalg.norm(self.data.qvel.reshape(-1, 3), axis=1).max()
            if self.seconds - settling > 20 * STEP and fastest < REST_SPEED:
                break
        return {**done, "grasp": "held", "duration_s": self.seconds - begun}

    def particles(self, question):
        return {"positions": self.saved("particles.npy", self.surface(self.fine).reshape(-1, 3))}

    def observe(self, question):
        height, side = self.camera["height_m"], self.camera["image_px"]
        focal = side / 2 / np.tan(self.camera["fov_rad"] / 2)
        # Image right and image down, as ways of the table.
        right, down = ([1, 0, 0], [0, -1, 0]) if self.camera["up"] == "y" else ([0, -1, 0], [-1, 0, 0])
        # Four points for each pixel that the flat cloth covers: no hole is left between them.
        dense = [int(4 * focal / height * SPACING * count) for count in self.shape]
        surface = self.surface(dense)
        along, across = np.gradient(surface, axis=1), np.gradient(surface, axis=0)
        is_upper = np.cross(along, across)[:, :, 2].ravel() < 0
        points = surface.reshape(-1, 3)
        depths = height - points[:, 2]
        column, row = (np.floor(side / 2 + focal * (points @ way) / depths).astype(int) for way in (right, down))
        seen = np.flatnonzero((column >= 0) & (column < side) & (row >= 0) & (row < side))
        seen = seen[np.argsort(-depths[seen], kind="stable")]  # what is nearest is drawn last
        rows, columns = np.mgrid[:side, :side]
        rgb = np.where(((rows // 16 + columns // 16) % 2 == 0)[:, :, None], LIGHT, DARK).astype(np.uint8)
        depth = np.full((side, side), height, np.float32)
        rgb[row[seen], column[seen]] = np.where(is_upper[seen, None], ORANGE, PINK)
        depth[row[seen], column[seen]] = depths[seen]
        pose = np.eye(4)
        pose[:3, :3], pose[2, 3] = np.array([right, down, [0, 0, -1]]).T, height
        camera = {"focal_px": [focal] * 2, "center_px": [side / 2] * 2, "world_from_camera": pose.tolist()}
        return {"rgb": self.png(rgb), "depth": self.saved("depth.npy", depth), "time_s": self.seconds, "camera": camera}

    def saved(self, name, array):
        path = f"{self.folder}/{name}"
        np.save(path, array.astype("<f4"))
        return path

    def png(self, rgb):
        def chunk(kind, body):
            return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

        lines = zlib.compress(b"".join(b"\0" + line.tobytes() for line in rgb))
        head = struct.pack(">IIBBBBB", rgb.shape[1], rgb.shape[0], 8, 2, 0, 0, 0)
        path = f"{self.folder}/rgb.png"
        with open(path, "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", lines) + chunk(b"IEND", b""))
        return path


def read(lines, world):
    """Reads questions beside the simulation, so that an interrupt is heard while it runs."""
    for line in sys.stdin:
        question = json.loads(line)
        world.interrupt.set() if question["do"] == "interrupt" else lines.put(question)
    lines.put(None)


world, questions = World(), queue.Queue()
threading.Thread(target=read, args=(questions, world), daemon=True).start()
while (question := questions.get()) is not None:
    try:
        answer = getattr(world, question["do"])(question)
    except InterruptedError:
        answer = {"interrupted": True}
    world.interrupt.clear()
    print(json.dumps(answer), flush=True)
