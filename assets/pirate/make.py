"""Paints pirate.png for the outline in pirate.svg: it fills the box around it. Writes the poses that his rest shape mixes,
and sculpts treasure.glb, an open chest. `python3 make.py` writes them beside this file; `--check` compares instead."""

import pathlib
import re
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import files
import generator
import sculpt
from picture import Picture

ROWS = 720
HIPS, ANKLES = 74, 100  # heights in the drawing
STRIDE, STRETCH, LEAN_DEG = 0.2, 0.12, 20  # of the poses, m
LID_DEG = 80  # by which the chest is open
INK, HAT, GOLD, BONE = (26, 20, 22), (38, 34, 46), (222, 168, 60), (240, 234, 216)
SKIN, ROSE, HAIR, WHITE, BLUE = (226, 164, 118), (214, 112, 86), (92, 46, 24), (250, 248, 242), (48, 104, 150)
COAT, SHADE, SHIRT, BELT = (150, 32, 36), (112, 20, 28), (236, 228, 206), (70, 42, 26)
STEEL, TROUSERS, BOOT, WOOD, GRAIN = (176, 184, 192), (52, 74, 108), (54, 36, 28), (176, 118, 66), (118, 72, 36)


def outline():
    """The outline (#P by 2) in the units of the drawing, y downwards; its path holds M, L, C and Z."""
    path = re.search(r'\bd="([^"]*)"', (HERE / "pirate.svg").read_text()).group(1)
    points, t = [], np.linspace(0, 1, 33)[1:, None]
    for command, numbers in re.findall(r"([MLCZ])([^MLCZ]*)", path):
        p = np.array(re.findall(r"-?[\d.]+", numbers), float).reshape(-1, 2)
        if command in "ML":
            points += list(p)
        elif command == "C":
            for b, c, d in p.reshape(-1, 3, 2):
                a = points[-1]
                points += list((1 - t)**3 * a + 3 * t * (1 - t)**2 * b + 3 * t**2 * (1 - t) * c + t**3 * d)
    return np.array(points[:-1])  # the last is the first


def paint():
    rim = outline()
    (left, top), (right, bottom) = rim.min(axis=0), rim.max(axis=0)
    image = Picture((ROWS, round(ROWS * (right - left) / (bottom - top))), (left, bottom), (right, top), COAT)
    x, y, lay = image.x, image.y, image.lay

    def area(*corners):
        return sculpt.polygon(np.stack([x.ravel(), y.ravel()], axis=1), corners).reshape(x.shape)

    def oval(cx, cy, a, b, turn=0.0):
        cos, sin = np.cos(turn), np.sin(turn)
        u, v = cos * (x - cx) + sin * (y - cy), cos * (y - cy) - sin * (x - cx)
        return (np.hypot(u / a, v / b) - 1) * min(a, b)

    def line(half, *corners):
        d = np.full(x.shape, np.inf)
        for a, b in zip(np.array(corners, float)[:-1], np.array(corners, float)[1:]):
            p = np.stack([x - a[0], y - a[1]], axis=2)
            t = np.clip(p @ (b - a) / ((b - a) @ (b - a)), 0, 1)
            d = np.minimum(d, np.linalg.norm(p - t[..., None] * (b - a), axis=2))
        return d - half

    inside = area(*rim)

    # Coat: shirt in front, belt, trims, cuff and hook.
    lay(area((16, 44), (40, 44), (30, 60), (31, 76), (18, 76)), SHIRT)
    lay(line(0.35, (21, 52), (23, 53)), BELT)
    for k in range(3):
        lay(oval(25.5, 53.5 + 4.5 * k, 0.8, 0.8), GOLD)
    lay(line(1.0, (17, 44), (19, 60), (18, 76)), GOLD)
    lay(np.maximum(np.abs(y - 64.6 - 0.02 * (x + 5)) - 2.4, x - 33), BELT)
    lay(np.abs(area((20, 62), (28, 62), (28, 68.2), (20, 68.2))) - 0.7, GOLD)
    lay(np.maximum(np.abs(y - 72.6) - 0.8, x - 18), GOLD)
    sleeve = area((8, 49), (20, 45.5), (28, 50), (38, 54.6), (37.5, 66), (30, 64.5), (16, 61), (8, 57))
    lay(sleeve, SHADE)
    lay(sleeve + 0.9, COAT)
    lay(area((36.5, 52), (40.5, 52), (40, 68), (36, 68)), GOLD)
    lay(area((40.2, 40), (60, 40), (60, 68), (40.0, 68)), STEEL)

    # Legs.
    lay(area((-40, 74), (60, 74), (60, 112), (-40, 112)), TROUSERS)
    lay(area((2, 88), (60, 88), (60, 112), (2, 112)), BOOT)
    lay(area((2, 85.5), (30, 85.5), (30, 89.5), (2, 89.5)), BELT)
    lay(area((2, 103.4), (60, 103.4), (60, 112), (2, 112)), INK)
    lay(np.abs(area((20, 96), (27, 96), (27, 101), (20, 101))) - 0.6, GOLD)
    lay(area((-40, 83.5), (-3, 83.5), (-3, 112), (-40, 112)), WOOD)
    for rim_y in (85, 101.4):
        lay(np.maximum(np.abs(y - rim_y) - 0.8, x + 3), GRAIN)
    lay(line(0.22, (-20.0, 90), (-19.6, 98)), GRAIN)
    lay(line(0.22, (-16, 88), (-16, 96)), GRAIN)

    # Head: hair behind, skin, beard and mouth, an eye, and a patch's band.
    lay(area((-40, 10), (60, 10), (60, 33), (41, 50), (30, 50.2), (14, 49), (-10, 43), (-14, 42), (-40, 40)), HAIR)
    lay(area((2, 10), (60, 10), (60, 31), (24, 33.5), (16, 31), (11, 34), (5, 30), (2, 22)), SKIN)
    lay(line(2.1, (16, 33.5), (22, 31.0), (27, 33.2), (33.5, 33.0)), HAIR)
    lay(area((24, 36.0), (36, 35.2), (36, 38.4), (27, 38.4)), ROSE)
    lay(oval(0.5, 26.5, 3.4, 4.4), SKIN)
    lay(oval(0.7, 26.8, 1.7, 2.5), ROSE, 0.6)
    lay(oval(0.0, 33.0, 1.7, 1.7) * 1.0, GOLD)
    lay(oval(0.0, 33.0, 0.8, 0.8), HAIR)
    lay(oval(13.5, 29.5, 3.0, 1.9), ROSE, 0.6)
    lay(oval(19.5, 24.0, 4.6, 5.2), WHITE)
    lay(oval(21.3, 24.3, 2.5, 3.1), BLUE)
    lay(oval(21.7, 24.3, 1.5, 2.0), INK)
    lay(oval(20.9, 23.2, 0.7, 0.8), WHITE)
    lay(line(1.2, (14.2, 19.9), (20, 17.6), (25.5, 19.4)), HAIR)

    # Hat with a skull on it.
    lay(np.maximum(y - 16.6, -inside - 100), HAT)
    lay(np.maximum(-inside - 2.3, y - 14.2), GOLD)
    lay(np.maximum(-inside - 0.9, y - 14.2), HAT)
    lay(np.abs(y - 15.6) - 1.0, GOLD)
    for way in (1, -1):
        lay(line(0.75, (8 - 8.5 * way, 1.6), (8 + 8.5 * way, 11.0)), BONE)
        for end in (-1, 1):
            for off in (-0.9, 0.9):
                lay(oval(8 + 8.6 * end * way, 6.3 + 4.8 * end + off, 1.2, 1.2), BONE)
    lay(oval(8, 4.6, 5.0, 4.6), BONE)
    lay(area((5, 6), (11, 6), (10.6, 11), (5.4, 11)), BONE)
    lay(np.minimum(oval(6.1, 5.0, 1.35, 1.5), oval(9.9, 5.0, 1.35, 1.5)), HAT)
    lay(area((8, 6.6), (8.8, 8.0), (7.2, 8.0)), HAT)
    for k in (-1, 0, 1):
        lay(line(0.18, (8 + 1.4 * k, 9.2), (8 + 1.4 * k, 11)), HAT)
    return image.indexed()


def poses():
    """Pose files by name: each foot moved to and fro, each leg longer and shorter, the hips to either side. In metres, for a
    pirate of 1 m."""
    rim = outline()
    (left, top), (right, bottom) = rim.min(axis=0), rim.max(axis=0)

    def share(x, y):
        return np.array([(x - left) / (right - left), (bottom - y) / (bottom - top)])

    def region(x0, y0, x1, y1):
        low, high = share(x0, y1) - 0.001, share(x1, y0) + 0.001
        return f"region: {{min: [{low[0]:.4f}, {low[1]:.4f}, 0], max: [{high[0]:.4f}, {high[1]:.4f}, 1]}}"

    def above(y):
        return region(left, top, right, y)

    feet = {"peg": region(left, ANKLES, 0, bottom), "boot": region(0, ANKLES, right, bottom)}
    texts = {}

    def write(name, about, *handles):
        texts[f"{name}.yaml"] = f"# The pirate: {about}.\nversion: 1\nhandles:\n" + "".join(
            f"  - {{{handle}}}\n" for handle in handles)

    for foot, other in (("peg", "boot"), ("boot", "peg")):
        for name, x, y, about in (("forward", STRIDE, 0, "forward"), ("back", -STRIDE, 0, "back"),
                                  ("long", 0, -STRETCH, "down"), ("short", 0, STRETCH, "up")):
            write(f"{foot}_{name}", f"the foot of the {foot} leg moved {about}", f"{above(HIPS)}, pin: true",
                  f"{feet[other]}, pin: true", f"{feet[foot]}, move: [{x}, {y}, 0]")
    about = "[{:.4f}, {:.4f}, 0.5]".format(*share(0, HIPS))
    for name, way in (("left", -1), ("right", 1)):
        write(f"hips_{name}", f"the body shifted to the {name} above the feet",
              f"{region(left, ANKLES, right, bottom)}, pin: true", f"{above(HIPS)}, move: [{way * STRIDE}, 0, 0]")
        write(f"tilt_{name}", f"the body leaning to the {name} above the hips",
              f"{region(left, HIPS + 3, right, bottom)}, pin: true",
              f"{above(HIPS - 8)}, rotate_deg: {-way * LEAN_DEG}, axis: [0, 0, 1], about: {about}")
    return {name: text.encode() for name, text in texts.items()}


def opened(p):
    """Points of the open chest in the frame of its closed lid: turned about the hinge behind."""
    y, z = p[:, 1] - 0.2, p[:, 2] + 0.12
    cos, sin = np.cos(np.radians(LID_DEG)), np.sin(np.radians(LID_DEG))
    return np.stack([p[:, 0], 0.2 + cos * y - sin * z, -0.12 + cos * z + sin * y], axis=1)


def trunk(p):
    return sculpt.box(p, (0, 0.10, 0), (0.19, 0.10, 0.12), 0.01)


def lid(p):
    q = opened(p)
    return np.maximum(np.maximum(np.hypot(q[:, 1] - 0.20, q[:, 2]) - 0.12, np.abs(q[:, 0]) - 0.19), 0.2 - q[:, 1])


def fittings(p):
    """Hoops around trunk and lid, rims, a lock, and the gold inside: a heap of coins."""
    hoops = np.abs(np.abs(p[:, 0]) - 0.125) - 0.022
    body = np.maximum(trunk(p) - 0.008, np.minimum(hoops, np.abs(p[:, 1] - 0.185) - 0.016))
    top = np.maximum(lid(p) - 0.008, np.minimum(hoops, np.abs(opened(p)[:, 1] - 0.216) - 0.016))
    heap = sculpt.ellipsoid(p, (0, 0.19, 0), (0.172, 0.085, 0.105))
    heap = heap + 0.006 * np.sin(70 * p[:, 0] + 20 * p[:, 2]) * np.sin(80 * p[:, 2] + 3)
    lock = sculpt.box(p, (0, 0.16, 0.125), (0.03, 0.035, 0.015), 0.006)
    return np.min([body, top, heap, lock], axis=0)


def treasure():
    parts = []
    for name, shape, color in (("wood", lambda p: np.minimum(trunk(p), lid(p)), (0.26, 0.11, 0.04)),
                               ("gold", fittings, (0.80, 0.55, 0.14))):
        vertices, triangles = sculpt.surface(shape, (-0.24, -0.04, -0.42), (0.24, 0.52, 0.18), 0.0125)
        parts.append({"name": name, "positions": vertices, "triangles": triangles, "color": color, "metallic": 0.0,
                      "roughness": 0.4})
    return files.glb_bytes("treasure", parts, generator="assets/pirate/make.py")


def make():
    return {"pirate.png": files.png_bytes(*paint()), "treasure.glb": treasure(), **poses()}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes the pirate's picture, poses and treasure.")
