"""Closed triangle surfaces: what makes one fit to be a body."""

import numpy as np


def signed_volume(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def quads_to_triangles(vertices, quads):
    """Splits quads (#Q by 4) along their shorter diagonal."""
    d02 = np.linalg.norm(vertices[quads[:, 0]] - vertices[quads[:, 2]], axis=1)
    d13 = np.linalg.norm(vertices[quads[:, 1]] - vertices[quads[:, 3]], axis=1)
    first = (d02 <= d13 + 1e-12)[:, None]
    one = np.where(first, quads[:, [0, 1, 2]], quads[:, [0, 1, 3]])
    two = np.where(first, quads[:, [0, 2, 3]], quads[:, [1, 2, 3]])
    return np.stack([one, two], axis=1).reshape(-1, 3)


def verify(vertices, triangles, genus):
    """Asserts that a surface is closed, manifold, connected, oriented outward and of the given genus; returns its volume."""
    count = len(vertices)
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    keys = edges[:, 0] * count + edges[:, 1]
    back = edges[:, 1] * count + edges[:, 0]
    assert np.isfinite(vertices).all(), "non-finite vertex"
    assert len(np.unique(keys)) == len(keys), "an edge is used twice in one direction: not oriented or not manifold"
    assert np.array_equal(np.sort(keys), np.sort(back)), "open edges"
    assert len(np.unique(triangles)) == count, "vertices without triangles"
    assert len(np.unique(vertices, axis=0)) == count, "two vertices at one place"
    label = np.arange(count)
    while True:
        least = label.copy()
        np.minimum.at(least, edges[:, 0], label[edges[:, 1]])
        if np.array_equal(least, label):
            break
        label = least
    assert label.max() == 0, "more than one component"
    after = np.roll(triangles, 1, axis=1).T.reshape(-1)  # third corner of each directed edge's triangle
    order = np.argsort(keys)
    onward = order[np.searchsorted(keys[order], edges[:, 0] * count + after)]  # next edge around the first vertex
    turns, walked = np.ones(len(edges), int), onward
    while not np.array_equal(walked, np.arange(len(edges))):
        active = walked != np.arange(len(edges))
        turns[active] += 1
        walked = np.where(active, onward[walked], walked)
    assert np.array_equal(turns, np.bincount(edges[:, 0])[edges[:, 0]]), "two fans of triangles meet in one vertex"
    euler = count - len(edges) // 2 + len(triangles)
    assert euler == 2 - 2 * genus, f"Euler number {euler}, wanted {2 - 2 * genus}"
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    assert area.min() > 1e-9, f"degenerate triangle of {area.min():.2g} m2"
    volume = signed_volume(vertices, triangles)
    assert volume > 0, "oriented inward"
    return volume
