"""The ball of configs/company.yaml: radius 0.3 m, standing on y = 0 around the y axis, in six patches; opposite ones are
one part: `x`, `y` or `z`. `python3 make.py` writes ball.glb beside this file; `--check` compares instead."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import files
import generator
import lattice

RADIUS = 0.3  # m
CELLS = 20  # along each side of a patch
COLORS = {"x": (0.62, 0.10, 0.06), "y": (0.75, 0.68, 0.55), "z": (0.80, 0.45, 0.08)}


def ball():
    """Vertices (#V by 3) and, for each part, triangles (counter-clockwise outward): a cube's surface in equal angles."""
    nodes, sides = lattice.boundary((CELLS, CELLS, CELLS))
    ways = np.tan(np.pi / 4 * (2 * nodes / CELLS - 1))
    points = RADIUS * (ways / np.linalg.norm(ways, axis=1, keepdims=True) + (0, 1, 0))
    return points, dict(zip(COLORS, sides))


def make():
    points, triangles = ball()
    parts = [{"name": name, "positions": points, "triangles": triangles[name], "color": color, "metallic": 0.0,
              "roughness": 0.3} for name, color in COLORS.items()]
    return {"ball.glb": files.glb_bytes("ball", parts, generator="assets/ball/make.py")}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes ball.glb.")
