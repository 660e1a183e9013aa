#!/usr/bin/env python3
"""Makes teacup.glb, table.glb, wood.png and room.exr beside this file.

    make_teacup.py            writes them
    make_teacup.py --check    makes them in memory and compares with the files; exit code 1 when they differ
    make_teacup.py --output D writes into folder D

Needs Python 3 with NumPy.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import cup
import files
import generator
import stage
import wood
from surface import verify


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


if __name__ == "__main__":
    generator.main(make, __file__, "Makes the assets of the tea cup scene.")
