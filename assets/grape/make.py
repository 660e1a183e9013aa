"""An angry grape, 0.25 m high without its stem, round the y axis; it looks to +z and touches y = 0 in one point.
`python3 make.py` writes grape.glb beside this file; `--check` compares instead. There are many of it, so it is not fine."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
import character
import generator
import sculpt
from face import Face

LOOKS = {
    **character.FACE, "skin": ((0.11, 0.012, 0.085), 0.12), "stem": ((0.13, 0.1, 0.02), 0.5),
    "lid": ((0.065, 0.007, 0.05), 0.2), "iris": ((0.42, 0.07, 0.008), 0.06), "brow": ((0.02, 0.004, 0.016), 0.4),
}


def shape(p):
    """An egg, its thick end down."""
    q = p - (0, 0.125, 0)
    width = 0.112 - 0.14 * q[:, 1:2] * (0.125 + q[:, 1:2])  # m, at that height
    q = q * np.concatenate([0.125 / width, np.ones_like(width), 0.125 / width], axis=1)
    return (np.linalg.norm(q, axis=1) - 0.125) * 0.85


def stem(p):
    bar = sculpt.capsule(p, (0, 0.240, 0), (0.006, 0.262, 0.002), 0.0075)
    return sculpt.union(bar, sculpt.ellipsoid(p, (0.007, 0.266, 0.002), (0.013, 0.006, 0.013)), 0.008)


def make():
    vertices, triangles = sculpt.surface(shape, (-0.14, -0.02, -0.14), (0.14, 0.27, 0.14), 0.0095)
    body = vertices, triangles, np.full(len(triangles), "skin", dtype=object)
    face = Face(sculpt.chart(shape, (0, 0.128, 0.16), (1, 0, 0), (0, 1, 0)))
    parts = [("stem", *sculpt.surface(stem, (-0.02, 0.22, -0.02), (0.03, 0.28, 0.03), 0.004))]
    for side in (-1, 1):
        parts += face.eye(0.041 * side, 0.020, 0.031, 0.036, 0.013, 0.0, look=(-0.18 * side, -0.12), pupil=0.56,
                          lid=(0.30, 0.55 * side), around=30)
        parts.append(("brow", *face.brow(side, 0.043, 0.032, lambda t: 0.052 + 0.015 * t + 0.003 * t**2, 0.0072, 17,
                                         lift=0.009, around=10)))

    def mouth(rho, psi):
        x, y = rho * np.cos(psi), rho * np.sin(psi)
        return 0.040 * x, -0.044 + y * np.where(y > 0, 0.015, 0.009) - 0.016 * x**2

    def teeth(middle):
        def outline(rho, psi):
            x, y = middle + 0.0058 * rho * np.cos(psi), rho * np.sin(psi)
            return x, -0.0355 + 0.0085 * y * np.where(y > 0, 0.35, 1.0) - 10.0 * x**2
        return outline

    parts.append(("mouth", *face.dome(mouth, 0.0012, None, 10.0, 0.002, 6, 40)))
    parts += [("teeth", *face.dome(teeth(x), 0.004, None, 6.0, 0.0005, 4, 20)) for x in (-0.019, -0.0065, 0.0065, 0.019)]
    return {"grape.glb": character.glb("grape", "assets/grape/make.py", body, parts, LOOKS)}


if __name__ == "__main__":
    generator.main(make, __file__, "Makes grape.glb.")
