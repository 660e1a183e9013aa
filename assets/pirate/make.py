"""Paints pirate.png for the outline in pirate.svg: it fills the box around it. `python3 make.py` writes it beside this file;
`--check` compares instead."""

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
    lay(area((-40, 74), (60, 74), (60, 105), (-40, 105)), TROUSERS)
    lay(area((2, 82.5), (60, 82.5), (60, 105), (2, 105)), BOOT)
    lay(area((2, 80.5), (30, 80.5), (30, 84.5), (2, 84.5)), BELT)
    lay(area((2, 97.6), (60, 97.6), (60, 105), (2, 105)), INK)
    lay(np.abs(area((20, 90), (27, 90), (27, 95), (20, 95))) - 0.6, GOLD)
    lay(area((-40, 79), (-3, 79), (-3, 105), (-40, 105)), WOOD)
    lay(np.maximum(np.abs(y - 85.6) - 0.8, x + 3), GRAIN)
    lay(np.maximum(np.abs(y - 98.8) - 1.2, x + 3), GRAIN)
    lay(line(0.22, (-17.6, 88), (-17.2, 96)), GRAIN)
    lay(line(0.22, (-14, 90), (-14, 97)), GRAIN)

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


def make():
    return {"pirate.png": files.png_bytes(*paint())}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes pirate.png.")
