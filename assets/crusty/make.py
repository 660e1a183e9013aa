"""Crusty, a slice of toast of 1 m on two short legs, with a headband and running shoes. It looks to +z and stands on y = 0,
its feet at x = -0.2 and 0.2 m. `python3 make.py` writes crusty.glb beside this file, and the example poses of
configs/crusty_race.yaml; `--check` compares instead."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import character
import generator
import sculpt
from face import ellipse, Face, lips

CELL = 0.0128  # m
HALF = 0.15  # half thickness of the slice
LOOKS = {
    **character.FACE, "crust": ((0.3, 0.1, 0.02), 0.4), "crumb": ((0.78, 0.53, 0.24), 0.6),
    "band": ((0.55, 0.022, 0.02), 0.25), "shoe": ((0.55, 0.022, 0.02), 0.25), "sole": ((0.82, 0.79, 0.72), 0.3),
    "iris": ((0.04, 0.13, 0.3), 0.06), "brow": ((0.05, 0.022, 0.01), 0.25),
}
PORES = np.random.Generator(np.random.PCG64(7)).random((70, 4))


def slice_(p):
    """Distance of the slice's outline, seen from the front."""
    x, y = np.hypot(p[:, 0], 0.03), p[:, 1]
    q = np.stack([x - 0.325, np.abs(y - 0.575) - 0.345], axis=1) + 0.09
    loaf = np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0) - 0.09
    return sculpt.union(loaf, np.hypot(x - 0.195, y - 0.795) - 0.195, 0.10)


def pores():
    """Balls (#P by 4) that leave dents in both cut sides, away from the face and the band."""
    found = []
    for a, b, c, d in PORES:
        x, y, side, r = 0.52 * a - 0.26, 0.32 + 0.56 * b, np.sign(c - 0.5), 0.012 + 0.012 * d
        if abs(y - 0.75) > 0.10 and (side < 0 or np.hypot(x / 0.21, (y - 0.52) / 0.24) > 1):
            found.append((x, y, side * (HALF - 0.008), r))
    return np.array(found)


DENTS = pores()


def dents(p):
    near = np.abs(p[:, 2]) > HALF - 0.06
    d = np.full(len(p), 0.05)
    d[near] = np.min(np.linalg.norm(p[near][:, None] - DENTS[None, :, :3], axis=2) - DENTS[:, 3], axis=1)
    return d


def bread(p):
    outline = slice_(p)
    inner = np.clip((-outline - 0.035) / 0.03, 0, 1)
    return sculpt.slab(outline, np.abs(p[:, 2]) - HALF + 0.012 * inner**2 * (3 - 2 * inner), 0.045)


def band(p):
    height = np.abs(p[:, 1] - 0.755 + 0.10 * p[:, 0]**2) - 0.040
    return sculpt.slab(height, bread(p) - 0.016, 0.014)


def feet(p):
    q = np.stack([np.abs(p[:, 0]), p[:, 1], p[:, 2]], axis=1)
    shoe = sculpt.union(sculpt.ellipsoid(q, (0.205, 0.045, 0.115), (0.125, 0.105, 0.150)),
                        sculpt.ellipsoid(q, (0.195, 0.050, -0.055), (0.110, 0.120, 0.130)), 0.08)
    return q, sculpt.common(shoe, -p[:, 1], 0.03)


def shape(p):
    q, shoe = feet(p)
    leg = sculpt.capsule(q, (0.195, 0.15, -0.03), (0.195, 0.35, -0.01), 0.083)
    legs = sculpt.union(leg, shoe, 0.03)
    return sculpt.union(sculpt.union(sculpt.minus(bread(p), dents(p), 0.012), band(p), 0.008), legs, 0.06)


# Poses: low ones are wound up about the vertical, high ones the other way, so that the jump from low to high unwinds.
RISE, TWIST = 0.15, 42  # of what is above the legs: m, degrees
LEAN, LIFT, STEP = 0.30, 0.06, 0.12  # m: to the front or back; of one foot over the other, above and before it


def pose(about, rise, twist, lean=0.0, lift=0.0, step=0.0):
    """A pose file: the left foot is raised and put forward, the right one lowered and put back; the top is moved and turned."""
    foot = f"move: [0, {0.5 * lift:.3g}, {step:.3g}]" if lift or step else "pin: true"
    other = f"move: [0, {0 - 0.5 * lift:.3g}, {0 - step:.3g}]" if lift or step else "pin: true"
    return f"""# Crusty, {about}.
version: 1
handles:
  - {{region: {{min: [0.5, 0, 0], max: [1, 0.15, 1]}}, {foot}}}
  - {{region: {{min: [0, 0, 0], max: [0.5, 0.15, 1]}}, {other}}}
  - {{region: {{min: [0, 0.65, 0], max: [1, 1, 1]}}, move: [0, {rise:.3g}, {lean:.3g}], rotate_deg: {twist}}}
""".encode()


def poses():
    files = {}
    for name, about, side in (("low", "crouched and wound up", 1), ("high", "stretched and unwound", -1)):
        base = {"rise": -side * RISE, "twist": side * TWIST}
        files[f"{name}.yaml"] = pose(about, **base)
        files[f"{name}_forward.yaml"] = pose(f"{about}, to the front", **base, lean=LEAN)
        files[f"{name}_back.yaml"] = pose(f"{about}, to the back", **base, lean=-LEAN)
        files[f"{name}_left.yaml"] = pose(f"{about}, to the left", **base, lift=LIFT)
        files[f"{name}_right.yaml"] = pose(f"{about}, to the right", **base, lift=-LIFT)
        files[f"{name}_step.yaml"] = pose(f"{about}, in a step", **base, step=side * STEP)
    return files


def make():
    vertices, triangles = sculpt.surface(shape, (-0.46, -0.05, -0.30), (0.46, 1.06, 0.34), CELL)
    names = np.full(len(triangles), "crust", dtype=object)
    body = sculpt.paint(shape, vertices, triangles, names,
                        lambda p: np.maximum(slice_(p) + 0.058, 0.08 - np.abs(p[:, 2])), "crumb")
    body = sculpt.paint(shape, *body, lambda p: np.maximum(np.abs(p[:, 1] - 0.755 + 0.10 * p[:, 0]**2) - 0.050,
                                                           0.7 - p[:, 1]), "band")
    body = sculpt.paint(shape, *body, lambda p: p[:, 1] - 0.125 - 0.25 * p[:, 2] * (p[:, 2] < 0), "shoe")
    body = sculpt.paint(shape, *body, lambda p: p[:, 1] - 0.040, "sole")

    face, parts = Face(sculpt.chart(bread, (0, 0.53, 0.5), (1, 0, 0), (0, 1, 0))), []
    for side in (-1, 1):
        parts += face.eye(0.108 * side, 0.065, 0.082, 0.102, 0.034, -0.06 * side, look=(-0.10 * side, 0.0))
        parts.append(("brow", *face.brow(side, 0.112, 0.070, lambda t: 0.172 + 0.014 * t - 0.006 * t**2, 0.017,
                                         lift=0.012)))
        parts.append(("blush", *face.dome(ellipse(0.195 * side, -0.065, 0.045, 0.030), 0.0022, None, 6.0, 0.003, 8)))

    mouth = lips(0.095, -0.115, 0.016, 0.070, 0.035, 0.095, 0.12)
    teeth = lips(0.070, -0.114, 0.008, 0.026, 0.035, 0.095, 0.12)
    parts.append(("mouth", *face.dome(mouth, 0.003, None, 10.0, 0.003, 12, 64)))
    parts.append(("teeth", *face.dome(teeth, 0.008, None, 8.0, 0.001, 8, 40)))
    return {"crusty.glb": character.glb("crusty", "assets/crusty/make.py", body, parts, LOOKS), **poses()}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes crusty.glb and its poses.")
