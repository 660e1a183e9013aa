"""What stands around the cup: the table top (its top is the plane y = 0) and the room's light."""

import numpy as np

import wood

HALF, CORNER, EDGE, THICK = 7.0, 1.2, 0.16, 0.75  # half side, radius of the corners, of the edge, thickness (m)
GLOW = (-0.50, 0.16, -0.85)  # direction in which the wall is brightest


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


def surroundings():
    """Radiance of the room in all directions (H by W by 3, linear): latitude and longitude, top +y, middle -z.

    A warm dusky room with a cool ceiling and a glow on the wall behind the cup, as the camera of the scene sees it.
    """
    height = 128
    theta = np.pi * (np.arange(height) + 0.5) / height
    phi = np.pi * ((np.arange(2 * height) + 0.5) / height - 1)
    way = np.stack(np.broadcast_arrays(np.sin(theta)[:, None] * np.sin(phi), np.cos(theta)[:, None],
                                       -np.sin(theta)[:, None] * np.cos(phi)), axis=-1)
    up = way[..., 1:2]
    wall, ceiling, floor = (np.array(c) for c in ((0.34, 0.27, 0.22), (0.42, 0.44, 0.48), (0.12, 0.08, 0.06)))
    room = np.where(up > 0, wall + (ceiling - wall) * np.maximum(up, 0)**0.8,
                    wall + (floor - wall) * np.minimum(1, -up / 0.45))
    middle = np.array(GLOW) / np.linalg.norm(GLOW)
    apart = np.sum((way - middle)**2, axis=-1, keepdims=True)
    return room + np.array([1.00, 0.66, 0.43]) * np.exp(-apart / 0.45**2)
