"""What stands around the cup: the table top (its top is the plane y = 0) and the curved backdrop behind it."""

import numpy as np

import wood

HALF, CORNER, EDGE, THICK = 7.0, 1.2, 0.16, 0.75  # half side, radius of the corners, of the edge, thickness (m)


def rounded_square(half, corner, per_corner=12):
    """Outline (#P by 2) of a square with round corners, counter-clockwise in (x, z), and its outward normals."""
    points, normals = [], []
    for k in range(4):
        for angle in np.linspace(0, np.pi / 2, per_corner + 1) + k * np.pi / 2:
            n = np.array([np.cos(angle), np.sin(angle)])
            middle = (half - corner) * np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])[k]
            points.append(middle + corner * n)
            normals.append(n)
    return np.array(points), np.array(normals)


def table():
    """Vertices, triangles and texture coordinates of the closed slab."""
    outline, normals = rounded_square(HALF, CORNER)
    count = len(outline)
    turn = np.linspace(0, np.pi / 2, 9)
    inset = [(0.35, 0.0), (EDGE, 0.0)] + [(EDGE * (1 - np.sin(a)), -EDGE * (1 - np.cos(a))) for a in turn[1:]]
    inset += [(d, -THICK - h) for d, h in inset[::-1]]
    rings = [np.stack([outline[:, 0] - d * normals[:, 0], np.full(count, h), outline[:, 1] - d * normals[:, 1]], 1)
             for d, h in inset]
    vertices = np.concatenate([*rings, [[0, 0, 0], [0, -THICK, 0]]])
    triangles = []
    for k in range(count):
        k1 = (k + 1) % count
        for j in range(len(rings) - 1):
            a, b, c, d = j * count + k, j * count + k1, (j + 1) * count + k1, (j + 1) * count + k
            triangles += [(a, b, c), (a, c, d)]
        last = (len(rings) - 1) * count
        triangles += [(len(vertices) - 2, k1, k), (len(vertices) - 1, last + k, last + k1)]
    # Planks run along x. The texture lies on the top and is carried on over the edge and down the side.
    down = -vertices[:, 1]
    away = np.zeros((len(vertices), 2))
    away[:-2] = np.tile(normals, (len(rings), 1)) * down[:-2, None]
    flat = vertices[:, [0, 2]] + away
    uv = np.stack([flat[:, 0] / wood.TILE[1], flat[:, 1] / wood.TILE[0] + 0.5 / wood.PLANKS], axis=1)
    return vertices, np.array(triangles), uv


def backdrop():
    """Vertices and triangles of a sheet that rises behind the table in one curve, bent around it."""
    floor, radius, bend, top = -6.0, 17.0, 7.0, 22.0
    path = [(2.0, floor), (radius - bend, floor)]
    path += [(radius - bend + bend * np.sin(a), floor + bend * (1 - np.cos(a))) for a in np.linspace(0, np.pi / 2, 17)[1:]]
    path += [(radius, y) for y in np.linspace(floor + bend, top, 6)[1:]]
    angles = np.radians(np.linspace(150, 390, 61))  # from +x over −z to −x; open towards +z
    vertices = np.array([(r * np.cos(a), y, r * np.sin(a)) for a in angles for r, y in path])
    n, triangles = len(path), []
    for i in range(len(angles) - 1):
        for j in range(n - 1):
            a, b, c, d = i * n + j, i * n + j + 1, (i + 1) * n + j + 1, (i + 1) * n + j
            triangles += [(a, b, c), (a, c, d)]
    return vertices, np.array(triangles)
