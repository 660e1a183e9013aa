"""What stands around the cast and is drawn only: backdrops, marks on the ground, and the places they go to.
`python3 make.py` writes the files beside this file; `--check` compares instead.

playroom.glb   for the cross: a wall at z = -2.6 with a corner at x = 7, toys along it, tiles along x to a finish at x = 3.2
town.glb       for the castles: a town wall which begins at x = 0 and goes on to +x, roofs behind it, hills and trees, a road
pitch.glb      for the sphere, in the place of sets/ramp.glb: a line along its way, cones at it, and a goal on the slope
island.glb     for the pirate, in the place of sets/shore.glb: the sea, a ship, palms, and dashes to a cross
park.glb       for the race on sets/track.glb: trees, and hills at its end
theatre.glb    for Ace: a stage with curtains, and a star on the floor at the origin
signboard.glb  for the letters: a board at z < 0 with the picture signboard.png, their places in the word
kitchen.glb    for the cups and Cheesy: a wall of `tiles` at z = -3.6 and jars
teapot.glb     a tea pot, 0.96 m high, its spout at +x
cheese_dish.glb  a dish whose `cover` lies beside it, at -x
course.glb     for figure 3: a wall, a ruler along x, its dashes 0.1 m long, and a flag at x = -1.8
"""

import pathlib
import re
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path += [str(HERE.parent), str(HERE.parent / "sets")]
import files
import generator
import sculpt
from grounds import ramp_rise, shore_rise
from picture import Picture
from surface import verify
from solids import ball, box, moved, plate, prism, strip, tube, turned

LOOKS = {  # part -> (linear RGB, roughness)
    "white": ((0.80, 0.79, 0.76), 0.4), "dark": ((0.02, 0.02, 0.024), 0.4), "red": ((0.62, 0.03, 0.025), 0.35),
    "yellow": ((0.85, 0.50, 0.04), 0.35), "blue": ((0.03, 0.16, 0.50), 0.35), "green": ((0.06, 0.30, 0.07), 0.5),
    "teal": ((0.02, 0.26, 0.28), 0.35), "gold": ((0.80, 0.52, 0.12), 0.3), "orange": ((0.80, 0.22, 0.02), 0.4),
    "paper": ((0.42, 0.58, 0.60), 0.9), "stripe": ((0.56, 0.70, 0.70), 0.9), "skirting": ((0.80, 0.78, 0.72), 0.4),
    "stone": ((0.60, 0.60, 0.64), 0.8), "roof": ((0.50, 0.10, 0.04), 0.6), "plaster": ((0.74, 0.62, 0.44), 0.8),
    "road": ((0.55, 0.42, 0.26), 0.9), "hill": ((0.13, 0.33, 0.06), 1.0), "far_hill": ((0.22, 0.42, 0.26), 1.0),
    "leaf": ((0.04, 0.20, 0.03), 0.8), "trunk": ((0.20, 0.09, 0.03), 0.8), "cloud": ((0.85, 0.87, 0.90), 1.0),
    "sea": ((0.02, 0.22, 0.34), 0.25), "foam": ((0.55, 0.75, 0.80), 0.6),
    "velvet": ((0.34, 0.012, 0.02), 0.7), "pool": ((0.90, 0.74, 0.50), 0.5), "star": ((0.80, 0.40, 0.03), 0.35),
    "bulb": ((1.0, 0.8, 0.5), 0.3), "tiles": ((0.62, 0.70, 0.68), 0.3), "china": ((0.82, 0.80, 0.74), 0.1),
    "cover": ((0.60, 0.62, 0.64), 0.2), "sign": ((0.84, 0.76, 0.62), 0.6), "net": ((0.75, 0.76, 0.78), 0.6), "tile": ((0.78, 0.42, 0.05), 0.4),
}


def checks(low, high, count):
    """Squares of a chequered rectangle in the plane (#: x0, y0, x1, y1), as (part, corners)."""
    low, high, count = np.array(low, float), np.array(high, float), np.array(count)
    size = (high - low) / count
    for i, j in np.ndindex(*count):
        a = low + size * (i, j)
        yield ("dark", "white")[(i + j) % 2], [a, a + size * (1, 0), a + size, a + size * (0, 1)]


def playroom():
    wall, end, top, finish = -2.6, 7.0, 3.2, 3.2
    for k in range(-16, 14):
        yield ("paper", "stripe")[k % 2], box((k / 2, 0, wall - 0.1), (k / 2 + 0.5, top, wall))
    for k in range(-5, 10):
        yield ("paper", "stripe")[k % 2], box((end, 0, k / 2), (end + 0.1, top, k / 2 + 0.5))
    yield "skirting", box((-8, 0, wall), (end, 0.22, wall + 0.05))
    yield "skirting", box((end - 0.05, 0, wall + 0.05), (end, 0.22, 5))
    # Tiles, with a line where the race begins and squares where it ends.
    for k in range(13):
        x = -3.9 + 0.55 * k
        yield ("tile", "teal")[k % 2], plate([(x, -0.75), (x + 0.5, -0.75), (x + 0.5, 0.95), (x, 0.95)], -0.02, 0.0006)
    for part, square in checks((finish, -1.5), (finish + 0.5, 2.1), (2, 14)):
        yield part, plate(square, -0.02, 0.0006)
    # Bricks to play with.
    bricks = [(-5.6, 0, "red"), (-5.0, 0, "yellow"), (-5.3, 1, "blue"), (-1.9, 0, "green"), (-1.3, 0, "red"), (-1.55, 1, "yellow"),
              (1.7, 0, "blue"), (2.4, 0, "yellow"), (2.0, 1, "red"), (2.1, 2, "green")]
    for x, level, part in bricks:
        yield part, moved(box((-0.25, 0, -0.25), (0.25, 0.5, 0.25)), (x, 0.5 * level, -2.15), 20 * np.sin(40 * x))


def skyline(x, heights, low, z, depth):
    """A silhouette standing in the plane z: from height `low` up to these heights at x."""
    return prism([(x[0], low), (x[-1], low), *zip(x[::-1], heights[::-1])], z - depth, z)


def tree(x, z, scale, part="leaf"):
    yield "trunk", moved(tube([(0, -0.05, 0), (0, 0.3, 0), (0, 0.6, 0)], (0.07, 0.05, 0.04)), (x, 0, z), 0, scale)
    for y, r in ((0.75, 0.42), (1.1, 0.34), (1.4, 0.22)):
        yield part, moved(ball(r, squash=(1, 0.8, 1)), (x + 0.1 * np.sin(9 * y + x), scale * y, z), 0, scale)


def cloud(x, y, z, scale):
    for dx, dy, r in ((-0.9, 0, 0.5), (-0.2, 0.2, 0.7), (0.6, 0.05, 0.55), (1.2, -0.05, 0.35)):
        yield "cloud", moved(ball(r, squash=(1, 0.75, 0.5)), (x + scale * dx, y + scale * dy, z), 0, scale)


def battlements(x0, x1, top, step=0.172, depth=0.12):
    """Outline of a wall from x0 to about x1, battlements at its top, beginning with a tooth."""
    count = int(round((x1 - x0) / step)) // 2
    line = [(x0, -0.02), (x0 + (2 * count + 1) * step, -0.02)]
    for k in range(count, -1, -1):
        a = x0 + 2 * k * step
        line += [(a + step, top), (a, top)]
        if k > 0:
            line += [(a, top - depth), (a - step, top - depth)]
    return line


def house(x, z, width, wall, roof, turn=0.0):
    """A house with its gable in front, a door and a window."""
    h = width / 2
    yield "plaster", moved(prism([(-h, 0), (h, 0), (h, wall), (0, wall + roof), (-h, wall)], -0.45, 0.45), (x, 0, z), turn)
    e = 0.1
    slope = np.array([(0, wall + roof + 0.08), (-h - e, wall - e * roof / h + 0.08), (-h - e, wall - e * roof / h),
                      (0, wall + roof), (h + e, wall - e * roof / h), (h + e, wall - e * roof / h + 0.08)])
    yield "roof", moved(prism(slope, -0.55, 0.55), (x, 0, z), turn)
    yield "dark", moved(box((-0.09, wall - 0.05, 0.44), (0.09, wall + 0.2, 0.46)), (x, 0, z), turn)


def pennant(x, z, low, high, part, size=0.3):
    yield "white", moved(tube([(0, low, 0), (0, (low + high) / 2, 0), (0, high, 0)], 0.015), (x, 0, z))
    yield part, moved(prism([(0, high), (-1.6 * size, high - 0.4 * size), (0, high - 0.9 * size)], -0.008, 0.008), (x, 0, z))


def town():
    # The gate tower's place is empty: the wall begins beside it.
    yield "stone", prism(battlements(0.0, 2.6, 1.0), -0.15, 0.15)
    yield "stone", prism(battlements(-0.62, 2.2, 0.86), -1.3, -1.05)
    for k in range(2):
        yield from pennant(0.09 + 1.376 * k, 0, 0.98, 1.55, ("red", "yellow")[k])
    yield from house(0.35, -0.62, 0.62, 1.0, 0.42)
    yield from house(1.15, -0.66, 0.7, 0.85, 0.5)
    yield from house(1.95, -0.6, 0.66, 1.05, 0.4)
    # A keep behind.
    yield "stone", prism(battlements(0.5, 1.2, 2.0, 0.11, 0.1), -2.1, -1.5)
    yield from pennant(0.9, -1.8, 1.9, 2.5, "red", 0.36)
    yield "road", plate([(-5.5, -0.42), (2.6, -0.42), (2.6, 0.38), (-5.5, 0.38)], -0.02, 0.0006)
    x = np.linspace(-11, 11, 90)
    yield "hill", skyline(x, 1.0 + 0.35 * np.sin(0.7 * x + 1) + 0.12 * np.sin(2.1 * x), -0.5, -5.8, 0.3)
    yield "far_hill", skyline(x, 1.7 + 0.5 * np.sin(0.5 * x + 2.5) + 0.2 * np.sin(1.3 * x), -0.5, -6.6, 0.3)
    for tx, tz, size in ((-3.4, -1.7, 0.8), (-2.1, -3.2, 1.0), (-1.25, -1.9, 0.55), (-4.4, -3.8, 1.2), (3.4, -2.9, 1.0)):
        yield from tree(tx, tz, size)
    yield from cloud(-3.2, 2.9, -6.9, 0.5)
    yield from cloud(-0.6, 3.4, -6.9, 0.35)


def spline(points, count):
    """A smooth line through points (#P by 2): Catmull and Rom."""
    p = np.asarray(points, float)
    p = np.concatenate([2 * p[:1] - p[1:2], p, 2 * p[-1:] - p[-2:-1]])
    t = np.linspace(0, 1, count, endpoint=False)[:, None]
    pieces = [0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
              for a, b, c, d in zip(p, p[1:], p[2:], p[3:])]
    return np.concatenate([*pieces, p[-2:-1]])


def cone(x, z):
    yield "orange", moved(turned([(0, 0), (0.17, 0), (0.17, 0.02), (0.11, 0.025), (0.075, 0.17), (0, 0.17)]), (x, 0, z))
    yield "white", moved(turned([(0, 0.165), (0.076, 0.165), (0.05, 0.27), (0, 0.27)]), (x, 0, z))
    yield "orange", moved(turned([(0, 0.265), (0.051, 0.265), (0.022, 0.40), (0, 0.405)]), (x, 0, z))


def pitch():
    way = spline([(1.2, -3.4), (0.4, -2.2), (-0.5, -1.0), (0, 0.4), (0, 1.5)], 12)
    for k in range(2, len(way) - 2, 3):
        yield "white", strip(way[k:k + 2], 0.035, lambda x, z: ramp_rise(z) + 0.0012, -0.01)
    for x, z in ((1.15, -1.55), (-0.9, -2.2), (0.6, -0.2), (-1.35, -0.6)):
        yield from cone(x, z)
    # The goal: its line, a frame and a net.
    front, back, half, top = 1.55, 2.75, 1.0, 1.15
    line = np.stack([np.linspace(-1.3, 1.3, 3), np.full(3, front)], axis=1)
    yield "white", strip(line, 0.04, lambda x, z: ramp_rise(z) + 0.0012, -0.01)
    ground, far = float(ramp_rise(front)), float(ramp_rise(back))
    for x in (-half, half):
        yield "white", tube([(x, ground - 0.05, front), (x, ground + 0.5, front), (x, ground + top, front)], 0.045, 12)
        yield "white", tube([(x, ground + top, front), (x, (ground + far + top) / 2 + 0.25, (front + back) / 2 + 0.1),
                             (x, far, back)], 0.02)
    yield "white", tube([(-half - 0.045, ground + top, front), (0, ground + top, front),
                         (half + 0.045, ground + top, front)], 0.045, 12)
    for x in np.linspace(-half, half, 13):
        yield "net", tube([(x, ground + top, front), (x, (ground + far + top) / 2 + 0.25, (front + back) / 2 + 0.1),
                           (x, far, back)], 0.007, 5)
    for t in np.linspace(0, 1, 11):
        a = np.array([0, ground + top, front]), np.array([0, (ground + far + top) / 2 + 0.25, (front + back) / 2 + 0.1])
        b = a[1], np.array([0, far, back])
        p = (1 - 2 * t) * a[0] + 2 * t * a[1] if t < 0.5 else (2 - 2 * t) * b[0] + (2 * t - 1) * b[1]
        yield "net", tube([p - (half, 0, 0), p, p + (half, 0, 0)], 0.007, 5)
    # A hedge and trees around the pitch.
    x = np.linspace(-3.9, 3.9, 40)
    yield "leaf", skyline(x, 2.5 + 0.06 * np.sin(9 * x) + 0.05 * np.sin(23 * x), 0.2, 6.9, 0.5)
    for tx, tz in ((-2.6, 6.2), (2.7, 6.1), (-3.4, 3.6), (3.3, 3.4)):
        for part, solid in tree(tx, 0, 0.9):
            yield part, moved(solid, (0, float(ramp_rise(tz)) - 0.02, tz))
    side = np.linspace(-8, 6.4, 70)
    for x0 in (-3.9, 3.9):
        vertices, triangles = skyline(side, ramp_rise(side) + 0.55 + 0.05 * np.sin(11 * side), -0.1, 0.15, 0.3)
        yield "leaf", (vertices[:, [2, 1, 0]] * (-1, 1, 1) + (x0, 0, 0), triangles)


def palm(x, y, z, height, lean):
    t = np.linspace(0, 1, 9)
    line = np.stack([lean * t**1.8, height * t - 0.2 * (1 - t), 0 * t], axis=1) + (x, y, z)
    yield "trunk", tube(line, 0.07 * (1 - 0.5 * t) * height / 1.6)
    u = np.linspace(0, 1, 12)
    droop = 0.35 * u - 0.75 * u**2
    fat = 0.16 * np.sin(np.pi * u**0.7)
    leaf = np.concatenate([np.stack([u, droop + fat], 1), np.stack([u, droop - 0.4 * fat], 1)[-2:0:-1]]) * 0.55 * height
    for k in range(8):
        solid = moved(prism(leaf, -0.03, 0.03), heading_deg=45 * k + 20)
        yield "leaf", moved(solid, line[-1] + (0, 0.04 * (k % 2), 0))
    for k in range(3):
        yield "trunk", moved(ball(0.07 * height / 1.6), line[-1] + 0.1 * np.array([np.sin(2 * k), -0.6, np.cos(2 * k)]))


def ship(x, y, z, scale):
    hull = [(-1.0, 0.55), (-1.05, 0.75), (-0.55, 0.62), (0.55, 0.5), (1.1, 0.72), (1.25, 0.7), (0.8, 0), (-0.8, 0)]
    yield "trunk", moved(prism(hull, -0.25, 0.25), (x, y - 0.08 * scale, z), scale=scale)
    for mast, low, size in ((-0.5, 0.6, 0.8), (0.35, 0.5, 1.0)):
        yield "trunk", moved(tube([(mast, 0.3, 0), (mast, 1, 0), (mast, low + 1.45 * size, 0)], 0.035), (x, y, z), scale=scale)
        for a, b, half in ((0.15, 0.7, 0.42), (0.76, 1.2, 0.3)):
            v = np.linspace(low + a * size, low + b * size, 9)
            belly = 0.1 * np.sin(np.pi * (v - v[0]) / (v[-1] - v[0]))
            sail = [*zip(mast - half * size + belly, v), *zip(mast + half * size + 1.6 * belly[::-1], v[::-1])]
            yield "white", moved(prism(sail, 0.05, 0.07), (x, y, z), scale=scale)
    yield "dark", moved(prism([(0.35, 1.98), (-0.05, 1.92), (0.02, 1.8), (-0.05, 1.68), (0.35, 1.74)], -0.01, 0.01),
                        (x, y, z), scale=scale)


def island():
    sea = -0.14
    yield "sea", box((-60, sea - 0.1, -60), (60, sea, -1.6))
    for k in range(14):
        yield "foam", box((-9 + 1.9 * k + np.sin(7 * k), sea, -3 - 1.2 * (k * 5 % 7)),
                          (-8 + 1.9 * k + np.sin(7 * k), sea + 0.012, -2.94 - 1.2 * (k * 5 % 7)))
    # The way to the treasure.
    for k in range(8):
        x = -0.42 + 0.24 * k
        yield "red", strip([(x, 0.3), (x + 0.065, 0.3), (x + 0.13, 0.3)], 0.026, lambda x, z: shore_rise(x) + 0.004, -0.01)
    for way in (-1, 1):
        t = np.linspace(-0.15, 0.15, 7)
        line = np.stack([1.66 + t, 0.3 + way * t], axis=1)
        yield "red", strip(line, 0.034, lambda x, z: shore_rise(x) + 0.004 + 0.001 * way, -0.01)
    for k, (x, z) in enumerate(((1.48, -0.12), (1.9, 0.08), (2.02, 0.12), (1.58, -0.22), (2.12, -0.02))):
        yield "gold", moved(turned([(0, 0), (0.045, 0), (0.045, 0.014), (0, 0.014)]), (x, float(shore_rise(x)), z))
    yield from palm(2.35, 0, -1.1, 1.9, -0.42)
    yield from palm(2.75, 0, -1.35, 1.5, 0.3)
    yield from palm(-1.35, 0, -1.3, 1.7, 0.35)
    yield from ship(-1.2, sea, -9.0, 0.75)
    x = np.linspace(-1.0, 1.0, 20)
    yield "far_hill", skyline(4 * x + 5.0, sea + 0.55 * np.sqrt(np.maximum(1 - x**2, 0)) + 0.12 * np.sin(7 * x) * (1 - x**2) + 0.01,
                              sea - 0.1, -20.0, 0.5)
    for x, y, z, size in ((-0.7, 2.2, -14.0, 0.5), (2.6, 2.7, -14.0, 0.6), (4.8, 1.9, -14.0, 0.4)):
        yield from cloud(x, y, z, size)


def park():
    x = np.linspace(-16, 16, 90)
    yield "hill", skyline(x, 1.2 + 0.5 * np.sin(0.6 * x + 2) + 0.15 * np.sin(1.9 * x), -0.5, -10.6, 0.3)
    yield "far_hill", skyline(x, 2.3 + 0.7 * np.sin(0.4 * x + 0.5) + 0.2 * np.sin(1.1 * x), -0.5, -11.4, 0.3)
    for tx, tz, size in ((-4.6, -7.5, 1.1), (-2.6, -9.2, 0.9), (2.9, -7.0, 1.2), (4.6, -8.6, 1.0), (5.4, -4.6, 1.3), (-6.5, -5.5, 1.2)):
        yield from tree(tx, tz, size)


def drape(x0, x1, z, low, high, fold=0.24, deep=0.07):
    """A curtain in the plane z."""
    x = np.linspace(x0, x1, int(round(14 * (x1 - x0) / fold)) + 1)
    wave = z + deep * np.sin(2 * np.pi * x / fold) + 0.35 * deep * np.sin(2 * np.pi * x / (2.7 * fold))
    return plate([*zip(x, wave + 0.01), *zip(x[::-1], wave[::-1] - 0.01)], low, high)


def star(x, z, radius, points=5):
    turn = np.pi * np.arange(2 * points) / points
    r = radius * np.where(np.arange(2 * points) % 2 == 0, 1, 0.42)
    return np.stack([x + r * np.sin(turn), z + r * np.cos(turn)], axis=1)


def theatre():
    yield "velvet", drape(-4.5, 4.5, -1.9, 0.0, 4.0)
    for side in (-1, 1):
        yield "velvet", drape(min(1.75 * side, 3.2 * side), max(1.75 * side, 3.2 * side), -1.15, 0.0, 4.0, 0.2, 0.06)
    x = np.linspace(-3.2, 3.2, 129)
    bows = 0.16 * np.abs(np.sin(np.pi * x / 0.8))
    valance = [(-3.2, 4.0), *zip(x, 1.86 - bows), (3.2, 4.0)]
    yield "velvet", prism(valance, -1.08, -1.0)
    hem = [*zip(x, 1.86 - bows - 0.05), *zip(x[::-1], 1.86 - bows[::-1] + 0.005)]
    yield "gold", prism(hem, -1.09, -0.985)
    # Where to stand: a pool of light, a star in it, and dots on the way.
    turn = 2 * np.pi * np.arange(48) / 48
    yield "pool", plate(np.stack([0.62 * np.sin(turn), 0.62 * np.cos(turn)], axis=1), -0.02, 0.0004)
    yield "star", plate(star(0, 0, 0.46), -0.02, 0.0007)
    for k in range(3):
        yield "star", plate(np.stack([0.74 + 0.17 * k + 0.035 * np.sin(turn), 0.035 * np.cos(turn)], axis=1), -0.02, 0.0004)
    for x in np.linspace(-2.6, 2.6, 14):
        yield "bulb", moved(ball(0.045, 7, 12), (x, 0.03, -0.92))
    # A conjurer's hat and his wand.
    hat = [(0, 0), (0.30, 0), (0.30, 0.02), (0.19, 0.03), (0.185, 0.10)]
    yield "dark", moved(turned([*hat, (0, 0.10)], 40), (-1.0, 0, -0.35))
    yield "red", moved(turned([(0, 0.095), (0.187, 0.095), (0.187, 0.16), (0, 0.16)], 40), (-1.0, 0, -0.35))
    yield "dark", moved(turned([(0, 0.155), (0.185, 0.155), (0.20, 0.42), (0.19, 0.43), (0, 0.43)], 40), (-1.0, 0, -0.35))
    for part, a, b in (("dark", 0.12, 0.88), ("white", 0, 0.125), ("white", 0.875, 1)):
        ends = np.array([(-1.35, 0.03, 0.15), (-0.75, 0.03, 0.30)])
        yield part, tube([ends[0] + t * (ends[1] - ends[0]) for t in (a, (a + b) / 2, b)], 0.022 if part == "dark" else 0.0225, 12)


def kitchen():
    wall = -3.6
    yield "tiles", box((-16, 0, wall - 0.1), (16, 5.5, wall))
    yield "skirting", box((-16, 0, wall), (16, 0.12, wall + 0.06))
    for x, part, size in ((-5.6, "red", 1.0), (-4.7, "yellow", 0.85), (-3.95, "teal", 0.7), (2.6, "teal", 0.9), (3.45, "red", 0.75)):
        jar = [(0, 0), (0.33, 0), (0.37, 0.05), (0.37, 0.85), (0.33, 0.9), (0, 0.9)]
        lid = [(0, 0.895), (0.35, 0.895), (0.35, 1.0), (0.08, 1.03), (0.08, 1.1), (0, 1.12)]
        yield part, moved(turned(jar, 40), (x, 0, wall + 0.6), scale=size)
        yield "white", moved(turned(lid, 40), (x, 0, wall + 0.6), scale=size)


def teapot():
    t = np.linspace(0, 1, 17)
    belly = zip(0.32 + 0.28 * np.sin(np.pi * t)**0.8, 0.05 + 0.65 * t)
    yield "china", turned([(0, 0), (0.30, 0), *belly, (0.24, 0.72), (0, 0.72)], 48)
    yield "gold", turned([(0, 0.71), (0.33, 0.71), (0.33, 0.74), (0, 0.74)], 48)
    yield "china", turned([(0, 0.735), (0.27, 0.735), (0.22, 0.82), (0.05, 0.87), (0, 0.875)], 48)
    yield "gold", moved(ball(0.065), (0, 0.92, 0))
    spout = np.stack([0.45 + 0.45 * t, 0.28 + 0.10 * t + 0.42 * t**2, 0 * t], axis=1)
    yield "china", tube(spout, 0.15 - 0.09 * t, 16)
    turn = np.linspace(-0.4 * np.pi, 0.42 * np.pi, 17)
    yield "gold", tube(np.stack([-0.5 - 0.32 * np.cos(turn), 0.40 + 0.26 * np.sin(turn), 0 * turn], axis=1), 0.045, 12)
    yield "blue", turned([(0, 0.33), (0.585, 0.33), (0.604, 0.40), (0.585, 0.45), (0, 0.45)], 48)


def cheese_dish():
    turn = 2 * np.pi * np.arange(64) / 64
    for part, radius, top in (("blue", 0.80, 0.0004), ("white", 0.76, 0.0006), ("blue", 0.62, 0.0008), ("white", 0.60, 0.001)):
        yield part, plate(np.stack([radius * np.sin(turn), radius * np.cos(turn)], axis=1), -0.02, top)
    t = np.linspace(0, np.pi / 2, 13)
    radius, high = 0.68, 0.35
    outer = [(radius, 0), *zip(radius * np.cos(t), high + radius * np.sin(t))]
    inner = [(0.96 * x, 0.96 * y) for x, y in outer]
    cover = turned([*inner[::-1], *outer], 48)
    knob = moved(ball(0.09), (0, high + radius + 0.07, 0))
    tilt = np.radians(62)
    lean = np.array([(np.cos(tilt), np.sin(tilt), 0), (-np.sin(tilt), np.cos(tilt), 0), (0, 0, 1)])
    for part, (vertices, triangles) in (("cover", cover), ("gold", knob)):
        yield part, (vertices @ lean + (-1.05, 0.60, -1.0), triangles)


def course():
    wall = -1.5
    for k in range(-10, 8):
        yield ("paper", "stripe")[k % 2], box((k / 2, 0, wall - 0.1), (k / 2 + 0.5, 3.5, wall))
    yield "skirting", box((-5, 0, wall), (4, 0.18, wall + 0.05))
    for k in range(24):
        x = 0.5 - 0.1 * k
        deep = 0.42 if k % 5 == 0 else 0.36
        yield ("white", "dark")[k % 2], plate([(x - 0.1, 0.26), (x, 0.26), (x, deep), (x - 0.1, deep)], -0.02, 0.0006)
    yield "white", moved(tube([(0, 0, 0), (0, 0.7, 0), (0, 1.4, 0)], 0.02), (-1.8, 0, -0.35))
    yield "dark", moved(turned([(0, 0), (0.14, 0), (0.12, 0.03), (0, 0.04)]), (-1.8, 0, -0.35))
    for part, square in checks((-1.78, 1.0), (-1.18, 1.4), (6, 4)):
        yield part, prism(square, -0.355, -0.345)


# The board of the word: corners (x, y) of its picture, and the letters' middles with their colours (sRGB).
SIGN = np.array([(-4.9, 0.0), (4.9, 1.4)])
PLACES = [("S", -3.93, (214, 66, 52)), ("I", -3.11, (232, 148, 60)), ("G", -2.24, (226, 186, 70)), ("G", -1.11, (126, 176, 82)),
          ("R", 0.06, (50, 164, 154)), ("A", 1.38, (72, 132, 206)), ("P", 2.48, (146, 92, 190)), ("H", 3.73, (222, 104, 158))]
BOARD, GROOVE = (242, 232, 210), (156, 134, 108)


def letter_loops(letter):
    """Outline of a letter of letters.svg (a list of #P by 2), 1 m high, about the middle of its width, standing on y = 0."""
    svg = (HERE.parent / "letters" / "letters.svg").read_text()
    path = re.search(rf'id="{letter}" d="([^"]*)"', svg).group(1)
    loops = [np.array(re.findall(r"-?[\d.]+", loop), float).reshape(-1, 2) * (0.01, -0.01) + (0, 1)
             for loop in path.split("Z")[:-1]]
    x = np.concatenate(loops)[:, 0]
    return [loop - ((x.min() + x.max()) / 2, 0) for loop in loops]


def sign_picture():
    """Places for the letters, each cut into the board and in the colour of its letter."""
    image = Picture((224, 1568), SIGN[0], SIGN[1], BOARD)
    points = np.stack([image.x.ravel(), image.y.ravel()], axis=1)

    def side(loop):
        return np.sign(np.sum(loop[:, 0] * np.roll(loop[:, 1], -1) - loop[:, 1] * np.roll(loop[:, 0], -1)))

    for letter, middle, color in PLACES:
        near = np.abs(points[:, 0] - middle) < 0.9
        loops = letter_loops(letter)
        distance = np.full(len(points), 1.0)
        inner = np.full(near.sum(), 1.0)
        for loop in loops:
            d = sculpt.polygon(points[near] - (middle, 0.02), loop)
            inner = np.minimum(inner, d) if side(loop) == side(loops[0]) else np.maximum(inner, -d)
        distance[near] = inner
        distance = distance.reshape(image.x.shape)
        image.lay(distance, GROOVE)
        image.lay(distance + 0.025, 0.78 * np.array(BOARD) + 0.15 * np.array(color))
    return image.indexed()


def signboard():
    wall, top = -1.6, 6.0
    for k in range(-24, 24):
        yield ("paper", "stripe")[k % 2], box((k / 2, 0, wall - 0.1), (k / 2 + 0.5, top, wall))
    yield "skirting", box((-12, 0, wall), (12, 0.3, wall + 0.05))
    (x0, y0), (x1, y1) = SIGN
    yield "sign", box((x0, y0, -0.5), (x1, y1, -0.4))
    for a, b in ((x0 - 0.12, x0), (x1, x1 + 0.12)):
        yield "trunk", box((a, 0, -0.54), (b, y1 + 0.12, -0.36))
    yield "trunk", box((x0, y1, -0.54), (x1, y1 + 0.12, -0.36))
    # Bunting.
    x = np.linspace(-6.5, 6.5, 27)
    sag = 2.75 - 0.35 * np.abs(np.sin(np.pi * x / 4.333))
    yield "white", tube(np.stack([x, sag, np.full(len(x), wall + 0.15)], axis=1), 0.012, 6)
    for k in range(26):
        u, v = (x[k] + x[k + 1]) / 2, (sag[k] + sag[k + 1]) / 2
        yield ("red", "yellow", "teal", "blue")[k % 4], moved(prism([(-0.17, 0), (0.17, 0), (0, -0.36)], -0.006, 0.006),
                                                             (u, v, wall + 0.15))


def planar(part, v):
    """Texture coordinates: those of the sign fill its picture, those of walls are metres across and down."""
    if part == "sign":
        return (v[:, :2] - SIGN[0]) / (SIGN[1] - SIGN[0]) * (1, -1) + (0, 1)
    return np.stack([v[:, 0] + v[:, 2], -v[:, 1]], axis=1)


def glb(name, stage):
    """Bytes of a stage, its solids put together by part."""
    parts = {}
    for part, (vertices, triangles) in stage:
        verify(vertices, triangles, 0)
        v, t = parts.get(part, (np.empty((0, 3)), np.empty((0, 3), int)))
        parts[part] = np.concatenate([v, vertices]), np.concatenate([t, triangles + len(v)])
    print(f"{name}: {sum(len(t) for _, t in parts.values())} triangles; parts {' '.join(parts)}")
    return files.glb_bytes(name, [{"name": part, "positions": v, "triangles": t, "color": LOOKS[part][0], "uv": planar(part, v),
                                   "metallic": 0.0, "roughness": LOOKS[part][1]} for part, (v, t) in parts.items()],
                           generator="assets/stages/make.py")


def make():
    stages = park, playroom, town, pitch, island, theatre, signboard, kitchen, teapot, cheese_dish, course
    return {**{f"{stage.__name__}.glb": glb(stage.__name__, stage()) for stage in stages},
            "signboard.png": files.png_bytes(*sign_picture())}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes the stages.")
