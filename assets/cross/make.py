"""A jack: six round arms along three axes, 1 m high, standing on the ends of three of them. One of the upper three is its
head, which looks to +z; the axis is x = z = 0, the feet stand on y = 0. `python3 make.py` writes cross.glb beside this
file; `--check` compares instead."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import character
import generator
import sculpt
from face import ellipse, Face, lips

CELL = 0.0155  # m
LENGTH, RADIUS = 0.60, 0.100  # of an arm, from the middle to its ball
BALL, HEAD = 0.145, 0.185  # radii of the balls at the ends
SOLE = 0.03  # cut off the feet, so that they stand
MIDDLE = LENGTH / np.sqrt(3) + BALL - SOLE  # height
LOOKS = {
    **character.FACE, "core": ((0.8, 0.74, 0.62), 0.25), "red": ((0.55, 0.022, 0.02), 0.25),
    "teal": ((0.02, 0.26, 0.28), 0.25), "yellow": ((0.82, 0.44, 0.03), 0.25), "head": ((0.8, 0.53, 0.31), 0.3),
    "hand": ((0.82, 0.79, 0.72), 0.3), "foot": ((0.06, 0.04, 0.055), 0.2), "iris": ((0.14, 0.05, 0.018), 0.06),
    "brow": ((0.05, 0.022, 0.01), 0.25),
}
# The axes, all as steep: upper ends towards +z (the head's) and 120 degrees to both sides of it.
TURNS = np.radians((90, 210, 330))
AXES = np.stack([np.sqrt(2 / 3) * np.cos(TURNS), np.full(3, np.sqrt(1 / 3)), np.sqrt(2 / 3) * np.sin(TURNS)], axis=1)


def shape(p):
    q = p - (0, MIDDLE, 0)
    d = np.linalg.norm(q, axis=1) - 0.14
    for k, axis in enumerate(AXES):
        d = sculpt.union(d, sculpt.capsule(q, -LENGTH * axis, LENGTH * axis, RADIUS), 0.12)
        for end in (-1, 1):
            radius = HEAD if k == 0 and end == 1 else BALL
            d = sculpt.union(d, np.linalg.norm(q - end * LENGTH * axis, axis=1) - radius, 0.06)
    return sculpt.common(d, -p[:, 1], 0.02)


def beyond(axis, distance):
    """Negative where a point is farther along the axis than this."""
    return lambda p: distance - (p - (0, MIDDLE, 0)) @ axis


def make():
    vertices, triangles = sculpt.surface(shape, (-0.70, -0.04, -0.70), (0.70, 1.10, 0.72), CELL)
    body = vertices, triangles, np.full(len(triangles), "core", dtype=object)
    for axis, name in zip(AXES, ("red", "teal", "yellow")):
        for end in (-1, 1):
            body = sculpt.paint(shape, *body, beyond(end * axis, 0.185), name)
            last = "foot" if end < 0 else "head" if name == "red" else "hand"
            body = sculpt.paint(shape, *body, beyond(end * axis, LENGTH - (0.125 if last == "head" else 0.085)), last)

    ahead = np.array([0, np.sin(np.radians(12)), np.cos(np.radians(12))])
    up = np.array([0, ahead[2], -ahead[1]])
    face = Face(sculpt.chart(shape, (0, MIDDLE, 0) + LENGTH * AXES[0] + 0.3 * ahead, (1, 0, 0), up))
    parts = []
    for side in (-1, 1):
        parts += face.eye(0.060 * side, 0.030, 0.049, 0.066, 0.020, -0.08 * side, look=(-0.12 * side, -0.02), around=40)
        parts.append(("brow", *face.brow(side, 0.060, 0.034, lambda t: 0.111 + 0.008 * (1 - t**2), 0.0085)))
        parts.append(("blush", *face.dome(ellipse(0.113 * side, -0.040, 0.024, 0.017), 0.0018, None, 6.0, 0.002, 8, 32)))

    mouth = lips(0.056, -0.066, 0.010, 0.050, 0.016, 0.056)
    parts.append(("mouth", *face.dome(mouth, 0.002, None, 10.0, 0.003, 12, 56)))
    parts.append(("tongue", *face.dome(ellipse(0, -0.097, 0.026, 0.014), 0.006, None, 3.0, 0.001, 8, 32)))
    return {"cross.glb": character.glb("cross", "assets/cross/make.py", body, parts, LOOKS)}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes cross.glb.")
