#!/usr/bin/env python3
"""Makes teacup.glb, mug.glb, espresso.glb, table.glb, wood.png and room.exr beside this file.

    make_teacup.py            writes them
    make_teacup.py --check    makes them in memory and compares with the files; exit code 1 when they differ
    make_teacup.py --output D writes into folder D

Needs Python 3 with NumPy.
"""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import cup
import files
import generator
import stage
import wood
from surface import verify


COFFEE = ((0.035, 0.012, 0.004), 0.0, 0.06)
PLUM, MUSTARD = ((0.30, 0.055, 0.13), 0.0, 0.1), ((0.66, 0.34, 0.03), 0.0, 0.1)
DESIGNS = {
    "teacup": cup.Design(),
    "mug": cup.Design(
        height=1.25, radii=((0.0, 1.02), (0.10, 1.0), (0.25, 0.80), (0.5, 0.735), (0.75, 0.77), (1.0, 0.76)),
        reach=0.85, thickness=1.0, face=0.95, face_height=0.55, belly=0.440,
        mood=cup.Mood(iris=0.95, brow_lift=0.010, brow_tilt=0.0, lid=(0.18, 0.10), mouth=(0.070, 0.030, 0.030)),
        looks={"porcelain": PLUM, "lid": PLUM, "tea": COFFEE}),
    "espresso": cup.Design(
        height=0.66, radii=((0.0, 0.70), (0.1, 0.62), (0.3, 0.57), (0.6, 0.63), (0.85, 0.68), (1.0, 0.70)),
        reach=0.6, thickness=0.7, face=0.62, face_height=0.49, belly=0.36,
        mood=cup.Mood(iris=0.60, brow_lift=0.035, brow_tilt=0.02, mouth=(0.056, 0.095, -0.004)),
        looks={"porcelain": MUSTARD, "tea": COFFEE}),
}


def make_cup(name):
    parts, (vertices, triangles) = cup.make(DESIGNS[name])
    volume = verify(vertices, triangles, genus=1)
    total = sum(len(part["triangles"]) for part in parts)
    size = " x ".join(f"{x:.3f}" for x in np.ptp(vertices, axis=0))
    assert vertices[:, 1].min() == 0.0, f"{name} does not stand on y = 0"
    assert 20000 <= total <= 45000, f"{total} triangles"
    print(f"{name}: {total} triangles, body {len(triangles)} triangles, {len(vertices)} vertices, closed, genus 1, "
          f"volume {volume:.6f} m3, {size} m")
    return files.glb_bytes(name, parts)


def make():
    """File name -> bytes."""
    top, slab, uv = stage.table()
    print(f"table: {len(slab)} triangles, closed, volume {verify(top, slab, genus=0):.3f} m3")
    indices, palette = wood.make()
    look = {"metallic": 0.0, "roughness": 0.5}
    return {
        **{f"{name}.glb": make_cup(name) for name in DESIGNS},
        "table.glb": files.glb_bytes("table", [{"name": "wood", "positions": top, "triangles": slab, "uv": uv,
                                                "color": (0.45, 0.25, 0.12), **look}]),
        "wood.png": files.png_bytes(indices, palette),
        "room.exr": files.exr_bytes(stage.surroundings()),
    }


if __name__ == "__main__":
    generator.main(make, __file__, "Makes the tea cups, their table and their light.")
