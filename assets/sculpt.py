"""Bodies from signed distances: functions of points (#P by 3) that are negative inside, joined smoothly and turned into a
closed surface of even triangles, whose parts are painted along sharp borders."""

import numpy as np

from surface import quads_to_triangles


def union(a, b, blend):
    """Distances of both together; the seam is rounded over `blend` metres."""
    h = np.maximum(blend - np.abs(a - b), 0) / blend
    return np.minimum(a, b) - h**3 * blend / 6


def minus(a, b, blend):
    """Distances of a without b; the edge is rounded over `blend` metres."""
    return -union(-a, b, blend)


def common(a, b, blend):
    """Distances of what is in both; the edge is rounded over `blend` metres."""
    return -union(-a, -b, blend)


def capsule(p, a, b, radius):
    """A round bar from a to b."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    t = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return np.linalg.norm(p - a - t[:, None] * (b - a), axis=1) - radius


def ellipsoid(p, centre, radii):
    """Nearly the distance of an ellipsoid; exact on it."""
    q = (p - np.asarray(centre)) / radii
    k0, k1 = np.linalg.norm(q, axis=1), np.linalg.norm(q / radii, axis=1)
    return np.where(k1 > 1e-9, k0 * (k0 - 1) / np.maximum(k1, 1e-9), -np.min(radii))


def box(p, centre, half, radius):
    """A box of these half sides, its edges rounded."""
    q = np.abs(p - np.asarray(centre)) - np.asarray(half) + radius
    return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0) - radius


def polygon(p, corners):
    """Distances (#P) of points of the plane (#P by 2) to a polygon (#C by 2)."""
    corners = np.asarray(corners, float)
    x, y = np.ascontiguousarray(np.transpose(p))
    nearest, inside = np.full(len(x), np.inf), np.zeros(len(x), bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0)):
        dx, dy, px, py = bx - ax, by - ay, x - ax, y - ay
        t = np.clip((px * dx + py * dy) / (dx * dx + dy * dy), 0, 1)
        nearest = np.minimum(nearest, (px - t * dx)**2 + (py - t * dy)**2)
        if dy != 0:
            inside ^= ((y < ay) != (y < by)) & (px < py * dx / dy)
    return np.where(inside, -1, 1) * np.sqrt(nearest)


def slab(across, along, radius):
    """A plate: `across` is the distance of its outline, `along` that of its two sides; edges rounded by the radius."""
    q = np.stack([across + radius, along + radius], axis=1)
    return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0) - radius


def gradient(value, p, step=1e-5):
    return np.stack([(value(p + step * d) - value(p - step * d)) / (2 * step) for d in np.eye(3)], axis=1)


def project(shape, p, limit, steps=1):
    """Moves points onto the surface along the gradient (Newton), at most `limit` metres a step."""
    for _ in range(steps):
        g = gradient(shape, p)
        p = p - np.clip(shape(p) / np.maximum(np.einsum("ij,ij->i", g, g), 0.05), -limit, limit)[:, None] * g
    return p


# The twelve edges of a cell: its two corners, as offsets.
EDGES = [(np.array(a), np.array(a) + np.eye(3, dtype=int)[axis]) for axis in range(3)
         for a in np.ndindex(2, 2, 2) if a[axis] == 0]


def nets(shape, low, high, cell):
    """Vertices and quadrilaterals of the surface of a shape between the corners: surface nets (Gibson 1998)."""
    size = np.ceil((high - low) / cell).astype(int) + 2
    axes = [low[k] + cell * np.arange(size[k]) for k in range(3)]
    value = np.empty(size)
    for i, x in enumerate(axes[0]):
        y, z = np.meshgrid(axes[1], axes[2], indexing="ij")
        value[i] = shape(np.stack([np.full(y.size, x), y.ravel(), z.ravel()], axis=1)).reshape(y.shape)
    inside = value < 0
    assert not any(np.take(inside, end, axis).any() for axis in range(3) for end in (0, -1)), "the shape leaves its box"

    cells = size - 1
    total, count = np.zeros((*cells, 3)), np.zeros(cells, int)
    for a, b in EDGES:
        at = [tuple(slice(o[k], o[k] + cells[k]) for k in range(3)) for o in (a, b)]
        va, vb = value[at[0]], value[at[1]]
        crossed = inside[at[0]] != inside[at[1]]
        t = np.where(crossed, va / np.where(crossed, va - vb, 1), 0)
        total += np.where(crossed[..., None], a + t[..., None] * (b - a), 0)
        count += crossed
    active = count > 0
    index = np.full(cells, -1)
    index[active] = np.arange(active.sum())
    where = np.argwhere(active)
    vertices = low + cell * (where + total[active] / count[active][:, None])

    quads = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        a = [slice(1, -1)] * 3
        b = [slice(1, -1)] * 3
        a[axis], b[axis] = slice(0, -1), slice(1, None)
        first, second = inside[tuple(a)], inside[tuple(b)]
        for flip in (False, True):
            node = np.argwhere(first & ~second if not flip else ~first & second)
            node[:, [u, v]] += 1
            corner = []
            for du, dv in ((-1, -1), (0, -1), (0, 0), (-1, 0)):
                c = node.copy()
                c[:, u] += du
                c[:, v] += dv
                corner.append(index[tuple(c.T)])
            quads.append(np.stack(corner[::-1] if flip else corner, axis=1))
    return vertices, np.concatenate(quads)


def surface(shape, low, high, cell, rounds=12):
    """Vertices and triangles of the closed surface of a shape between the corners low and high, from cells of this size,
    evened out on the shape."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    # Shifted so that no flat side of a model lies in a plane of the grid; where a saddle of the shape lies in a side of a
    # cell, two sheets meet in an edge: then another shift.
    for shift in (0.4567, 0.1579, 0.7283):
        vertices, quads = nets(shape, low - shift * cell, high, cell)
        ends = np.concatenate([quads[:, [k, (k + 1) % 4]] for k in range(4)])
        if len(np.unique(ends, axis=0)) == len(ends):
            break

    edges = np.unique(np.sort(np.concatenate([quads[:, [k, (k + 1) % 4]] for k in range(4)]), axis=1), axis=0)
    edges = np.concatenate([edges, edges[:, ::-1]])
    degree = np.bincount(edges[:, 0], minlength=len(vertices))
    vertices = project(shape, vertices, cell / 2, 3)
    for _ in range(rounds):
        mean = np.stack([np.bincount(edges[:, 0], vertices[edges[:, 1], k], len(vertices)) for k in range(3)], axis=1)
        vertices = project(shape, vertices + 0.5 * (mean / degree[:, None] - vertices), cell / 2)
    vertices = project(shape, vertices, cell / 2, 4)
    return vertices, quads_to_triangles(vertices, quads)


def paint(shape, vertices, triangles, names, value, name, of=None):
    """Gives triangles (of the part `of`, or all) where value(points) < 0 the part `name`, and cuts the surface along the
    border. Returns vertices, triangles and names."""
    ends = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    lengths = np.linalg.norm(vertices[ends[:, 0]] - vertices[ends[:, 1]], axis=1)
    length, shortest = lengths.mean(), np.full(len(vertices), np.inf)  # of all edges, and of those of each vertex
    np.minimum.at(shortest, ends[:, 0], lengths)
    v = value(vertices)
    # Vertices near the border move onto it, so that no slivers are cut.
    near = np.flatnonzero(np.abs(v) < length)
    for _ in range(4):
        p = vertices[near]
        g, n = gradient(value, p), gradient(shape, p)
        n /= np.maximum(np.linalg.norm(n, axis=1), 1e-9)[:, None]
        g -= np.einsum("ij,ij->i", g, n)[:, None] * n
        slope = np.einsum("ij,ij->i", g, g)
        move = -(v[near] / np.maximum(slope, 1e-12))[:, None] * g
        close = (np.linalg.norm(move, axis=1) < 0.3 * shortest[near]) & (slope > 1e-4)
        vertices = vertices.copy()
        vertices[near[close]] = project(shape, p[close] + move[close], length)
        v = value(vertices)
        near = near[close]
    v[near] = 0.0
    side = np.sign(v).astype(int)

    vertices, new = list(vertices), {}

    def cut(a, b):
        key = (min(a, b), max(a, b))
        if key not in new:
            t = v[key[0]] / (v[key[0]] - v[key[1]])
            new[key] = len(vertices)
            vertices.append(vertices[key[0]] + t * (vertices[key[1]] - vertices[key[0]]))
        return new[key]

    out, labels = [], []

    def emit(a, b, c, s, old):
        out.append((a, b, c))
        labels.append(name if s < 0 and (of is None or old == of) else old)

    for (a, b, c), old in zip(triangles.tolist(), names):
        s = [side[a], side[b], side[c]]
        if min(s) >= 0 or max(s) <= 0:
            # With all three on the border, the middle decides.
            emit(a, b, c, sum(s) or value(np.mean([vertices[a], vertices[b], vertices[c]], axis=0)[None])[0], old)
            continue
        while True:  # turn it so that a is the zero, or the only one of its sign
            if s[0] == 0 or (0 not in s and s[1] == s[2]):
                break
            a, b, c, s = b, c, a, [s[1], s[2], s[0]]
        if s[0] == 0:
            m = cut(b, c)
            emit(a, b, m, s[1], old)
            emit(a, m, c, s[2], old)
        else:
            p, q = cut(a, b), cut(a, c)
            emit(a, p, q, s[0], old)
            if np.linalg.norm(vertices[p] - vertices[c]) < np.linalg.norm(vertices[q] - vertices[b]) - 1e-9:
                emit(p, b, c, s[1], old)
                emit(p, c, q, s[1], old)
            else:
                emit(p, b, q, s[1], old)
                emit(b, c, q, s[1], old)
    return np.array(vertices), np.array(out), np.array(labels, dtype=object)


def chart(shape, origin, right, up):
    """Chart of a surface for face.Face: rays from outside against right x up, from the plane through `origin`."""
    origin, right, up = (np.asarray(x, float) for x in (origin, right, up))
    ahead = np.cross(right, up)

    def frame(u, v):
        u, v = np.broadcast_arrays(u, v)
        p = origin + u.reshape(-1, 1) * right + v.reshape(-1, 1) * up
        for _ in range(200):
            d = shape(p)
            p = p - np.clip(d, -0.05, 0.05)[:, None] * ahead * 0.8
            if np.abs(d).max() < 1e-10:
                break
        assert np.abs(d).max() < 1e-6, "part of a face misses the body"
        n = gradient(shape, p)
        n /= np.linalg.norm(n, axis=1)[:, None]
        return p.reshape(*u.shape, 3), n.reshape(*u.shape, 3)
    return frame
