"""Grounds and obstacles of the cast's scenes. `python3 make.py` writes the files beside this file; `--check` compares.

ramp.glb    a floor of `planks`, 8 m wide, its top in y = 0 up to z = 0; then it rises by 10 degrees for 6 m to a landing;
            a `line` is painted across it before the rise and after it
dunes.glb   sand, 3 m wide, level to x = 0.5, then uneven for 15 m: what varies is its height along x
shore.glb   sand, 4 m wide, from x = -4 to 6 m, with bumps of 4.5 cm; level where |x| < 0.3
board.glb   a chopping board with a handle, 2.4 m by 0.9 m and 0.07 m high, lying on y = 0; the handle points to +x
track.glb   a running track with two lanes along z on a `lawn`, its top in y = 0: `paint` beside the lanes and where the race
            begins, at z = -2.1, and squares (`dark`, `paint`) across z = 0, where it ends
gate.glb    two `post`s and a banner of squares (`dark`, `paint`) over the end of the race
"""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import files
import generator
import sculpt
from grounds import BEND, shore_rise, SLOPE
from surface import verify

PLANKS = np.array([9.6, 7.2])  # metres of teacup/wood.png: along the grain, across it


def section(half, thick, edge):
    """Outline (#P by 2: across, up) of a slab below y = 0 with round upper edges, against the clock, and the arc lengths."""
    turn = np.linspace(0, np.pi / 2, 7)
    right = np.stack([half - edge + edge * np.cos(turn), edge * np.sin(turn) - edge], axis=1)
    line = np.concatenate([[(half, -thick)], right, np.linspace(half - edge, edge - half, 14)[1:-1, None] * (1, 0),
                           right[::-1] * (-1, 1), [(-half, -thick)]])
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    return line, along - along[-1] / 2


def sweep(line, path):
    """Closed surface of a section moved along a path (#S by 2: forward, up), as (across, up, forward) turned to x, y, z."""
    way = np.gradient(path, axis=0)
    way /= np.linalg.norm(way, axis=1)[:, None]
    count, steps = len(line), len(path)
    across = np.broadcast_to(line[:, 0], (steps, count))
    up = path[:, None, 1] + line[:, 1] * way[:, None, 0]
    forward = path[:, None, 0] - line[:, 1] * way[:, None, 1]
    vertices = np.stack([across, up, forward], axis=2).reshape(-1, 3)
    k = np.arange(count)
    k1 = (k + 1) % count
    triangles = []
    for j in range(steps - 1):
        a, b = j * count, (j + 1) * count
        triangles += [np.stack([a + k, b + k1, b + k], 1), np.stack([a + k, a + k1, b + k1], 1)]
    fan = np.stack([np.zeros(count - 2, int), k[1:-1], k[2:]], axis=1)
    triangles += [fan[:, ::-1], fan + (steps - 1) * count]
    return vertices, np.concatenate(triangles)


def ramp():
    """The floor with the ramp, the part of each triangle, and texture coordinates."""
    bend = np.linspace(0, SLOPE, 9)
    first = np.stack([BEND * np.sin(bend), BEND * (1 - np.cos(bend))], axis=1)
    top = first[-1] + 6.0 * np.array([np.cos(SLOPE), np.sin(SLOPE)])
    second = top + first[-1] - first[::-1]
    path = np.concatenate([np.stack([(-8, -6, -4, -2, -0.4, -0.25), np.zeros(6)], 1), first,
                           np.linspace(first[-1], top, 9)[1:-1], second, second[-1] + np.outer((0.25, 0.4, 3.5), (1, 0))])
    line, across = section(4.0, 0.4, 0.10)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    uv = np.stack(np.broadcast_arrays(across / PLANKS[0], (along / PLANKS[1])[:, None]), axis=2).reshape(-1, 2)
    vertices, triangles = sweep(line, path)
    step = triangles.min(axis=1) // len(line)
    painted = np.isin(step, (4, len(path) - 3)) & (np.ptp(triangles // len(line), axis=1) == 1)
    return vertices, triangles, np.where(painted, "line", "planks"), uv


def dunes():
    x = np.linspace(-3.0, 17.0, 401)
    fade = np.clip((x - 0.5) / 1.0, 0, 1) * np.clip((16.0 - x) / 1.0, 0, 1)
    turns = 2 * np.pi * x
    rise = 0.034 * np.sin(turns / 1.83 + 0.4) + 0.026 * np.sin(turns / 1.07) + 0.040 * np.sin(turns / 3.9 + 2.0)
    line, _ = section(1.5, 0.5, 0.15)
    vertices, triangles = sweep(line, np.stack([x, fade**2 * (3 - 2 * fade) * rise], axis=1))
    return vertices[:, [2, 1, 0]] * (1, 1, -1), triangles


def shore():
    x = np.linspace(-4.0, 6.0, 251)
    line, _ = section(2.0, 0.5, 0.15)
    vertices, triangles = sweep(line, np.stack([x, shore_rise(x)], axis=1))
    return vertices[:, [2, 1, 0]] * (1, 1, -1), triangles


def board_shape(p):
    q = p[:, [0, 2]]
    plate = np.abs(q - (-0.15, 0)) - (1.05, 0.45) + 0.15
    plate = np.linalg.norm(np.maximum(plate, 0), axis=1) + np.minimum(plate.max(axis=1), 0) - 0.15
    grip = np.abs(q - (0.95, 0)) - (0.45, 0.13) + 0.12
    grip = np.linalg.norm(np.maximum(grip, 0), axis=1) + np.minimum(grip.max(axis=1), 0) - 0.12
    outline = sculpt.minus(sculpt.union(plate, grip, 0.15), np.hypot(q[:, 0] - 1.24, q[:, 1]) - 0.065, 0.01)
    solid = sculpt.slab(outline, np.abs(p[:, 1] - 0.035) - 0.035, 0.025)
    groove = np.hypot(plate + 0.11, p[:, 1] - 0.075) - 0.022
    return sculpt.minus(solid, groove, 0.006)


CHECK = 0.15  # size of the squares of the race (m)


def dark(a, b):
    return (np.floor(a / CHECK) + np.floor(b / CHECK)) % 2 == 0


def track():
    lanes, start = (-1.2, 0.0, 1.2), -2.1
    near = lambda v, values, distance: np.min(np.abs(v[:, None] - values), axis=1) < distance
    edges = np.concatenate([np.add.outer(lanes, (-0.025, 0.025)).ravel(), CHECK * np.arange(-8, 9), (-1.6, 1.6)])
    line, _ = section(9.0, 0.4, 0.10)
    line = np.concatenate([line[:9], [(x, 0) for x in np.unique(edges.round(3))[::-1]], line[-9:]])
    z = np.concatenate([np.linspace(-12, -3, 7), (start - 0.025, start + 0.025), (-1.1, -CHECK, 0, CHECK), np.linspace(1, 9, 6)])
    vertices, triangles = sweep(line, np.stack([z, np.zeros(len(z))], axis=1))
    x, y, z = vertices[triangles].mean(axis=1).T
    names = np.where((np.abs(x) < 1.6) & (y > -1e-6), "track", "lawn").astype(object)
    names[(names == "track") & (near(x, lanes, 0.025) | (np.abs(x) < 1.2) & near(z, (start,), 0.025))] = "paint"
    names[(np.abs(x) < 1.2) & (y > -1e-6) & (np.abs(z) < CHECK)] = "paint"
    names[(np.abs(x) < 1.2) & (y > -1e-6) & (np.abs(z) < CHECK) & dark(x, z)] = "dark"
    return vertices, triangles, names


def gate():
    """Closed surfaces: the posts and the banner, with the names of their triangles."""
    turn = np.linspace(0, 2 * np.pi, 33)[:-1]
    vertices, triangles = sweep(0.05 * np.stack([np.cos(turn), np.sin(turn)], axis=1), np.array([(0, 0), (0, 1.0), (0, 2.0)]))
    solids = [(vertices + (x, 0, 0), triangles, np.full(len(triangles), "post")) for x in (-1.4, 1.4)]
    rows = CHECK * np.arange(10, 13)
    outline = np.array([(0.012, rows[1]), (0.012, rows[2]), (-0.012, rows[2]), (-0.012, rows[1]), (-0.012, rows[0]),
                        (0.012, rows[0])])
    columns = CHECK * np.arange(-9, 10)
    vertices, triangles = sweep(outline, np.stack([columns, np.zeros(len(columns))], axis=1))
    vertices = vertices[:, [2, 1, 0]] * (1, 1, -1)
    x, y, _ = vertices[triangles].mean(axis=1).T
    return solids + [(vertices, triangles, np.where(dark(x, y), "dark", "paint"))]


COLORS = {"planks": (0.45, 0.25, 0.12), "line": (0.70, 0.10, 0.05), "sand": (0.70, 0.50, 0.28), "board": (0.60, 0.36, 0.16),
          "lawn": (0.10, 0.22, 0.05), "track": (0.05, 0.17, 0.30), "dark": (0.015, 0.015, 0.018), "paint": (0.80, 0.79, 0.76),
          "post": (0.75, 0.73, 0.68)}


def joined(solids):
    """Several closed surfaces as one."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _, _ in solids])
    return (np.concatenate([vertices for vertices, _, _ in solids]),
            np.concatenate([triangles + start for (_, triangles, _), start in zip(solids, starts)]),
            np.concatenate([names for _, _, names in solids]))


def glb(name, *solids, genus=0, **more):
    """Bytes of closed surfaces, each (vertices, triangles, part of each triangle) and of this genus."""
    volume = sum(verify(vertices, triangles, genus) for vertices, triangles, _ in solids)
    vertices, triangles, names = joined(solids)
    low, high = vertices.min(axis=0).round(3), vertices.max(axis=0).round(3)
    print(f"{name}: {len(triangles)} triangles, closed, from {low} to {high} m, volume {volume:.3f} m3")
    parts = [{"name": part, "positions": vertices, "triangles": triangles[names == part], "color": COLORS[part],
              "metallic": 0.0, "roughness": 0.5, **more} for part in np.unique(names)]
    return files.glb_bytes(name, parts, generator="assets/sets/make.py")


def make():
    *floor, uv = ramp()
    sand, coast, board = dunes(), shore(), sculpt.surface(board_shape, (-1.3, -0.02, -0.5), (1.5, 0.1, 0.5), 0.022)
    grain = board[0][:, [0, 2]] / PLANKS + (0.31, 0.25)
    return {
        "ramp.glb": glb("ramp", floor, uv=uv),
        "dunes.glb": glb("dunes", (*sand, np.full(len(sand[1]), "sand"))),
        "shore.glb": glb("shore", (*coast, np.full(len(coast[1]), "sand"))),
        "board.glb": glb("board", (*board, np.full(len(board[1]), "board")), genus=1, uv=grain),
        "track.glb": glb("track", track()),
        "gate.glb": glb("gate", *gate()),
    }


if __name__ == "__main__":
    generator.main(make, __file__, "Makes the sets.")
