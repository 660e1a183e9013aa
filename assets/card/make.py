"""Ace, the ace of spades: a card of 0.7 m by 1 m, bent about the vertical so that it can stand on its two lower corners:
its chest is at +z, and it leans back until its middle is above its feet. Its picture, on both sides, is the same from the
left and from the right. `python3 make.py` writes card.glb, its cage cage.glb, and card.png beside this file; `--check`
compares instead."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import files
import generator
from picture import Picture

WIDTH, HEIGHT = 0.7, 1.0  # m
CORNER = 0.045  # cut off the corners (m); a coarse shell keeps straight cuts
FOOT, ARCH = 0.15, 0.055  # where the feet end (m from the middle), and the height of the arch between them
RADIUS = 0.27  # of the bend (m)
COLUMNS, ROWS = 64, 84
PIXELS = (1000, 700)
PAPER, INK, WHITE = (250, 244, 230), (24, 22, 30), (252, 252, 250)  # sRGB
BLUE, MOUTH, ROSE = (52, 112, 168), (196, 54, 58), (232, 132, 122)


def card():
    """Vertices, triangles and texture coordinates of the card."""
    half = WIDTH / 2
    x = np.linspace(0, half - CORNER, COLUMNS // 2 - 2)
    for place in (FOOT, FOOT - ARCH):
        x[np.argmin(np.abs(x - place))] = place
    x = np.concatenate([x, [half - CORNER / 2, half]])
    x = np.concatenate([-x[:0:-1], x])
    cut = np.maximum(np.abs(x) - half + CORNER, 0)
    low = np.clip(FOOT - np.abs(x), 0, ARCH) + cut
    high = HEIGHT - cut
    t = np.linspace(0, 1, ROWS + 1)[:, None]
    y = low + t * (high - low)
    vertices = np.stack([np.broadcast_to(x, y.shape), y, np.zeros_like(y)], axis=2).reshape(-1, 3)
    j, i = np.divmod(np.arange(ROWS * (len(x) - 1)), len(x) - 1)
    a = j * len(x) + i
    b, c, d = a + 1, a + len(x) + 1, a + len(x)
    even = ((i + j) % 2 == 0)[:, None]
    one = np.where(even, np.stack([a, b, c], 1), np.stack([a, b, d], 1))
    two = np.where(even, np.stack([a, c, d], 1), np.stack([b, c, d], 1))
    uv = np.stack([vertices[:, 0] / WIDTH + 0.5, 1 - vertices[:, 1] / HEIGHT], axis=1)
    return bent(vertices), np.stack([one, two], axis=1).reshape(-1, 3), uv


def bent(vertices):
    """The flat card round a cylinder, leaning so far that its centre is above the middle of its feet."""
    def depth(x):
        return RADIUS * (np.cos(x / RADIUS) - 1)

    x, y, _ = vertices.T
    feet = depth(np.array([FOOT, WIDTH / 2 - CORNER])).mean()
    lean = (feet - depth(np.linspace(0, WIDTH / 2, 100)).mean()) / (HEIGHT / 2)
    return np.stack([RADIUS * np.sin(x / RADIUS), y, depth(x) + lean * y - depth(FOOT)], axis=1)


def cage():
    """Vertices and triangles of a cage round the card: four corners below and above it, and six points round its middle,
    where it bends; the same from the left and from the right."""
    def ring(y, points):
        return [(x, y, z) for x, z in points]

    back, front, side = -0.23, 0.08, 0.28
    corners = [(-side, back), (side, back), (0.72 * side, front), (-0.72 * side, front)]
    middle = [(-side, back), (0, back + 0.05), (side, back), (side, -0.05), (0, front + 0.03), (-side, -0.05)]
    vertices = ring(-0.07, corners) + ring(0.45 * HEIGHT, middle) + ring(HEIGHT + 0.055, corners)
    m = range(4, 10)

    def band(b):  # from the four corners b to the middle
        return [(b[0], m[0], m[1]), (b[0], m[1], b[1]), (b[1], m[1], m[2]), (b[1], m[2], m[3]), (b[1], m[3], b[2]),
                (b[2], m[3], m[4]), (b[2], m[4], b[3]), (b[3], m[4], m[5]), (b[0], m[5], m[0]), (b[0], b[3], m[5]),
                (b[0], b[1], b[2]), (b[0], b[2], b[3])]

    triangles = np.array(band(range(4)) + [t[::-1] for t in band(range(10, 14))])
    return np.array(vertices), triangles


def spade(x, y):
    """Distance of a spade from about -1 to 1 in both directions."""
    x = np.abs(x)
    round_ = np.hypot(x - 0.43, y + 0.22) - 0.43
    t = np.clip((y + 0.22) / 1.22, 0, 1)
    leaf = np.maximum(0.75 * (x - 0.86 * (0.5 + 0.5 * np.cos(np.pi * t))**0.72), np.maximum(-0.22 - y, y - 1))
    middle = np.maximum(np.maximum(x - 0.43, y), -0.34 - y)
    stem = np.maximum(np.maximum(y + 0.15, -0.95 - y), x - 0.06 - 0.62 * np.maximum(-0.30 - y, 0)**1.6)
    return np.min([round_, leaf, middle, stem], axis=0)


def letter(x, y):
    """Distance of a letter A from -1 to 1 in height."""
    x = np.abs(x)
    slope = np.array([0.62, 2.0]) / np.hypot(0.62, 2.0)
    leg = np.abs((x - 0.06) * slope[1] + (y - 1.0) * slope[0]) - 0.15
    leg = np.maximum(leg, np.abs(y) - 1)
    serif = np.maximum(np.abs(y + 0.94) - 0.06, np.abs(x - 0.66) - 0.25)
    bar = np.maximum(np.abs(y + 0.30) - 0.09, x - 0.45)
    return np.min([leg, serif, bar], axis=0)


def picture():
    """(indices, palette) of the card's picture."""
    image = Picture(PIXELS, (-WIDTH / 2, 0), (WIDTH / 2, HEIGHT), PAPER)
    x, y, lay = image.x, image.y, image.lay

    def oval(cx, cy, a, b):
        return (np.hypot((np.abs(x) - cx) / a, (y - cy) / b) - 1) * min(a, b)

    frame = np.maximum(np.abs(x) - 0.232, np.abs(y - 0.5) - 0.442)
    lay(np.abs(frame) - 0.0022, INK)
    lay(np.abs(frame + 0.010) - 0.0010, INK)
    lay(0.23 * spade(x / 0.23, (y - 0.515) / 0.265), INK)
    for turn in (1, -1):  # the corners, the lower one upside down
        u, v = turn * x + 0.290, turn * (y - 0.5) - 0.405
        lay(0.042 * letter(u / 0.036, v / 0.042), INK)
        lay(0.030 * spade(u / 0.032, (v + 0.092) / 0.034), INK)
    # The face on the spade.
    lay(oval(0.068, 0.510, 0.047, 0.063), WHITE)
    lay(oval(0.060, 0.505, 0.028, 0.039), BLUE)
    lay(oval(0.060, 0.505, 0.016, 0.024), INK)
    lay(oval(0.051, 0.520, 0.008, 0.010), WHITE)
    lay(oval(0.145, 0.440, 0.023, 0.014), ROSE, 0.9)
    t = (np.abs(x) - 0.068) / 0.036
    lay(np.maximum(np.abs(y - 0.598 - 0.012 * (1 - t**2)) - 0.007, 0.04 * (np.abs(t) - 1)), WHITE)
    smile = y - 0.422 - 3.0 * x**2
    lay(np.maximum(np.maximum(smile, np.hypot(x / 0.078, (y - 0.430) / 0.056) * 0.056 - 0.056), -1), WHITE)
    inner = np.maximum(smile + 0.008, np.hypot(x / 0.069, (y - 0.430) / 0.047) * 0.047 - 0.047)
    lay(inner, MOUTH)
    return image.indexed()


def make():
    vertices, triangles, uv = card()
    print(f"card: {len(triangles)} triangles, {len(vertices)} vertices, lowest {vertices[:, 1].min():.4f} m")
    look = {"color": (1.0, 1.0, 1.0), "metallic": 0.0, "roughness": 0.4}
    part = {"name": "card", "positions": vertices, "triangles": triangles, "uv": uv, **look}
    corners, faces = cage()
    round_it = {"name": "cage", "positions": corners, "triangles": faces, **look}
    return {"card.glb": files.glb_bytes("card", [part], generator="assets/card/make.py"),
            "cage.glb": files.glb_bytes("cage", [round_it], generator="assets/card/make.py"),
            "card.png": files.png_bytes(*picture())}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes card.glb, cage.glb and card.png.")
