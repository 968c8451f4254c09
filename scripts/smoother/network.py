"""The network of `--policy smoother`: what it measures of a pull, and what it computes from that.

In: the inputs of `docs/policies.md` and the weights that `fit.py` fits. Out: an ONNX model that values pulls.

The first part measures each pull: 22 numbers, and the picture around the pick, turned so that the pull leads to the right. Lengths are
in sides of the cloth, so neither its size nor the picture's matters. The second part estimates the gain of coverage from both, as a share of
the flat cloth: the mean of three small convolutional networks over the picture and its mirror image. A pull that does not lead
outward is worth -1.
"""


import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

NAMES = (
    "covered hull filled lesser_face dark rough cloth_near one_sided cloth_around from_center from_middle farthest_from_pick patch "
    "own_near own_behind other_behind beyond ahead beside farthest_from_place widened length"
).split()
# Features are clipped at this many deviations from their mean.
LIMIT = 4
# Cells along each side of the window and samples along each side of a cell; the window's side and how much of it lies ahead, in sides.
CELLS, SAMPLES, SPAN, AHEAD = 24, 6, 2.0, 0.6
# How far a pull may deviate from the outward direction, degrees: half a direction less than a quarter turn.
OUTWARD_DEG = 67
# Output channels and sizes of the kernels of the convolutions, units of the hidden layer, and how many networks.
CONVOLUTIONS, HIDDEN, NETWORKS = [(8, 5), (16, 3), (16, 3)], 32, 3
# The end of a slice; the runtime's whole numbers have 32 bits.
END = 2**31 - 1
INPUTS = {"color": ["H", "W", 3], "cloth": ["H", "W"], "faces": [2, 3], "edge": [], "picks": ["N", 2], "places": ["N", 2]}
# Directions in which the outline's support is measured, and every how many pixels patches are told apart.
SUPPORTS, PATCH_STEP, PATCH_ROUNDS = 360, 3, 12


class Graph:
    """ONNX nodes as they are called: `g.Add(a, b)` appends a node and returns its output's name; numbers become constants."""

    def __init__(self):
        self.nodes, self.constants, self.names = [], {}, 0

    def constant(self, value, name=None):
        """Returns the name of a constant; equal ones share one."""
        value = np.asarray(value)
        value = value.astype(np.float32) if value.dtype.kind == "f" else value
        name = name or f"{value.dtype} {value.shape} {value.tolist()}"
        self.constants[name] = value
        return name

    def __getattr__(self, op):
        def append(*inputs, n_outputs=1, **attributes):
            names = [x if isinstance(x, str) else self.constant(x) for x in inputs]
            outputs = [f"t{self.names + i}" for i in range(n_outputs)]
            self.names += n_outputs
            self.nodes.append(helper.make_node(op, names, outputs, **attributes))
            return outputs[0] if n_outputs == 1 else outputs
        return append

    def total(self, x, *axes):
        return self.ReduceSum(x, np.array(axes), keepdims=0)

    def largest(self, x, *axes):
        return self.ReduceMax(x, np.array(axes), keepdims=0)

    def number(self, x):
        return self.Cast(x, to=TensorProto.FLOAT)

    def column(self, x, axis=1):
        return self.Unsqueeze(x, np.array([axis]))


def measured(g):
    """Returns the features `[N, 22]`, the windows `[N, 3, 24, 24]` of pulls and whether each leads outward `[N]`."""
    shape = g.Shape("cloth")
    height, width = (g.number(g.Gather(shape, np.int64(axis))) for axis in (0, 1))
    flat = np.array([-1])
    area = g.Mul("edge", "edge")
    relative = lambda x: g.Div(x, "edge")
    shares = lambda x: g.Div(x, area)

    # Faces: 0 table, 1 upper, 2 under, by the declared colour whose direction is nearer; a zero behind the end stands for outside.
    unit = g.Div("faces", g.ReduceL2("faces", np.array([1]), keepdims=1))
    apart = g.Sub(g.Gather(unit, np.int64(1)), g.Gather(unit, np.int64(0)))
    is_under = g.number(g.Greater(g.Reshape(g.MatMul("color", g.column(apart)), shape), 0.0))
    face_map = g.Mul("cloth", g.Add(is_under, 1.0))
    level = g.Round(g.Mul(g.largest("color", 2), 255.0))
    light_map = g.Mul(level, 0.0)
    for face in (1.0, 2.0):
        of_face = g.number(g.Equal(face_map, face))
        # One pixel in twenty may be brighter than flat cloth.
        rank = g.Add(g.Floor(g.Div(g.ReduceSum(of_face, keepdims=0), 20.0)), 1.0)
        rank = g.Reshape(g.Cast(rank, to=TensorProto.INT64), np.array([1]))
        brightest, _ = g.TopK(g.Reshape(g.Mul(level, of_face), flat), rank, n_outputs=2)
        bright = g.Max(g.ReduceMin(brightest, keepdims=0), 1.0)
        light_map = g.Add(light_map, g.Mul(of_face, g.Min(g.Div(level, bright), 1.0)))
    padded = lambda x: g.Concat(g.Reshape(x, flat), np.zeros(1, np.float32), axis=0)
    faces = padded(face_map)
    lights = padded(light_map)
    darks = padded(g.Mul(g.number(g.Greater(light_map, 0.0)), g.Sub(1.0, light_map)))
    outside = g.Cast(g.Mul(height, width), to=TensorProto.INT64)

    def at(x, y):
        x, y = g.Floor(x), g.Floor(y)
        inside = g.And(
            g.And(g.GreaterOrEqual(x, 0.0), g.Less(x, width)), g.And(g.GreaterOrEqual(y, 0.0), g.Less(y, height))
        )
        index = g.Cast(g.Add(g.Mul(g.Clip(y, -1.0, 8192.0), width), g.Clip(x, -1.0, 8192.0)), to=TensorProto.INT64)
        return g.Where(inside, index, outside)

    look = lambda values, x, y: g.Gather(values, at(x, y))
    is_cloth = lambda seen: g.number(g.Greater(seen, 0.0))

    # The whole cloth: its pixels, their middle, the first and last of each row, and the outline's support in all directions.
    pixels = g.number(g.NonZero(face_map))
    rows, columns = (g.Add(g.Gather(pixels, np.int64(axis)), 0.5) for axis in (0, 1))
    count = g.Max(g.ReduceSum("cloth", keepdims=0), 1.0)
    ends_of = lambda x: (g.ReduceMin(x, keepdims=0), g.ReduceMax(x, keepdims=0))
    middle = [g.ReduceMean(x, keepdims=0) for x in (columns, rows)]
    center = [g.Div(g.Add(*ends_of(x)), 2.0) for x in (columns, rows)]
    has_cloth = g.Greater(g.largest("cloth", 1), 0.0)
    row = g.Add(g.Range(0.0, height, 1.0), 0.5)
    column = g.Add(g.Range(0.0, width, 1.0), 0.5)
    from_end = lambda column: g.largest(g.Mul("cloth", column), 1)
    ends = [g.Sub(width, from_end(g.Sub(width, column))), from_end(column)]
    rim_x = g.Concat(*(g.Where(has_cloth, end, middle[0]) for end in ends), axis=0)
    rim_y = g.Concat(*(g.Where(has_cloth, row, middle[1]) for _ in ends), axis=0)
    turns = 2 * np.pi * np.arange(SUPPORTS) / SUPPORTS
    normals = np.stack([np.cos(turns), np.sin(turns)])
    rim = g.Concat(*(g.column(g.Sub(x, m)) for x, m in zip((rim_x, rim_y), middle)), axis=1)
    support = g.largest(g.MatMul(rim, normals), 0)

    def inside_px(support):
        """The area inside of all tangents."""
        beside = g.Add(*(g.Gather(support, np.roll(np.arange(SUPPORTS), turn), axis=-1) for turn in (1, -1)))
        sides = g.Div(g.Sub(beside, g.Mul(support, 2 * np.cos(turns[1]))), np.sin(turns[1]))
        return g.Mul(g.total(g.Mul(support, sides), -1), 0.5)

    hull_px = inside_px(support)
    lesser = g.total(g.Mul("cloth", is_under), 0, 1)
    lesser = g.Min(lesser, g.Sub(count, lesser))
    here = look(lights, columns, rows)
    inner, near = is_cloth(here), []
    for right, down in ((1, 0), (0, 1), (-1, 0), (0, -1)):
        moved = lambda far: (g.Add(columns, g.Mul("edge", far * right)), g.Add(rows, g.Mul("edge", far * down)))
        near.append(look(lights, *moved(0.014)))
        for light in (look(lights, *moved(0.025)), near[-1]):
            inner = g.Mul(inner, is_cloth(light))
    rough = g.Div(g.Add(*(g.Abs(g.Sub(near[i], near[i + 2])) for i in (0, 1))), 2.0)
    n_inner = g.Max(g.ReduceSum(inner, keepdims=0), 1.0)
    dark, rough = (g.Div(g.ReduceSum(g.Mul(inner, x), keepdims=0), n_inner) for x in (g.Sub(1.0, here), rough))

    # The pick and the direction of each pull: x and y, `[N, 1]`.
    pick, place = ([g.Gather(name, np.array([axis]), axis=1) for axis in (0, 1)] for name in ("picks", "places"))
    way = [g.Sub(a, b) for a, b in zip(place, pick)]
    length = g.Sqrt(g.Add(*(g.Mul(part, part) for part in way)))
    cos, sin = (g.Div(part, g.Max(length, 1e-6)) for part in way)

    def beside(ahead, aside, start=pick):
        """Points ahead of the pick and to the right of the pull, in sides."""
        ahead, aside = (g.Mul("edge", part) for part in (ahead, aside))
        return (
            g.Add(start[0], g.Sub(g.Mul(ahead, cos), g.Mul(aside, sin))),
            g.Add(start[1], g.Add(g.Mul(ahead, sin), g.Mul(aside, cos))),
        )

    def along(distances, scale=(1, 0), start=pick):
        return look(faces, *beside(np.array([scale[0] * distances]), np.array([scale[1] * distances]), start))

    # Which cloth is held: the first that is seen behind the pick.
    around_turns = 2 * np.pi * np.arange(64) / 64
    circle = lambda radii: [np.array([np.outer(part(around_turns), radii).ravel()]) for part in (np.cos, np.sin)]
    fixed = lambda points: [g.Add(start, g.Mul("edge", part)) for start, part in zip(pick, points)]
    near_turns = [np.array([np.repeat(part(around_turns), 3)]) for part in (np.cos, np.sin)]
    near = look(faces, *fixed(circle([0.045, 0.07, 0.1])))
    mean = lambda x: g.ReduceMean(x, np.array([1]), keepdims=1)
    shown = lambda seen, face: g.number(g.Equal(seen, face))
    hold = np.array([0.015, 0.025, 0.035, 0.05, 0.07])
    behind = along(hold, (-1, 0))
    order = g.Where(g.Greater(behind, 0.0), np.arange(len(hold))[None, :], np.int64(len(hold) - 1))
    first = g.ReduceMin(order, np.array([1]), keepdims=1)
    is_held = g.Greater(g.ReduceMax(behind, np.array([1]), keepdims=1), 0.0)
    mostly = g.Add(1.0, g.number(g.Less(mean(shown(near, 1.0)), mean(shown(near, 2.0)))))
    own = g.Where(is_held, g.GatherElements(behind, first, axis=1), mostly)
    held = beside(g.Neg(g.Where(is_held, g.Gather(hold, first), 0.0)), 0.0)
    on = is_cloth(near)
    n_on = g.Max(g.ReduceSum(on, np.array([1]), keepdims=1), 1.0)
    lean = [g.ReduceSum(g.Mul(on, part), np.array([1]), keepdims=1) for part in near_turns]
    one_sided = g.Div(g.Sqrt(g.Add(*(g.Mul(part, part) for part in lean))), n_on)

    steps = np.arange(146)
    scan = 0.04 + 0.01 * steps
    # How far a line scan gets: a step for each point before the first that fails.
    numbers, end = np.array([steps.astype(np.float32)]), np.float32(len(steps))
    failed = lambda passes: g.ReduceMin(g.Where(passes, end, numbers), np.array([1]), keepdims=1)
    reach = lambda passes: g.Add(0.04, g.Mul(0.01, failed(passes)))
    seen_behind = along(scan, (-1, 0))
    own_behind = reach(g.Equal(seen_behind, own))
    covering = along(0.01 * np.arange(1, 41), (-1, 0))
    other_behind = mean(g.Mul(is_cloth(covering), g.number(g.Not(g.Equal(covering, own)))))
    back = beside(-0.06, 0.0)
    widths = [reach(g.Greater(along(scan, (0, side), back), 0.0)) for side in (-1, 1)]
    ahead = reach(g.Greater(along(scan), 0.0))
    everywhere = g.Concat(*(g.column(x, 0) for x in (columns, rows)), axis=0)
    coming = g.MatMul(g.Concat(cos, sin, axis=1), everywhere)
    coming = g.Sub(coming, g.Add(g.Mul(cos, pick[0]), g.Mul(sin, pick[1])))
    beyond = g.ReduceSum(is_cloth(coming), np.array([1]), keepdims=1)

    def farthest(point):
        offs = [g.Sub(g.column(rim, 0), part) for rim, part in zip((rim_x, rim_y), point)]
        return g.Sqrt(g.ReduceMax(squares(offs), np.array([1]), keepdims=1))

    squares = lambda offs: g.Add(*(g.Mul(off, off) for off in offs))
    apart = lambda point: g.Sqrt(squares([g.Sub(a, b) for a, b in zip(pick, point)]))
    offset = g.Concat(*(g.Sub(part, m) for part, m in zip(place, middle)), axis=1)
    widened = g.Sub(g.column(inside_px(g.Max(g.MatMul(offset, normals), support))), hull_px)

    of_cloth = [shares(count), shares(hull_px), g.Div(count, g.Max(hull_px, 1.0)), shares(lesser), dark, rough]
    every = g.Mul(length, 0.0)
    features = [g.Add(every, x) for x in of_cloth] + [
        mean(on),
        one_sided,
        mean(is_cloth(look(faces, *fixed(circle([0.18]))))),
        relative(apart(center)),
        relative(apart(middle)),
        relative(farthest(pick)),
        shares(patches(g, face_map, held, own)),
        mean(shown(near, own)),
        own_behind,
        other_behind,
        shares(beyond),
        ahead,
        g.Max(*widths),
        relative(farthest(place)),
        shares(widened),
        relative(length),
    ]
    features = g.Concat(*features, axis=1)

    # The picture around the pick, turned to the pull.
    fine = SPAN / (CELLS * SAMPLES) * (np.arange(CELLS * SAMPLES) + 0.5)
    square = lambda part: g.Reshape(g.Expand(part, np.array([len(fine)] * 2)), np.array([1, -1]))
    index = at(*beside(square((fine - (SPAN - AHEAD))[None, :]), square((fine - SPAN / 2)[:, None])))
    seen, dark = g.Gather(faces, index), g.Gather(darks, index)
    cells = np.array([-1, 1, CELLS * SAMPLES, CELLS * SAMPLES])
    layers = [shown(seen, own), g.Mul(is_cloth(seen), g.number(g.Not(g.Equal(seen, own)))), dark]
    windows = g.Concat(*(g.Reshape(layer, cells) for layer in layers), axis=1)
    windows = g.AveragePool(windows, kernel_shape=[SAMPLES, SAMPLES], strides=[SAMPLES, SAMPLES])
    out = [g.Sub(a, b) for a, b in zip(pick, center)]
    outward = g.Add(g.Mul(out[0], cos), g.Mul(out[1], sin))
    outward = g.GreaterOrEqual(outward, g.Mul(apart(center), np.cos(np.radians(OUTWARD_DEG))))
    return features, windows, outward


def patches(g, face_map, held, own):
    """Returns the area of the patch of one face that hangs together with each held point, `[N, 1]`, square pixels."""
    steps = np.array([PATCH_STEP] * 2)
    face_map = g.Slice(face_map, np.array([1, 1]), np.array([END, END]), np.array([0, 1]), steps)
    whole, flat = g.Shape(face_map), np.array([-1])
    shape = g.Concat(np.array([1, 1]), whole, axis=0)
    n_cells = g.ReduceProd(whole, keepdims=0)
    numbers = g.Range(np.int64(0), n_cells, np.int64(1))
    width = g.Gather(whole, np.int64(1))
    sizes = []
    for face in (1.0, 2.0):
        mask = g.Reshape(g.number(g.Equal(face_map, face)), flat)
        on = g.Cast(mask, to=TensorProto.BOOL)
        labels = g.Where(on, numbers, np.int64(0))
        # Each cell takes the largest label beside it, tells it to the cell of its label, and takes that one's.
        for _ in range(PATCH_ROUNDS):
            plane = g.Reshape(g.number(labels), shape)
            across = g.MaxPool(plane, kernel_shape=[1, 3], strides=[1, 1], pads=[0, 1, 0, 1])
            down = g.MaxPool(plane, kernel_shape=[3, 1], strides=[1, 1], pads=[1, 0, 1, 0])
            spread = g.Max(across, down)
            spread = g.Where(on, g.Cast(g.Reshape(spread, flat), to=TensorProto.INT64), np.int64(0))
            labels = g.ScatterElements(spread, labels, spread, axis=0, reduction="max")
            labels = g.Where(on, g.Gather(labels, labels), np.int64(0))
        counts = g.ScatterElements(g.Mul(mask, 0.0), labels, mask, axis=0, reduction="add")
        size = g.Reshape(g.Mul(mask, g.Gather(counts, labels)), shape)
        size = g.MaxPool(size, kernel_shape=[3, 3], strides=[1, 1], pads=[1] * 4)
        sizes.append(g.Reshape(size, flat))
    x, y = (g.Cast(g.Floor(g.Div(part, float(PATCH_STEP))), to=TensorProto.INT64) for part in held)
    limits = [g.Sub(g.Gather(whole, np.int64(axis)), np.int64(1)) for axis in (1, 0)]
    x, y = (g.Min(g.Max(part, np.int64(0)), limit) for part, limit in zip((x, y), limits))
    index = g.Add(g.Mul(y, width), x)
    upper, under = (g.Gather(size, index) for size in sizes)
    return g.Mul(g.Where(g.Equal(own, 1.0), upper, under), float(PATCH_STEP**2))


def estimated(g, weights, features, windows):
    """Returns the gains `[N]`: the mean of all networks over the windows and their mirror images."""
    weight = lambda name: g.constant(weights[name], name)
    scaled = g.Div(g.Sub(features, weight("mean")), weight("deviation"))
    scaled = g.Clip(scaled, -float(LIMIT), float(LIMIT))
    mirrored = g.Slice(windows, np.array([-1]), np.array([-END]), np.array([2]), np.array([-1]))
    gains = []
    for network in range(NETWORKS):
        for image in (windows, mirrored):
            for depth, (_, size) in enumerate(CONVOLUTIONS):
                kernels, bias = (weight(f"{network}.convolution.{depth}.{part}") for part in ("kernels", "bias"))
                image = g.Conv(image, kernels, bias, strides=[2, 2], dilations=[1, 1], pads=[size // 2] * 4)
                image = g.Relu(image)
            values = g.Concat(g.Flatten(image), scaled, axis=1)
            for depth in range(2):
                values = g.Relu(values) if depth else values
                values = g.Gemm(values, *(weight(f"{network}.layer.{depth}.{part}") for part in ("matrix", "bias")))
            gains.append(values)
    return g.Reshape(g.Mean(*gains), np.array([-1]))


def model(weights, about):
    """Builds the network; without weights, one that returns what is measured."""
    g = Graph()
    features, windows, outward = measured(g)
    if weights:
        values = g.Where(g.Reshape(outward, np.array([-1])), estimated(g, weights, features, windows), -1.0)
        outputs = {"values": (values, ["N"])}
    else:
        outputs = {"features": (features, ["N", len(NAMES)]), "windows": (windows, ["N", 3, CELLS, CELLS])}
    g.nodes += [helper.make_node("Identity", [source], [name]) for name, (source, _) in outputs.items()]
    info = lambda name, shape: helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)
    # Short names: the file is part of the program.
    short = {name: name if weights and name in weights else f"c{at}" for at, name in enumerate(g.constants)}
    for node in g.nodes:
        node.input[:] = [short.get(name, name) for name in node.input]
    graph = helper.make_graph(
        g.nodes,
        "smoother",
        [info(name, shape) for name, shape in INPUTS.items()],
        [info(name, shape) for name, (_, shape) in outputs.items()],
        [numpy_helper.from_array(value, short[name]) for name, value in g.constants.items()],
    )
    made = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)], ir_version=9, producer_name="fabc")
    helper.set_model_props(made, {"about": about})
    onnx.checker.check_model(made, full_check=True)
    return made


def weights_of(network):
    found = {tensor.name: numpy_helper.to_array(tensor) for tensor in network.graph.initializer}
    return {name: value for name, value in found.items() if name in ("mean", "deviation") or "." in name}


