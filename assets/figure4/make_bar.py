"""The bar of Figure 4: a closed box of 3/16 m by 1 m by 3/16 m, standing on y = 0 around the y axis, drawn with a grid fine
enough to be twisted. `python3 make_bar.py` writes bar.ply beside this file; `--check` compares instead."""

import pathlib
import sys

import numpy as np

SIZE = np.array([0.1875, 1.0, 0.1875])  # m; multiples of the cells are exact in binary
CELLS = (6, 32, 6)


def box():
    """Vertices (#V by 3) and triangles (#F by 3, counter-clockwise outward) of the boundary of the lattice."""
    index, points, triangles = {}, [], []

    def vertex(node):
        if node not in index:
            index[node] = len(points)
            points.append((np.array(node) / CELLS - (0.5, 0.0, 0.5)) * SIZE)
        return index[node]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, CELLS[axis]):
            for i in range(CELLS[u]):
                for j in range(CELLS[v]):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        node = [0, 0, 0]
                        node[axis], node[u], node[v] = side, i + di, j + dj
                        corners.append(vertex(tuple(node)))
                    if side == 0:
                        corners.reverse()
                    a, b, c, d = corners
                    triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    return np.array(points), np.array(triangles)


def ply(points, triangles):
    lines = ["ply", "format ascii 1.0", f"element vertex {len(points)}", "property double x", "property double y",
             "property double z", f"element face {len(triangles)}", "property list uchar int vertex_indices",
             "end_header"]
    lines += [" ".join(f"{x:.7g}" for x in point + 0.0) for point in points]
    lines += [f"3 {a} {b} {c}" for a, b, c in triangles]
    return "\n".join(lines) + "\n"


def main():
    path = pathlib.Path(__file__).parent / "bar.ply"
    text = ply(*box())
    if "--check" in sys.argv[1:]:
        if path.read_text() != text:
            sys.exit(f"{path.name} is not what make_bar.py makes")
    else:
        path.write_text(text)


if __name__ == "__main__":
    main()
