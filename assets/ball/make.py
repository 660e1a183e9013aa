"""The ball of configs/company.yaml: radius 0.3 m, standing on y = 0 around the y axis, in six patches; opposite ones are
one part: `x`, `y` or `z`. `python3 make.py` writes ball.glb beside this file; `--check` compares instead."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "teacup"))
import files

RADIUS = 0.3  # m
CELLS = 20  # along each side of a patch
COLORS = {"x": (0.62, 0.10, 0.06), "y": (0.75, 0.68, 0.55), "z": (0.80, 0.45, 0.08)}


def ball():
    """Vertices (#V by 3) and, for each part, triangles (counter-clockwise outward): a cube's surface in equal angles."""
    index, points, triangles = {}, [], {name: [] for name in COLORS}

    def vertex(node):
        if node not in index:
            index[node] = len(points)
            way = np.tan(np.pi / 4 * (2 * np.array(node) / CELLS - 1))
            points.append(RADIUS * (way / np.linalg.norm(way) + (0, 1, 0)))
        return index[node]

    for axis, name in enumerate(COLORS):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, CELLS):
            for i in range(CELLS):
                for j in range(CELLS):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        node = [0, 0, 0]
                        node[axis], node[u], node[v] = side, i + di, j + dj
                        corners.append(vertex(tuple(node)))
                    if side == 0:
                        corners.reverse()
                    a, b, c, d = corners
                    triangles[name] += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    return np.array(points), {name: np.array(of_part) for name, of_part in triangles.items()}


def main():
    points, triangles = ball()
    parts = [{"name": name, "positions": points, "triangles": triangles[name], "color": color, "metallic": 0.0,
              "roughness": 0.3} for name, color in COLORS.items()]
    data = files.glb_bytes("ball", parts, generator="assets/ball/make.py")
    path = pathlib.Path(__file__).parent / "ball.glb"
    if "--check" not in sys.argv[1:]:
        path.write_bytes(data)
        return
    committed, made = files.read_glb(path.read_bytes()), files.read_glb(data)
    for name in made:
        same = name in committed and all(a.shape == b.shape and np.allclose(a, b, rtol=0, atol=1e-6)
                                         for a, b in zip(committed[name], made[name]))
        if not same:
            sys.exit(f"part {name} of {path.name} is not what make.py makes")


if __name__ == "__main__":
    main()
