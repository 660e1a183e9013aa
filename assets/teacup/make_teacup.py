#!/usr/bin/env python3
"""Makes teacup.glb, table.glb, wood.png and room.exr beside this file.

    make_teacup.py            writes them
    make_teacup.py --check    makes them in memory and compares with the files; exit code 1 when they differ
    make_teacup.py --output D writes into folder D

Needs Python 3 with NumPy. The same NumPy makes the same bytes every time; --check compares what the files hold (positions
to a micrometre, triangles exactly, all but one pixel in a thousand of wood.png, and room.exr to its last bit but one), so that another NumPy or zlib passes.
"""

import argparse
import pathlib
import sys

import numpy as np

import cup
import files
import stage
import wood


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
    assert area.min() > 1e-6, "degenerate triangle"
    volume = cup.signed_volume(vertices, triangles)
    assert volume > 0, "oriented inward"
    return volume


def make():
    """File name -> bytes."""
    parts, (vertices, triangles) = cup.make()
    volume = verify(vertices, triangles, genus=1)
    total = sum(len(part["triangles"]) for part in parts)
    height = vertices[:, 1].max()
    assert vertices[:, 1].min() == 0.0 and 0.9 <= height <= 1.0, "the cup does not stand on y = 0, or has a wrong height"
    assert 20000 <= total <= 45000, f"{total} triangles"
    print(f"cup: {total} triangles, body {len(triangles)} triangles, {len(vertices)} vertices, closed, genus 1, "
          f"volume {volume:.6f} m3, height {height:.4f} m")
    top, slab, uv = stage.table()
    print(f"table: {len(slab)} triangles, closed, volume {verify(top, slab, genus=0):.3f} m3")
    indices, palette = wood.make()
    look = {"metallic": 0.0, "roughness": 0.5}
    return {
        "teacup.glb": files.glb_bytes("teacup", parts),
        "table.glb": files.glb_bytes("table", [{"name": "wood", "positions": top, "triangles": slab, "uv": uv,
                                                "color": (0.45, 0.25, 0.12), **look}]),
        "wood.png": files.png_bytes(indices, palette),
        "room.exr": files.exr_bytes(stage.surroundings()),
    }


def difference(name, made, found):
    """What differs between two files of this name, or an empty string."""
    if made == found:
        return ""
    if name.endswith(".png"):
        (a, pa), (b, pb) = files.read_png(made), files.read_png(found)
        if a.shape != b.shape or not np.array_equal(pa, pb):
            return "size or palette"
        share = float(np.mean(a != b))
        return f"{share:.2%} of the pixels" if share > 1e-3 else ""
    if name.endswith(".exr"):
        a, b = files.read_exr(made), files.read_exr(found)
        return "" if a.shape == b.shape and np.allclose(a, b, rtol=2e-3) else "size or pixels"
    a, b = files.read_glb(made), files.read_glb(found)
    if list(a) != list(b):
        return f"parts {list(b)}, wanted {list(a)}"
    for part, (positions, triangles) in a.items():
        other, other_triangles = b[part]
        if positions.shape != other.shape or not np.array_equal(triangles, other_triangles):
            return f"triangles of part {part}"
        if np.abs(positions - other).max() > 1e-6:
            return f"positions of part {part} by {np.abs(positions - other).max():.2g} m"
    return ""


def main():
    here = pathlib.Path(__file__).resolve().parent
    parser = argparse.ArgumentParser(description="Makes the assets of the tea cup scene.")
    parser.add_argument("--check", action="store_true", help="compare with the files instead of writing them")
    parser.add_argument("--output", type=pathlib.Path, default=here, help="folder of the files")
    options = parser.parse_args()
    wrong = 0
    for name, data in make().items():
        path = options.output / name
        if not options.check:
            path.write_bytes(data)
            print(f"{name}: {len(data)} bytes")
            continue
        reason = difference(name, data, path.read_bytes()) if path.exists() else "missing"
        print(f"{name}: {'differs: ' + reason if reason else 'the same'}")
        wrong += bool(reason)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
