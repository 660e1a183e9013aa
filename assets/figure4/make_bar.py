"""The bar of Figure 4: a closed box of 3/16 m by 1 m by 3/16 m, standing on y = 0 around the y axis, drawn with a grid fine
enough to be twisted. `python3 make_bar.py` writes bar.ply beside this file; `--check` compares instead."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import lattice

SIZE = np.array([0.1875, 1.0, 0.1875])  # m; multiples of the cells are exact in binary
CELLS = (6, 32, 6)


def box():
    """Vertices (#V by 3) and triangles (#F by 3, counter-clockwise outward) of the boundary of the lattice."""
    nodes, sides = lattice.boundary(CELLS)
    return (nodes / CELLS - (0.5, 0.0, 0.5)) * SIZE, np.concatenate(sides)


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
