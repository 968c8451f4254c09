"""Times a textbook XPBD cloth in Taichi on the scene of `fabc sim time`: textbook_xpbd.py [SIDE]

Macklin, Müller and Chentanez 2016 with the small steps of 2019: 20 substeps of one iteration over coloured distance
constraints (stretch, shear, bend), a table with friction, and self-contact through a uniform grid. One corner of a cloth of
SIDE by SIDE particles (50), 6.25 mm apart, is raised 50 mm, carried along the diagonal at 5 mm a step of 0.01 s, lowered and
released. Prints one JSON line; compiling is not timed. Frames and units: metres, seconds, z up.
"""

import json
import math
import sys
import time

import numpy as np
import taichi as ti

ti.init(arch=ti.cpu, cpu_max_num_threads=1, default_fp=ti.f32, log_level=ti.ERROR)

SIDE = int(sys.argv[1]) if len(sys.argv) > 1 else 50
COUNT = SIDE * SIDE
SPACING = 0.00625
STEP, SUBSTEPS = 0.01, 20
DT = STEP / SUBSTEPS
THICKNESS = 0.01125  # between layers, as the recorded scene has it
TABLE, FRICTION = 0.005, 0.75
# Per family: offset in columns and rows, and compliance in m/N with particles of mass 1.
FAMILIES = [((1, 0), 0.0), ((0, 1), 0.0), ((1, 1), 1e-7), ((-1, 1), 1e-7), ((2, 0), 1e-5), ((0, 2), 1e-5)]
CELLS = 64
ROOM = 32  # particles of a grid cell that are looked at

x = ti.Vector.field(3, ti.f32, COUNT)
before = ti.Vector.field(3, ti.f32, COUNT)
v = ti.Vector.field(3, ti.f32, COUNT)
push = ti.Vector.field(3, ti.f32, COUNT)
pushes = ti.field(ti.i32, COUNT)
weight = ti.field(ti.f32, COUNT)
filled = ti.field(ti.i32, (CELLS, CELLS, CELLS))
members = ti.field(ti.i32, (CELLS, CELLS, CELLS, ROOM))


@ti.kernel
def lay():
    for i in range(COUNT):
        column, row = i % SIDE, i // SIDE
        middle = 0.5 * (SIDE - 1)
        x[i] = ti.Vector([(column - middle) * SPACING, (middle - row) * SPACING, TABLE])
        v[i] = ti.Vector([0.0, 0.0, 0.0])
        weight[i] = 1.0


@ti.kernel
def predict():
    for i in range(COUNT):
        before[i] = x[i]
        v[i] += DT * weight[i] * ti.Vector([0.0, 0.0, -9.8])
        x[i] += DT * weight[i] * v[i]


@ti.kernel
def hold(sx: ti.f32, sy: ti.f32, sz: ti.f32):
    x[0] += ti.Vector([sx, sy, sz])


@ti.kernel
def fix(free: ti.f32):
    weight[0] = free
    v[0] = ti.Vector([0.0, 0.0, 0.0])


@ti.kernel
def pull(dc: ti.i32, dr: ti.i32, colour: ti.i32, compliance: ti.f32):
    """Corrects every other constraint of a family, along its own direction, so that no two share a particle."""
    for i in range(COUNT):
        column, row = i % SIDE, i // SIDE
        along = row if dr != 0 else column
        apart = ti.max(ti.abs(dc), ti.abs(dr))
        inside = 0 <= column + dc < SIDE and row + dr < SIDE
        if inside and along // apart % 2 == colour:
            j = i + dc + dr * SIDE
            total = weight[i] + weight[j]
            d = x[i] - x[j]
            length = d.norm()
            if total > 0.0 and length > 1e-9:
                rest = SPACING * ti.sqrt(float(dc * dc + dr * dr))
                scaled = (length - rest) / (total + compliance / (DT * DT)) / length * d
                x[i] -= weight[i] * scaled
                x[j] += weight[j] * scaled


@ti.func
def cell_of(p):
    return ti.max(0, ti.min(CELLS - 1, int(ti.floor(p / THICKNESS)) + CELLS // 2))


@ti.kernel
def sort():
    for cell in ti.grouped(filled):
        filled[cell] = 0
    for i in range(COUNT):
        cell = cell_of(x[i])
        place = ti.atomic_add(filled[cell], 1)
        if place < ROOM:
            members[cell, place] = i


@ti.kernel
def touch():
    for i in range(COUNT):
        push[i] = ti.Vector([0.0, 0.0, 0.0])
        pushes[i] = 0
    for i in range(COUNT):
        home = cell_of(x[i])
        for offset in ti.static(ti.grouped(ti.ndrange((-1, 2), (-1, 2), (-1, 2)))):
            cell = ti.max(0, ti.min(CELLS - 1, home + offset))
            for k in range(ti.min(filled[cell], ROOM)):
                j = members[cell, k]
                near = ti.abs(i % SIDE - j % SIDE) <= 2 and ti.abs(i // SIDE - j // SIDE) <= 2
                d = x[i] - x[j]
                length = d.norm()
                if j != i and not near and length < THICKNESS and length > 1e-9:
                    away = 0.5 * (THICKNESS - length) / length * d
                    slid = (x[i] - before[i]) - (x[j] - before[j])
                    slid -= slid.dot(d) / (length * length) * d
                    drag = ti.min(1.0, away.norm() / (slid.norm() + 1e-12))
                    push[i] += away - 0.5 * drag * slid
                    pushes[i] += 1
    for i in range(COUNT):
        if pushes[i] > 0:
            x[i] += weight[i] * push[i] / pushes[i]
        below = TABLE - x[i].z
        if below > 0.0 and weight[i] > 0.0:
            slid = x[i] - before[i]
            slid.z = 0.0
            x[i] -= ti.min(1.0, FRICTION * below / (slid.norm() + 1e-12)) * slid
            x[i].z = TABLE


@ti.kernel
def finish():
    for i in range(COUNT):
        v[i] = weight[i] * (x[i] - before[i]) / DT * (1.0 - DT)


def step(shift):
    for _ in range(SUBSTEPS):
        predict()
        hold(*(axis / SUBSTEPS for axis in shift))
        for (dc, dr), compliance in FAMILIES:
            for colour in range(2):
                pull(dc, dr, colour, compliance)
        sort()
        touch()
        finish()


def fold():
    """Runs the scene; returns the number of steps."""
    lay()
    fix(0.0)
    side = (SIDE - 1) * SPACING
    carried = math.ceil(side * math.sqrt(2) / 0.005)
    ways = [((0, 0, 0.05), 10), ((side, -side, 0), carried), ((0, 0, -0.05), 10)]
    for way, steps in ways:
        for _ in range(steps):
            step([axis / steps for axis in way])
    fix(1.0)
    for _ in range(50):
        step([0.0, 0.0, 0.0])
    ti.sync()
    return carried + 70


def main():
    # The first step compiles.
    lay()
    step([0.0, 0.0, 0.0])
    start = time.process_time()
    steps = fold()
    spent = time.process_time() - start
    positions = x.to_numpy()
    corner, opposite = positions[0], positions[-1]
    print(
        json.dumps(
            {
                "side": SIDE,
                "steps": steps,
                "cpu_ms_per_step": 1000.0 * spent / steps,
                "corner_from_opposite_mm": 1000.0 * float(np.hypot(*(corner - opposite)[:2])),
                "finite": bool(np.isfinite(positions).all()),
            }
        )
    )


main()
