"""Makes letters.svg, the outlines of the letters that spell SIGGRAPH, from a font (the package fonts-dejavu-core). Those
that would not stand, as their bottom is round or to one side, get a foot below their centre of mass; the serifs of those that
walk reach equally near to below it from either side.
`python3 make.py` writes it beside this file; `--check` compares instead."""

import pathlib
import struct
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import generator

FONT = pathlib.Path("/usr/share/fonts/truetype/dejavu/DejaVuSerif-Bold.ttf")
LETTERS = "SIGRAPH"
HEIGHT = 100  # units of the drawing
FEET = {"S": 38, "G": 42, "P": 36}  # half the width of the foot of letters that would not stand, units
SERIFS = {  # where serifs that face one another end, and where they shall, units: farther apart than half a step
    "A": {29.7: 46, 62.2: 60},
    "H": {51.4: 44, 65.6: 73},
    "R": {51.4: 44, 75.5: 59},
}
FOOT, BEVEL = 11, 2  # its height; by how much it is narrower above on either side
CURVE = 8  # pieces that a curve becomes


class TrueType:
    """Outlines of a TrueType font's simple glyphs."""

    def __init__(self, data):
        self.data = data
        self.tables = {}
        for i in range(struct.unpack_from(">H", data, 4)[0]):
            tag, _, offset, _ = struct.unpack_from(">4sIII", data, 12 + 16 * i)
            self.tables[tag.decode()] = offset

    def read(self, form, table, offset):
        return struct.unpack_from(">" + form, self.data, self.tables[table] + offset)

    def glyph_index(self, letter):
        """By the character map for Unicode's basic plane (format 4)."""
        for i in range(self.read("H", "cmap", 2)[0]):
            start = self.read("HHI", "cmap", 4 + 8 * i)[2]
            form, _, _, twice = self.read("4H", "cmap", start)
            if form != 4:
                continue
            n = twice // 2
            last = self.read(f"{n}H", "cmap", start + 14)
            first = self.read(f"{n}H", "cmap", start + 16 + twice)
            delta = self.read(f"{n}H", "cmap", start + 16 + 2 * twice)
            jump = self.read(f"{n}H", "cmap", start + 16 + 3 * twice)
            k = next(k for k in range(n) if ord(letter) <= last[k])
            if jump[k] == 0:
                return (ord(letter) + delta[k]) % 65536
            place = start + 16 + 3 * twice + 2 * k + jump[k] + 2 * (ord(letter) - first[k])
            return (self.read("H", "cmap", place)[0] + delta[k]) % 65536
        raise ValueError("the font has no character map of format 4")

    def loops(self, letter):
        """Closed loops of a letter: lists of (x, y, on the curve) in font units, y upwards."""
        long = self.read("h", "head", 50)[0]
        index = self.glyph_index(letter)
        start = self.read("I", "loca", 4 * index)[0] if long else 2 * self.read("H", "loca", 2 * index)[0]
        count = self.read("h", "glyf", start)[0]
        if count < 0:
            raise ValueError(f"{letter} is made of other glyphs")
        ends = self.read(f"{count}H", "glyf", start + 10)
        at = start + 10 + 2 * count
        at += 2 + self.read("H", "glyf", at)[0]  # hinting
        flags = []
        while len(flags) <= ends[-1]:
            flag, repeats = self.read("BB", "glyf", at)
            again = flag & 8
            flags += [flag] * (1 + repeats if again else 1)
            at += 2 if again else 1
        columns = []
        for short, same in ((2, 16), (4, 32)):
            value, column = 0, []
            for flag in flags:
                if flag & short:
                    step = self.read("B", "glyf", at)[0]
                    value += step if flag & same else -step
                    at += 1
                elif not flag & same:
                    value += self.read("h", "glyf", at)[0]
                    at += 2
                column.append(value)
            columns.append(column)
        points = [(x, y, bool(flag & 1)) for x, y, flag in zip(*columns, flags)]
        return [points[a:b] for a, b in zip((0, *(e + 1 for e in ends)), (e + 1 for e in ends))]


def polygon(loop):
    """Corners (#P by 2) of a loop of straight lines and quadratic curves."""
    full = []  # with the points on the curve that lie between two others' control points
    for a, b in zip(loop, loop[1:] + loop[:1]):
        full.append(a)
        if not a[2] and not b[2]:
            full.append(((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, True))
    first = next(i for i, point in enumerate(full) if point[2])
    full = full[first:] + full[:first + 1]
    corners = []
    for i, point in enumerate(full[:-1]):
        if point[2]:
            corners.append(point[:2])
            continue
        a, b, c = (np.array(p[:2], float) for p in full[i - 1:i + 2])
        for t in np.arange(1, CURVE) / CURVE:
            corners.append(tuple((1 - t)**2 * a + 2 * t * (1 - t) * b + t**2 * c))
    return np.array(corners, float)


def centre(polygons):
    """Centroid of the area; holes run the other way round."""
    area, moment = 0, np.zeros(2)
    for p in polygons:
        q = np.roll(p, -1, axis=0)
        cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
        area += cross.sum() / 2
        moment += ((p + q) * cross[:, None]).sum(axis=0) / 6
    return moment / area


def outline(font, letter):
    """Polygons in units of the drawing, y upwards: HEIGHT high, standing on y = 0, from x = 0 on."""
    polygons = [polygon(loop) for loop in font.loops(letter)]
    points = np.concatenate(polygons)
    low, high = points.min(axis=0), points.max(axis=0)
    polygons = [(p - low) * HEIGHT / (high[1] - low[1]) for p in polygons]
    for p in polygons:
        p[:, 0] = [SERIFS.get(letter, {}).get(round(x, 1), x) if y < FOOT else x for x, y in p]
    if letter in FEET:
        half = FEET[letter]
        x = centre(polygons)[0]
        polygons.append(np.array([(x - half, 0), (x - half + BEVEL, FOOT), (x + half - BEVEL, FOOT), (x + half, 0)]))
    left = np.concatenate(polygons)[:, 0].min()
    return [p - (left, 0) for p in polygons]


def make():
    font = TrueType(FONT.read_bytes())
    paths, x = [], 0
    for letter in LETTERS:
        polygons = outline(font, letter)
        text = " ".join(
            "M " + " L ".join(f"{x + px:.2f},{HEIGHT - py:.2f}" for px, py in polygon) + " Z" for polygon in polygons)
        paths.append(f'  <path id="{letter}" d="{text}"/>\n')
        x += np.concatenate(polygons)[:, 0].max() + 10
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {x - 10:.2f} {HEIGHT}">\n{"".join(paths)}</svg>\n'
    return {"letters.svg": svg.encode()}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes letters.svg.")
