"""Closed solids of which stages are built: pairs of vertices (#V by 3) and triangles (#F by 3, counter-clockwise outward)."""

import numpy as np


def corners_of_ears(outline):
    """Triangles (#P - 2 by 3) of a polygon (#P by 2) without crossings, against the clock: ears are cut off (Meisters 1975)."""
    p, left, triangles = np.asarray(outline, float), list(range(len(outline))), []

    def cross(a, b, c):
        return (b[0] - a[0]) * (c[..., 1] - a[1]) - (b[1] - a[1]) * (c[..., 0] - a[0])

    at = 0
    while len(left) > 3:
        for tried in range(len(left) + 1):
            assert tried < len(left), "the outline crosses itself"
            i, j, k = (left[(at + tried + n) % len(left)] for n in (0, 1, 2))
            a, b, c = p[i], p[j], p[k]
            others = p[[n for n in left if n not in (i, j, k)]]
            within = (cross(a, b, others) >= 0) & (cross(b, c, others) >= 0) & (cross(c, a, others) >= 0)
            if cross(a, b, c) > 1e-12 and not within.any():
                break
        triangles.append((i, j, k))
        left.remove(j)
        at = left.index(i) + 1
    return np.array(triangles + [tuple(left)])


def prism(outline, low, high):
    """An upright outline (#P by 2: x, y) pushed from z = low to z = high."""
    p = np.asarray(outline, float)
    x, y = p.T
    if np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) < 0:
        p = p[::-1]
    count, k = len(p), np.arange(len(p))
    k1 = (k + 1) % count
    caps = corners_of_ears(p)
    vertices = np.concatenate([np.column_stack([p, np.full(count, z)]) for z in (low, high)])
    sides = np.concatenate([np.stack([k, k1, k1 + count], 1), np.stack([k, k1 + count, k + count], 1)])
    return vertices, np.concatenate([caps[:, ::-1], caps + count, sides])


def plate(outline, low, high):
    """A lying outline (#P by 2: x, z) pushed from y = low to y = high."""
    vertices, triangles = prism(np.asarray(outline, float) * (1, -1), low, high)
    return vertices[:, [0, 2, 1]] * (1, 1, -1), triangles


def box(low, high):
    (x0, y0, z0), (x1, y1, z1) = low, high
    return prism([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], z0, z1)


def capped(rings, first, last):
    """Equal rings of points, one above the other, with a point that closes each end."""
    around = len(rings[0])
    vertices = np.concatenate([*rings, [first, last]])
    k = np.arange(around)
    k1, top = (k + 1) % around, (len(rings) - 1) * around
    first_end, last_end = np.full(around, len(vertices) - 2), np.full(around, len(vertices) - 1)
    triangles = [np.stack([first_end, k1, k], 1), np.stack([last_end, top + k, top + k1], 1)]
    for a in range(0, top, around):
        b = a + around
        triangles += [np.stack([a + k, a + k1, b + k1], 1), np.stack([a + k, b + k1, b + k], 1)]
    return vertices, np.concatenate(triangles)


def turned(profile, around=24, squash=(1, 1)):
    """A profile (#P by 2: radius, y) turned about the y axis, its ends on the axis; `squash` shrinks x and z."""
    profile = np.asarray(profile, float)
    if profile[0, 1] > profile[-1, 1]:
        profile = profile[::-1]
    turn = 2 * np.pi * np.arange(around) / around
    rings = [np.stack([r * np.sin(turn) * squash[0], np.full(around, y), r * np.cos(turn) * squash[1]], 1)
             for r, y in profile[1:-1]]
    return capped(rings, (0, profile[0, 1], 0), (0, profile[-1, 1], 0))


def ball(radius, rings=9, around=24, squash=(1, 1, 1)):
    """A ball about the origin, shrunk along x, y and z."""
    turn = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    profile = np.stack([radius * np.cos(turn), radius * squash[1] * np.sin(turn)], axis=1)
    return turned(profile, around, (squash[0], squash[2]))


def tube(points, radius, around=8):
    """A round bar along a line of points (#P by 3); radius: one, or one for each point."""
    p = np.asarray(points, float)
    radius = np.broadcast_to(radius, len(p))
    ways = np.gradient(p, axis=0)
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    side = np.cross(ways[0], np.eye(3)[np.argmin(np.abs(ways[0]))])
    turn = 2 * np.pi * np.arange(around) / around
    rings = []
    for middle, way, r in zip(p, ways, radius):
        side = side - side @ way * way
        side /= np.linalg.norm(side)
        up = np.cross(way, side)
        rings.append(middle + r * (np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * up))
    return capped(rings, p[0], p[-1])


def strip(line, half, top, low=-0.02):
    """A painted line on the ground along points (#P by 2: x, z), 2 `half` wide; top: its height (m), one or a function of x
    and z. It reaches down to `low` below that."""
    p = np.asarray(line, float)
    way = np.gradient(p, axis=0)
    normal = np.stack([-way[:, 1], way[:, 0]], axis=1) / np.linalg.norm(way, axis=1)[:, None]
    outline = np.concatenate([p + half * normal, (p - half * normal)[::-1]])
    vertices, triangles = plate(outline, low, 0.0)
    rise = top(vertices[:, 0], vertices[:, 2]) if callable(top) else top
    return vertices + np.stack([np.zeros(len(vertices)), np.broadcast_to(rise, len(vertices)), np.zeros(len(vertices))],
                               axis=1), triangles


def moved(solid, by=(0, 0, 0), heading_deg=0.0, scale=1.0):
    """A solid made larger, turned about the y axis and moved."""
    vertices, triangles = solid
    cos, sin = np.cos(np.radians(heading_deg)), np.sin(np.radians(heading_deg))
    turn = np.array([(cos, 0, sin), (0, 1, 0), (-sin, 0, cos)])
    return scale * vertices @ turn.T + by, triangles
