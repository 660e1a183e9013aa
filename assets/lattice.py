"""The boundary of a lattice of cells, for generators of boxes and of what is bent from them."""

import numpy as np


def boundary(cells):
    """Nodes (#V by 3, integers), and for each axis the triangles (#F by 3, counter-clockwise outward) of the two sides
    across it, with diagonals that alternate."""
    index, triangles = {}, ([], [], [])

    def vertex(node):
        return index.setdefault(node, len(index))

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, cells[axis]):
            for i in range(cells[u]):
                for j in range(cells[v]):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        node = [0, 0, 0]
                        node[axis], node[u], node[v] = side, i + di, j + dj
                        corners.append(vertex(tuple(node)))
                    if side == 0:
                        corners.reverse()
                    a, b, c, d = corners
                    triangles[axis].extend([(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)])
    return np.array(list(index)), tuple(np.array(of_axis) for of_axis in triangles)
