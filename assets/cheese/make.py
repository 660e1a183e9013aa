"""Cheesy: a wedge of cheese on end, 1 m high, standing on its rind of red wax. It looks to +z; the axis is x = z = 0, the
foot stands on y = 0. `python3 make.py` writes cheese.glb beside this file; `--check` compares instead."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import character
import generator
import sculpt
from face import ellipse, Face, lips

CELL = 0.0145  # m
OUTLINE = [(-0.39, 0.0), (0.39, 0.0), (0.075, 0.88), (-0.075, 0.88)]  # of the front, less the round edges
ROUND = 0.105
FRONT = [(-0.27, 0.27, 0.078), (0.275, 0.31, 0.060), (0.125, 0.235, 0.036), (0.165, 0.885, 0.050), (-0.135, 0.225, 0.028)]
BACK = [(0.03, 0.62, 0.115), (-0.24, 0.33, 0.090), (0.22, 0.29, 0.070), (0.15, 0.83, 0.060), (-0.14, 0.84, 0.040), (-0.02, 0.30, 0.045)]
SIDES = [(1, 0.62, 0.02, 0.105), (1, 0.34, 0.13, 0.085), (1, 0.30, -0.11, 0.060), (-1, 0.52, -0.06, 0.100), (-1, 0.28, 0.05, 0.060)]
NOTCH = (-0.235, 0.885, 0.16, 0.125)


def balls():
    """Centres and radii (#H by 4) of the balls cut out of the cheese, each a little outside its side."""
    found = [NOTCH]
    for side, holes in ((1, FRONT), (-1, BACK)):
        found += [(x, y, side * (0.285 - 0.085 * y + 0.3 * r), r) for x, y, r in holes]
    found += [(side * (0.50 - 0.358 * y + 0.3 * r), y, z, r) for side, y, z, r in SIDES]
    return np.array(found)


HOLES = balls()
LOOKS = {
    **character.FACE, "cheese": ((0.82, 0.45, 0.05), 0.4), "hole": ((0.66, 0.27, 0.02), 0.5),
    "rind": ((0.48, 0.03, 0.02), 0.15), "iris": ((0.05, 0.17, 0.08), 0.06), "brow": ((0.25, 0.08, 0.012), 0.4),
}


def wedge(p):
    """The wedge without its holes: it narrows upwards to all sides; its foot is flat and spreads."""
    spread = 0.035 * np.clip((0.20 - p[:, 1]) / 0.20, 0, 1)**2
    front = sculpt.polygon(p[:, :2], OUTLINE) - ROUND - spread
    depth = 0.285 - 0.085 * p[:, 1]
    sides = np.abs(p[:, 2]) - depth - spread
    return sculpt.common(sculpt.slab(front, sides, 0.07), -p[:, 1], 0.05)


def cut(p):
    """Distance of the nearest hole's ball."""
    return np.min([np.linalg.norm(p - hole[:3], axis=1) - hole[3] for hole in HOLES], axis=0)


def shape(p):
    return sculpt.minus(wedge(p), cut(p), 0.03)


def rind(p):
    return p[:, 1] - 0.125 - 0.012 * np.sin(7 * np.arctan2(p[:, 0], p[:, 2]))


def make():
    vertices, triangles = sculpt.surface(shape, (-0.60, -0.05, -0.45), (0.60, 1.05, 0.45), CELL)
    names = np.full(len(triangles), "cheese", dtype=object)
    body = sculpt.paint(shape, vertices, triangles, names, rind, "rind")
    body = sculpt.paint(shape, *body, lambda p: cut(p) - 0.006, "hole", of="cheese")

    face, parts = Face(sculpt.chart(wedge, (0, 0.53, 0.5), (1, 0, 0), (0, 1, 0))), []
    for side in (-1, 1):
        parts += face.eye(0.098 * side, 0.095, 0.088, 0.118, 0.034, -0.08 * side, look=(-0.12 * side, -0.05))
        parts.append(("brow", *face.brow(side, 0.105, 0.068, lambda t: 0.245 + 0.016 * (1 - t**2) - 0.030 * t, 0.0155)))

    mouth = lips(0.105, -0.135, 0.022, 0.105, 0.030, 0.105)
    teeth = lips(0.062, -0.133, 0.012, 0.030, 0.030, 0.105)
    parts.append(("mouth", *face.dome(mouth, 0.003, None, 10.0, 0.003, 12, 64)))
    parts.append(("tongue", *face.dome(ellipse(0, -0.200, 0.050, 0.028), 0.0085, None, 3.0, 0.001, 8, 40)))
    parts.append(("teeth", *face.dome(teeth, 0.009, None, 6.0, 0.001, 8, 40)))
    return {"cheese.glb": character.glb("cheese", "assets/cheese/make.py", body, parts, LOOKS)}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes cheese.glb.")
