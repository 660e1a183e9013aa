"""Paints castle.png, the picture of the castles of configs/castle_solid.yaml and castle_rod.yaml, 0.84 m by 1 m: stones, a
face that looks to +x; and bricks.png, stones that repeat in both directions, for walls. `python3 make.py` writes them beside
this file; `--check` compares instead."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import files
import generator
from picture import Picture

WIDTH, HEIGHT = 0.84, 1.0  # m
SAND, MORTAR, INK = (232, 190, 122), (140, 96, 56), (28, 20, 24)  # sRGB
SLATE, GAP = (150, 154, 166), (84, 86, 96)
WHITE, BLUE, ROSE, MOUTH, TONGUE = (252, 252, 250), (40, 96, 170), (226, 112, 84), (92, 20, 24), (222, 100, 92)


def stones(image, color, gap, width, height):
    """Lays courses of stones of this size (m), each a little lighter or darker, every second course shifted by half."""
    course = np.floor(image.y / height).astype(int)
    shifted = image.x / width + 0.5 * (course % 2)
    stone = np.floor(shifted).astype(int)
    across, up = np.abs(shifted - stone - 0.5) * width, np.abs(image.y / height - course - 0.5) * height
    # The columns of a picture of a whole number of stones repeat.
    columns = round((image.x.max() - image.x.min()) / width)
    shade = np.sin(12.9898 * (stone % columns) + 78.233 * course) * 43758.5453 % 1.0
    image.image[:] = np.array(color) * (0.80 + 0.27 * shade[..., None])
    image.lay(np.minimum(0.5 * width - across, 0.5 * height - up) - 0.05 * height, gap)


def bricks():
    image = Picture((320, 320), (0, 0), (1, 1), SLATE)
    stones(image, SLATE, GAP, 0.25, 0.125)
    return image.indexed()


def castle():
    image = Picture((600, 504), (-WIDTH / 2, 0), (WIDTH / 2, HEIGHT), SAND)
    x, y, lay = image.x, image.y, image.lay
    stones(image, SAND, MORTAR, 0.14, 0.0715)

    def oval(cx, cy, a, b):
        return (np.hypot((x - cx) / a, (y - cy) / b) - 1) * min(a, b)

    lay(np.abs(y - 0.79) - 0.014, MORTAR)  # the ledge below the battlements
    for side in (-1, 1):
        middle = 0.02 + 0.125 * side
        lay(oval(middle, 0.665, 0.092, 0.112), INK)
        lay(oval(middle, 0.665, 0.082, 0.102), WHITE)
        lay(oval(middle + 0.026, 0.655, 0.050, 0.066), BLUE)
        lay(oval(middle + 0.030, 0.655, 0.030, 0.042), INK)
        lay(oval(middle + 0.014, 0.682, 0.014, 0.017), WHITE)
        lay(oval(0.02 + 0.235 * side, 0.545, 0.042, 0.028), ROSE, 0.9)
        lay(np.maximum(np.abs(y - 0.835 + 1.6 * (x - middle)**2) - 0.013, np.abs(x - middle) - 0.075), INK)
    u = x - 0.02
    smile = np.maximum(y - 0.520 - 2.0 * u**2, np.hypot(u / 0.125, (y - 0.535) / 0.085) * 0.085 - 0.085)
    lay(smile - 0.008, INK)
    lay(smile, MOUTH)
    lay(np.maximum(smile, oval(0.02, 0.455, 0.06, 0.03)), TONGUE)
    return image.indexed()


def make():
    return {"castle.png": files.png_bytes(*castle()), "bricks.png": files.png_bytes(*bricks())}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes the castle's picture and the stones of walls.")
