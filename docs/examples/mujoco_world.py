"""A world for fabc: a square of cloth on a table, simulated by MuJoCo. docs/worlds.md says what it is asked.
To install:  pip install mujoco numpy        (written with MuJoCo 4.0)
To run:      fabc run TASK --world exec:"python3 docs/examples/mujoco_world.py"
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

# Every name in capitals is a setting. Lengths are metres, times seconds, masses kilograms.
RADIUS = 0.005  # Half the cloth's thickness: the middle of a flat cloth is 5 mm above the table.
DENSITY = 0.88  # Of a square metre.
CELL, MOST_CELLS = 0.015, 28  # Least side of a cell of the simulated cloth; most cells along a side.
GRASP_REACH = 0.02  # The gripper takes nothing that is farther from the pick point, as seen from above.
LIFT, PUT_DOWN_HEIGHT = 0.08, 0.015  # How far it lifts; where it lets go, unless it took hold higher up.
SLANT = 0.2  # It rises over this share of the way, and comes down over as much: the cloth stays slack.
SPEED, REST_SPEED, LONGEST_WAIT = 0.17, 0.02, 4.0  # Its mean speed; it waits until the cloth is that slow.
TOP, UNDERSIDE, TILES = (255, 113, 0), (248, 145, 201), ((246, 243, 243), (216, 213, 213))  # Colours.
SHADING = 0.3  # How much darker an upright surface is than a flat one.
MODEL = """
<mujoco>
  <option timestep="0.01" integrator="discrete" cone="elliptic" impratio="1.2"/>
  <size memory="200M"/>
  <worldbody>
    <geom type="plane" size="2 2 0.1" friction="1.5"/>
    <body name="hand" mocap="true"/>
    <flexcomp name="cloth" type="direct" dim="2" mass="{}" radius="{}" point="{}" element="{}">
      <contact friction="0.75"/>
      <elasticity elastic2d="both" young="1e5" poisson="0.2" thickness="5e-4" damping="0.01"/>
    </flexcomp>
  </worldbody>
  <equality><connect body1="hand" body2="cloth_0" anchor="0 0 0" active="false" solref="0.005 1"/></equality>
</mujoco>"""
SETTINGS = repr({name: value for name, value in globals().items() if name.isupper()})


def resample(points, rows, columns):
    """Interpolates a grid of points, `[rows, columns, 3]`, to another number of rows and columns."""
    for axis, count in enumerate((rows, columns)):
        at = np.linspace(0, points.shape[axis] - 1, count)
        low = np.minimum(at.astype(int), points.shape[axis] - 2)
        share = np.expand_dims(at - low, (1 - axis, 2))
        points = (1 - share) * points.take(low, axis) + share * points.take(low + 1, axis)
    return points


def triangles_of(rows, columns):
    """Cuts each cell in two. The diagonals alternate, so that the cloth folds alike both ways."""
    triangles = []
    for row, column in np.ndindex(rows - 1, columns - 1):
        a = row * columns + column
        b, c, d = a + 1, a + columns + 1, a + columns
        triangles += [(a, c, b), (a, d, c)] if (row + column) % 2 == 0 else [(a, d, b), (b, d, c)]
    return np.array(triangles)


def write_png(path, rgb):
    rows = b"".join(b"\0" + row.tobytes() for row in rgb)  # Each row begins with its filter: none.
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        header = b"IHDR" + struct.pack(">IIBBBBB", rgb.shape[1], rgb.shape[0], 8, 2, 0, 0, 0)
        for part in (header, b"IDAT" + zlib.compress(rows), b"IEND"):
            file.write(struct.pack(">I", len(part) - 4) + part + struct.pack(">I", zlib.crc32(part)))


class World:
    """The cloth, the gripper and the camera. Each question has the method of its name."""

    def __init__(self):
        self.data = None  # What MuJoCo simulates, once a cloth lies on the table.
        self.questions, self.interrupt = queue.Queue(), threading.Event()

    def hello(self, folder, **_):
        self.folder = folder
        with open(__file__, "rb") as file:
            texts = SETTINGS.encode(), file.read() + mujoco.__version__.encode()
        parameters, code = (hashlib.sha256(text).hexdigest()[:16] for text in texts)
        about = {"name": "mujoco", "parameters": parameters, "code": code}
        return {"protocol": 2, "grippers": 1, "particles": True, **about}

    def reset(self, camera, picker, start, **_):
        grid, positions = start["grid"], np.load(start["positions"])
        shape = grid["dimy"], grid["dimx"]
        if positions.shape != (shape[0] * shape[1], 3) or not np.isfinite(positions).all():
            raise ValueError(f"a start of {shape[1]} x {shape[0]} particles is three finite numbers for each")
        self.camera, self.picker, self.shape = camera, picker, shape
        self.sides = depth, width = [grid["spacing_m"] * (count - 1) for count in shape]
        # Cells are even in number, so that the diagonals of the cloth are also diagonals of cells.
        self.coarse = [int(np.clip(side / CELL // 2 * 2, 2, MOST_CELLS)) + 1 for side in self.sides]
        back, front = ([(x * width / 2, y * depth / 2, RADIUS) for x in (-1, 1)] for y in (1, -1))
        self.flat = resample(np.array([back, front]), *self.coarse)
        lists = (" ".join(map(str, numbers.ravel())) for numbers in (self.flat, triangles_of(*self.coarse)))
        self.model = mujoco.MjModel.from_xml_string(MODEL.format(DENSITY * depth * width, RADIUS, *lists))
        self.model.eq_data[:] = 0  # What the hand holds is in its middle.
        self.data = mujoco.MjData(self.model)
        # MuJoCo counts from where a point lies in the flat cloth.
        self.data.qpos = (resample(positions.reshape(*shape, 3), *self.coarse) - self.flat).ravel()
        return {}

    def cloth(self, rows, columns):
        return resample(self.flat + self.data.qpos.reshape(self.flat.shape), rows, columns)

    def particles(self, **_):
        path = f"{self.folder}/particles.npy"
        np.save(path, self.cloth(*self.shape).reshape(-1, 3).astype("<f4"))
        return {"positions": path}

    def observe(self, **_):
        height, size = self.camera["height_m"], self.camera["image_px"]
        focal = size / 2 / np.tan(self.camera["fov_rad"] / 2)
        # Which way of the table is right in the picture, and which is down.
        axes = np.array([(1, 0, 0), (0, -1, 0)] if self.camera["up"] == "y" else [(0, -1, 0), (-1, 0, 0)])
        middles = (np.arange(size) + 0.5 - size / 2) * height / focal
        table = np.stack(np.meshgrid(middles, middles), axis=2) @ axes[:, :2]
        rgb = np.where(table.prod(axis=2, keepdims=True) > 0, *TILES).astype(np.uint8)  # Four tiles.
        depth = np.full((size, size), height, "<f4")
        # The cloth is drawn as points a quarter of a pixel apart. Those near a pixel's middle show in it.
        points = self.cloth(*(int(4 * focal / height * side) for side in self.sides))
        normals = np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1))
        upright = (normals[..., 2] / np.linalg.norm(normals, axis=2))[..., None]
        colours = np.where(upright > 0, TOP, UNDERSIDE) * (1 - SHADING * (1 - abs(upright)))
        away = height - points[..., 2]
        at = size / 2 + focal * (points @ axes.T) / away[..., None]
        shown = ((at >= 0) & (at < size) & (abs(at % 1 - 0.5) < 0.25)).all(axis=2)
        nearest_last = np.argsort(-away[shown], kind="stable")
        columns, rows = at[shown][nearest_last].astype(int).T
        rgb[rows, columns], depth[rows, columns] = colours[shown][nearest_last], away[shown][nearest_last]
        paths = {"rgb": f"{self.folder}/rgb.png", "depth": f"{self.folder}/depth.npy"}
        write_png(paths["rgb"], rgb)
        np.save(paths["depth"], depth)
        pose = np.vstack([np.column_stack([*axes, (0, 0, -1), (0, 0, height)]), (0, 0, 0, 1)]).tolist()
        lens = {"focal_px": [focal, focal], "center_px": [size / 2, size / 2]}
        return {**paths, "time_s": self.data.time, "camera": {**lens, "world_from_camera": pose}}

    def act(self, grips, **_):
        [grip] = grips
        pick, place = grip["pick"], grip["place"]
        points, began = self.cloth(*self.coarse).reshape(-1, 3), self.data.time
        aside = np.linalg.norm(points[:, :2] - pick[:2], axis=1)
        if aside.min() > GRASP_REACH:
            return {"grips": [{"pick": pick, "place": place, "grasp": "missed"}], "duration_s": 0.0}
        # Of the layers at this point, the gripper takes the uppermost.
        held = np.where(aside < aside.min() + RADIUS, points[:, 2], -np.inf).argmax()
        x, y, z = points[held].tolist()
        self.model.eq_obj2id[0] = self.model.body(f"cloth_{held}").id
        self.data.mocap_pos[0] = x, y, z
        self.data.eq_active[0] = 1
        last = z + LIFT if self.picker == "drop" else max(z, PUT_DOWN_HEIGHT)
        for share, height in ((SLANT, z + LIFT), (1 - SLANT, z + LIFT), (1, last)):
            start = self.data.mocap_pos[0].copy()
            way = [x + share * (place[0] - x), y + share * (place[1] - y), height] - start
            count = int(np.linalg.norm(way) / SPEED / self.model.opt.timestep) + 1
            for part in np.arange(1, count + 1) / count:
                self.data.mocap_pos[0] = start + (3 - 2 * part) * part**2 * way  # Gently at both ends.
                self.step()
        self.data.eq_active[0] = 0
        fastest, latest = np.inf, self.data.time + LONGEST_WAIT
        while fastest > REST_SPEED and self.data.time < latest:
            self.step()
            fastest = np.linalg.norm(self.data.qvel.reshape(-1, 3), axis=1).max()
        end, seconds = self.data.mocap_pos[0].tolist(), self.data.time - began
        return {"grips": [{"pick": [x, y, z], "place": end, "grasp": "held"}], "duration_s": seconds}

    def step(self):
        if self.interrupt.is_set():
            self.data.eq_active[0] = 0
            raise InterruptedError
        mujoco.mj_step(self.model, self.data)
        if self.data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
            raise RuntimeError("the simulation became unstable")

    def answer(self, do, **question):
        try:
            if self.data is None and do in ("observe", "particles", "act"):
                raise ValueError("no cloth lies on the table yet: ask `reset` first")
            return getattr(self, do)(**question)
        except ValueError as why:
            return {"refused": str(why)}
        except InterruptedError:
            return {"interrupted": True}

    def read(self):
        """Reads on while the cloth moves. An interrupt that comes when nothing is under way is forgotten."""
        for question in map(json.loads, sys.stdin):
            if question["do"] == "interrupt":
                self.interrupt.set()
            else:
                self.interrupt.clear()
                self.questions.put(question)
        self.questions.put(None)


if __name__ == "__main__":
    world = World()
    threading.Thread(target=world.read, daemon=True).start()
    for question in iter(world.questions.get, None):
        print(json.dumps(world.answer(**question)), flush=True)
