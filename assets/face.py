"""Faces: closed pillows and tubes set onto a body, in a chart of its surface: u to the right as seen from in front of the
face, v upwards (metres)."""

import numpy as np

from surface import signed_volume


class Face:
    def __init__(self, frame):
        """frame(u, v): points on the body and its outward normals there, two arrays of u's shape by 3."""
        self.frame = frame

    def dome(self, outline, height, base=None, power=2.0, sink=0.004, rings=10, around=48):
        """A closed pillow over the star-shaped region outline(rho, psi) -> (u, v), its edge `sink` below the base."""
        rho = np.sin(np.linspace(0, np.pi / 2, rings + 1)[1:])
        psi = 2 * np.pi * np.arange(around) / around
        grid_rho, grid_psi = np.meshgrid(np.concatenate([[0.0], rho]), psi, indexing="ij")
        u, v = outline(grid_rho, grid_psi)
        ground = base(u, v) if base else 0.0
        lift = (height + sink) * np.sqrt(np.maximum(1 - grid_rho**power, 0)) - sink + ground
        p, n = self.frame(u, v)
        top = p + n * lift[..., None]
        count = rings * around
        below = p + n * (np.broadcast_to(ground, u.shape)[..., None] - 0.006)
        vertices = np.concatenate([top[:1, 0], top[1:].reshape(-1, 3), below[:1, 0]])
        triangles = []
        ids = 1 + np.arange(count).reshape(rings, around)
        for k in range(around):
            k1 = (k + 1) % around
            triangles.append((0, ids[0, k], ids[0, k1]))
            for j in range(rings - 1):
                triangles += [(ids[j, k], ids[j + 1, k], ids[j + 1, k1]), (ids[j, k], ids[j + 1, k1], ids[j, k1])]
            triangles.append((ids[-1, k], count + 1, ids[-1, k1]))
        triangles = np.array(triangles)
        if signed_volume(vertices - vertices.mean(axis=0), triangles) < 0:
            triangles = triangles[:, ::-1]
        return vertices, triangles

    def tube(self, u, v, radius, lift=0.004, around=12):
        """A closed tube along the chart curve (u, v), thinning to nothing at its ends; radius: one per point."""
        p, n = self.frame(u, v)
        centre = p + lift * n
        along = np.gradient(centre, axis=0)
        along /= np.linalg.norm(along, axis=1)[:, None]
        side = np.cross(along, n)
        psi = 2 * np.pi * np.arange(around) / around
        rings = centre[:, None] + radius[:, None, None] * (np.cos(psi)[None, :, None] * side[:, None]
                                                           + 0.8 * np.sin(psi)[None, :, None] * n[:, None])
        rings = rings[1:-1]
        count = len(rings)
        vertices = np.concatenate([rings.reshape(-1, 3), centre[:1], centre[-1:]])
        ids = np.arange(count * around).reshape(count, around)
        triangles = []
        for k in range(around):
            k1 = (k + 1) % around
            triangles += [(count * around, ids[0, k1], ids[0, k]), (count * around + 1, ids[-1, k], ids[-1, k1])]
            for j in range(count - 1):
                triangles += [(ids[j, k], ids[j, k1], ids[j + 1, k1]), (ids[j, k], ids[j + 1, k1], ids[j + 1, k])]
        triangles = np.array(triangles)
        if signed_volume(vertices - vertices.mean(axis=0), triangles) < 0:
            triangles = triangles[:, ::-1]
        return vertices, triangles

    def brow(self, side, middle, half, height, radius, points=25, **tube):
        """A tube over the eye of one side (-1 or 1): u from middle - half to middle + half, v = height(t), t from -1 to 1."""
        t = np.linspace(-1, 1, points)
        return self.tube((middle + half * t) * side, height(t), radius * np.sqrt(np.maximum(1 - t**4, 0)), **tube)

    def eye(self, u, v, width, height, bulge, turn=0.0, look=(0.0, 0.0), pupil=0.62, lid=None, around=48):
        """Parts of an eye about (u, v) with half axes `width` and `height`: white, iris, pupil and two highlights.

        look: where the iris stands, as parts of the half axes. pupil: half width of the iris as a part of the eye's.
        around: vertices of the rings, a measure of fineness.
        lid: (height, slope): the part `lid` covers what is above that height (as a part of `height`), falling by the slope.
        """
        cos, sin = np.cos(turn), np.sin(turn)

        def base(x, y):
            a, b = cos * (x - u) + sin * (y - v), -sin * (x - u) + cos * (y - v)
            return (bulge + 0.04 * width) * np.sqrt(np.clip(1 - (a / width)**2 - (b / height)**2, 0, 1)) - 0.04 * width

        k = width / 0.1  # sizes were found for an eye of half width 0.1 m
        iu, iv = u + look[0] * width, v + look[1] * height
        ia, ib = pupil * width, pupil * height
        ball = ellipse(u, v, width, height, turn)
        parts = [("eye_white", *self.dome(ball, bulge, sink=0.004 * k, rings=12, around=around)),
                 ("iris", *self.dome(ellipse(iu, iv, ia, ib), 0.0035 * k, base, 8.0, 0.003 * k, 10, around)),
                 ("pupil", *self.dome(ellipse(iu, iv, 0.66 * ia, 0.66 * ib), 0.0065 * k, base, 8.0, -0.002 * k, 8, around)),
                 ("eye_white", *self.dome(ellipse(iu - 0.34 * ia, iv + 0.42 * ib, 0.31 * ia, 0.29 * ib), 0.0095 * k, base,
                                          4.0, -0.004 * k, 5, around // 2)),
                 ("eye_white", *self.dome(ellipse(iu + 0.36 * ia, iv - 0.40 * ib, 0.14 * ia, 0.12 * ib), 0.0095 * k, base,
                                          4.0, -0.004 * k, 4, around // 3))]
        if lid:
            parts.append(("lid", *self.dome(cap(u, v, 1.05 * width, 1.05 * height, *lid), 0.016 * k, base, 6.0,
                                            0.006 * k, 12, around + 16)))
        return parts


def ellipse(cu, cv, a, b, turn=0.0):
    """Outline of an ellipse about (cu, cv), half axes a and b, turned counter-clockwise."""
    cos, sin = np.cos(turn), np.sin(turn)

    def outline(rho, psi):
        x, y = a * rho * np.cos(psi), b * rho * np.sin(psi)
        return cu + cos * x - sin * y, cv + sin * x + cos * y
    return outline


def cap(cu, cv, a, b, height, slope):
    """Outline of the part of an upright ellipse above the line y = b height + slope x about its middle."""
    def outline(rho, psi):
        x, y = np.cos(psi), np.sin(psi)
        centre = 0.5 * (1 + height)  # in units of the half axes
        # How far the ray from (0, centre) gets: to the unit circle or to the line.
        round_ = -centre * y + np.sqrt(np.maximum(1 - (centre * x)**2, 0))
        towards = slope * a / b * x - y
        line = np.where(towards > 1e-9, (centre - height) / np.maximum(towards, 1e-9), np.inf)
        reach = rho * np.minimum(round_, line)
        return cu + a * reach * x, cv + b * (centre + reach * y)
    return outline


def lips(half, v, above, below, bend, over, tilt=0.0):
    """Outline of a mouth about (0, v): `half` as wide, `above` and `below` as high, its ends raised by `bend` where u is
    `over`, and turned by the slope `tilt`."""
    def outline(rho, psi):
        x, y = half * rho * np.cos(psi), rho * np.sin(psi)
        return x, v + y * np.where(y > 0, above, below) + bend * (x / over)**2 + tilt * x
    return outline


def merge(parts):
    """(name, vertices, triangles) of one name put together: name -> (vertices, triangles), in the order of first use."""
    merged = {}
    for name, v, f in parts:
        if name in merged:
            v0, f0 = merged[name]
            v, f = np.concatenate([v0, v]), np.concatenate([f0, f + len(v0)])
        merged[name] = (v, f)
    return merged
