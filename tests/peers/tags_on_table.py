"""Draws AprilTags (36h11) on a table, seen by a known camera, with OpenCV.

Usage: tags_on_table.py FOLDER SEED. Writes FOLDER/tags.png, FOLDER/points.csv (what an arm would touch: the middles
of tags, in the base frame), and FOLDER/truth.json (the camera, and which place each of some pixels shows).
"""

import json
import sys
from pathlib import Path

import cv2
import numpy as np

SIZE = (640, 480)
K = np.array([[600.0, 0.0, 320.0], [0.0, 600.0, 240.0], [0.0, 0.0, 1.0]])
HEIGHT_M = 0.02
SIDE_M = 0.06
# Pixels of a tag as it is drawn, with a white rim of one cell; the black square is 8 of 10 cells.
CELL = 40
# Drawn this much larger, then averaged down: what a camera's pixels do.
FINER = 4


def main():
    folder, seed = Path(sys.argv[1]), int(sys.argv[2])
    chance = np.random.default_rng(seed)
    # A metre above the table, the picture's top away from the arm, tilted a little.
    down = np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    tilt, _ = cv2.Rodrigues(chance.uniform(-0.04, 0.04, 3))
    camera_from_base = tilt @ down
    lens = np.array([0.45, 0.0, HEIGHT_M + 1.0])
    # From (x, y, 1) on the table to the pixel.
    pixel_from_table = K @ np.column_stack(
        [camera_from_base[:, 0], camera_from_base[:, 1], camera_from_base @ (np.array([0, 0, HEIGHT_M]) - lens)]
    )
    table_from_pixel = np.linalg.inv(pixel_from_table)
    seen = lambda h, u, v: (lambda p: p[:2] / p[2])(h @ np.array([u, v, 1.0]))

    picture = np.full((SIZE[1] * FINER, SIZE[0] * FINER), 170, np.uint8)
    # Pixel (u, v) of the picture, whose first pixel spans 0 to 1, is column u * FINER - 0.5 of the finer array.
    finer = np.array([[FINER, 0, -0.5], [0, FINER, -0.5], [0, 0, 1.0]])
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    lines = ["u,v,x,y,z"]
    corners = [(0.0, 1.0), (0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]
    ids = chance.permutation(587)[:16]
    for index, number in enumerate(ids):
        share = np.array([0.12 + 0.76 * (index % 4) / 3, 0.12 + 0.76 * (index // 4) / 3])
        middle = seen(table_from_pixel, *(np.array([80, 0]) + 480 * share))
        turn = chance.uniform(0, 2 * np.pi)
        # The tag's own axes on the table, right and down as printed; seen from above, down is clockwise of right.
        right = SIDE_M * np.array([np.cos(turn), np.sin(turn)])
        below = SIDE_M * np.array([np.sin(turn), -np.cos(turn)])
        at = lambda s: middle + (s[0] - 0.5) * right + (s[1] - 0.5) * below
        tag = cv2.aruco.generateImageMarker(family, int(number), 8 * CELL)
        tag = cv2.copyMakeBorder(tag, CELL, CELL, CELL, CELL, cv2.BORDER_CONSTANT, value=255)
        # From the tag's array, whose black square spans CELL to 9 CELL, to the table.
        from_array = np.float64(
            [[s * 8 * CELL + CELL - 0.5 for s in corner] for corner in corners]
        )
        on_table = np.float64([at(corner) for corner in corners])
        array_to_table, _ = cv2.findHomography(from_array, on_table)
        warp = finer @ pixel_from_table @ array_to_table
        size = (picture.shape[1], picture.shape[0])
        drawn = cv2.warpPerspective(tag, warp, size, flags=cv2.INTER_LINEAR)
        where = cv2.warpPerspective(np.full_like(tag, 255), warp, size, flags=cv2.INTER_NEAREST)
        picture[where > 0] = drawn[where > 0]
        lines.append(f"tag{number},{middle[0]:.5f},{middle[1]:.5f},{HEIGHT_M}")
    small = cv2.resize(picture, SIZE, interpolation=cv2.INTER_AREA)
    noisy = np.clip(small + chance.normal(0, 2, small.shape), 0, 255).astype(np.uint8)
    cv2.imwrite(str(folder / "tags.png"), cv2.cvtColor(noisy, cv2.COLOR_GRAY2BGR))
    (folder / "points.csv").write_text("\n".join(lines) + "\n")
    pixels = [[80 + 480 * a, 480 * b] for a in (0.0, 0.5, 1.0) for b in (0.0, 0.5, 1.0)]
    truth = {
        "middle_m": [*seen(table_from_pixel, 320, 240), HEIGHT_M],
        "shown": [{"pixel": p, "base_m": [*seen(table_from_pixel, *p), HEIGHT_M]} for p in pixels],
    }
    (folder / "truth.json").write_text(json.dumps(truth))


main()
