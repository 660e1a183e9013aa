"""The tubes of Figure 5, two poses of one mesh: `tube.ply` is straight, 1 m long around the y axis; `helix.ply` is bent
round a helix without twisting it, so that its length stays. `python3 make_tubes.py` writes both beside this file;
`--check` compares instead."""

import pathlib
import sys

import numpy as np

AROUND, ALONG = 14, 90
RADIUS = 0.03  # m
TURNS = 2.0
CLIMB = np.radians(30.0)  # of the helix


def straight():
    s, angle = lattice()
    return np.stack([RADIUS * np.cos(angle), s, RADIUS * np.sin(angle)], axis=1)


def helix():
    """Circles across the helix, turned back by its torsion: the frame along it does not twist."""
    s, angle = lattice()
    rho = 1.0 / (2 * np.pi * TURNS)  # arc length per radian
    a, b = rho * np.cos(CLIMB), rho * np.sin(CLIMB)
    phi = s / rho
    cos, sin, zero = np.cos(phi), np.sin(phi), np.zeros_like(phi)
    centre = np.stack([a * cos, b * phi, a * sin], axis=1)
    tangent = np.stack([-a * sin, b + zero, a * cos], axis=1) / rho
    normal = np.stack([-cos, zero, -sin], axis=1)
    binormal = np.cross(tangent, normal)
    turn = (-b / rho**2 * s)[:, None]  # minus the torsion
    u = np.cos(turn) * normal + np.sin(turn) * binormal
    v = np.cross(u, tangent)
    return centre + RADIUS * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v)


def lattice():
    """Arc length and angle of every vertex, ring after ring."""
    j, i = np.divmod(np.arange(AROUND * (ALONG + 1)), AROUND)
    return j / ALONG, 2 * np.pi * i / AROUND


def triangles():
    result = []
    for j in range(ALONG):
        for i in range(AROUND):
            a, b = i + AROUND * j, (i + 1) % AROUND + AROUND * j
            c, d = a + AROUND, b + AROUND
            result += [(a, c, b), (b, c, d)] if (i + j) % 2 == 0 else [(a, c, d), (a, d, b)]
    return np.array(result)


def ply(points, faces):
    lines = ["ply", "format ascii 1.0", f"element vertex {len(points)}", "property double x", "property double y",
             "property double z", f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(f"{x:.9f}" for x in np.round(point, 9) + 0.0) for point in points]
    lines += [f"3 {a} {b} {c}" for a, b, c in faces]
    return "\n".join(lines) + "\n"


def main():
    folder = pathlib.Path(__file__).parent
    for name, points in (("tube.ply", straight()), ("helix.ply", helix())):
        text = ply(points, triangles())
        if "--check" in sys.argv[1:]:
            if (folder / name).read_text() != text:
                sys.exit(f"{name} is not what make_tubes.py makes")
        else:
            (folder / name).write_text(text)


if __name__ == "__main__":
    main()
