"""A beach ball with a face: diameter 1 m, standing on y = 0 around the y axis, in six gores about it; it looks to +z.
`python3 make.py` writes sphere.glb beside this file; `--check` compares instead."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import character
import generator
import lattice
import sculpt
from face import ellipse, Face, lips

RADIUS = 0.5  # m
CELLS = 44  # along each side of the six patches
GORES = {"red": 30, "blue": 150, "yellow": 270}  # degrees of their middles from +x towards +z; what is between is white
LOOKS = {
    **character.FACE, "white": ((0.8, 0.74, 0.62), 0.25), "red": ((0.55, 0.022, 0.02), 0.25),
    "blue": ((0.02, 0.12, 0.45), 0.25), "yellow": ((0.82, 0.44, 0.03), 0.25), "iris": ((0.04, 0.13, 0.3), 0.06),
    "brow": ((0.05, 0.022, 0.01), 0.25),
}


def shape(p):
    return np.linalg.norm(p - (0, RADIUS, 0), axis=1) - RADIUS


def gore(middle):
    """Negative within 30 degrees of this direction, beside the buttons at the poles."""
    sides = [np.array([np.sin(a), 0, -np.cos(a)]) for a in np.radians((middle + 30, middle - 30))]

    def value(p):
        button = 0.085 - np.hypot(p[:, 0], p[:, 2])
        return np.max([-(p @ sides[0]), p @ sides[1], button], axis=0)
    return value


def make():
    nodes, sides = lattice.boundary((CELLS, CELLS, CELLS))
    ways = np.tan(np.pi / 4 * (2 * nodes / CELLS - 1))
    vertices = RADIUS * (ways / np.linalg.norm(ways, axis=1, keepdims=True) + (0, 1, 0))
    triangles = np.concatenate(sides)
    body = vertices, triangles, np.full(len(triangles), "white", dtype=object)
    for name, middle in GORES.items():
        body = sculpt.paint(shape, *body, gore(middle), name)

    face, parts = Face(sculpt.chart(shape, (0, RADIUS, 0.7), (1, 0, 0), (0, 1, 0))), []
    for side in (-1, 1):
        parts += face.eye(0.090 * side, 0.085, 0.070, 0.095, 0.026, -0.08 * side, look=(-0.10 * side, 0.0))
        parts.append(("blush", *face.dome(ellipse(0.165 * side, -0.045, 0.040, 0.027), 0.0022, None, 6.0, 0.003, 8)))
        parts.append(("brow", *face.brow(side, 0.092, 0.052, lambda t: 0.212 + 0.018 * (1 - t**2) - 0.006 * t, 0.012)))

    mouth = lips(0.085, -0.090, 0.014, 0.085, 0.032, 0.085)
    parts.append(("mouth", *face.dome(mouth, 0.003, None, 10.0, 0.003, 12, 64)))
    parts.append(("tongue", *face.dome(ellipse(0, -0.142, 0.042, 0.024), 0.0085, None, 3.0, 0.001, 8, 40)))
    return {"sphere.glb": character.glb("sphere", "assets/sphere/make.py", body, parts, LOOKS)}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes sphere.glb.")
