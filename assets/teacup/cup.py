"""The tea cup: one closed, watertight body (cup, handle and the tea that fills it) and the parts painted or set on it.

The body is a grid of quadrilaterals: rings of one profile curve around the y axis. The handle leaves the grid through two
square openings, and the seam is pulled onto the zero set of a smooth union of the wall and the handle, so that glaze
flows from one to the other. The axis is x = z = 0, the foot stands on y = 0, the face looks to +z, the handle is at +x.
"""

import dataclasses

import numpy as np

from face import Face, cap, ellipse, merge
from surface import quads_to_triangles, signed_volume

AROUND = 144          # vertices of a full ring; 16 * 9, so that discs can be closed by halving it four times
BLOCK = 6             # quads along each side of the openings for the handle

# Of the cup that the designs are stretched from:
PROFILE = np.array([  # control points (radius, height) of a uniform cubic B-spline, metres
    (-0.10, 0.030), (0.00, 0.030), (0.10, 0.030), (0.19, 0.030), (0.25, 0.030), (0.282, 0.024), (0.292, 0.000),
    (0.305, 0.000), (0.320, 0.000), (0.335, 0.000), (0.350, 0.000), (0.365, 0.000), (0.384, 0.002), (0.386, 0.026),
    (0.362, 0.052), (0.372, 0.078), (0.430, 0.098), (0.505, 0.150), (0.566, 0.250), (0.598, 0.380), (0.596, 0.520),
    (0.570, 0.660), (0.550, 0.770), (0.556, 0.860), (0.588, 0.925), (0.622, 0.962), (0.630, 0.984), (0.614, 0.996),
    (0.594, 0.988), (0.566, 0.952), (0.540, 0.905), (0.525, 0.868), (0.517, 0.843), (0.504, 0.830), (0.480, 0.828),
    (0.43, 0.828), (0.36, 0.828), (0.25, 0.828), (0.12, 0.828), (0.00, 0.828), (-0.12, 0.828),
])
HANDLE = np.array([  # control points (x, y) of the handle's middle line
    (0.40, 0.655), (0.49, 0.668), (0.58, 0.690), (0.68, 0.735), (0.80, 0.765), (0.912, 0.715), (0.945, 0.585),
    (0.890, 0.435), (0.775, 0.320), (0.665, 0.265), (0.58, 0.250), (0.49, 0.247), (0.40, 0.245),
])




@dataclasses.dataclass
class Mood:
    """The expression of the face."""
    iris: float = 1.0          # size of the iris, and of the pupil
    brow_lift: float = 0.0     # m
    brow_tilt: float = 0.012   # how much higher the inner end of a brow is than its middle (m); negative: stern
    lid: tuple | None = None   # (height, slope) of the upper lids, see face.Face.eye
    mouth: tuple = (0.088, 0.092, 0.030)  # half width, depth and how far the corners are pulled up (m)


@dataclasses.dataclass
class Design:
    """A cup: the one above with its heights times `height` and, at each height, its radii times a factor."""
    height: float = 1.0
    radii: tuple = ((0.0, 1.0), (1.0, 1.0))  # (height, factor) of the original cup; linear in between
    reach: float = 1.0         # how far the handle stands off the wall, as a part of the original's
    thickness: float = 1.0     # of the handle
    face: float = 1.0          # size of the face
    face_height: float = 0.47  # of its middle (m)
    belly: float = 0.59        # radius that turns distances on the face into angles (m)
    mood: Mood = dataclasses.field(default_factory=Mood)
    looks: dict = dataclasses.field(default_factory=dict)  # instead of those of LOOKS

    def factor(self, y):
        return np.interp(y, *np.array(self.radii).T)

    @property
    def blend(self):
        """Width of the smooth union of wall and handle (m)."""
        return 0.085 * self.thickness

    @property
    def handle_radii(self):
        """Half thickness of the handle in its plane and across it (m)."""
        return 0.045 * self.thickness, 0.058 * self.thickness

    def profile(self):
        r, y = PROFILE.T
        return np.stack([r * self.factor(y), y * self.height], axis=1)

    def handle(self):
        x, y = HANDLE.T
        wall = 0.59
        return np.stack([wall * self.factor(y) + (x - wall) * np.where(x > wall, self.reach, 1), y * self.height], axis=1)


def bspline(control, per_span):
    """Points of the uniform cubic B-spline (#P by 2), `per_span` per span, both ends included."""
    t = np.arange(per_span) / per_span
    basis = np.stack([(1 - t)**3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3], axis=1) / 6
    spans = [basis @ control[i:i + 4] for i in range(len(control) - 3)]
    end = (control[-3] + 4 * control[-2] + control[-1]) / 6
    return np.concatenate([*spans, end[None]])


class Profile:
    """The profile curve with arc length, from the middle of the underside to the middle of the tea."""

    def __init__(self, design):
        self.design = design
        self.points = bspline(design.profile(), 64)
        self.points[0, 0] = self.points[-1, 0] = 0.0
        steps = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        self.length = np.concatenate([[0.0], np.cumsum(steps)])
        self.top = int(np.argmax(self.points[:, 1]))
        self.normals = np.gradient(self.points, self.length, axis=0)[:, ::-1] * (1, -1)  # right of the way along it
        self.normals /= np.linalg.norm(self.normals, axis=1)[:, None]
        outer = self.points[:self.top]
        self.foot_end = int(np.argmax(outer[:, 1] > 0.055 * design.height))

    def at(self, s):
        """Points (radius, height) at arc lengths s."""
        return np.stack([np.interp(s, self.length, self.points[:, k]) for k in (0, 1)], axis=-1)

    def normal(self, s):
        n = np.stack([np.interp(s, self.length, self.normals[:, k]) for k in (0, 1)], axis=-1)
        return n / np.linalg.norm(n, axis=-1, keepdims=True)

    def outside(self, height):
        """Arc length at which the outer wall, above the foot, has this height (of the original cup)."""
        height = height * self.design.height
        part = slice(self.foot_end, self.top + 1)
        return float(np.interp(height, self.points[part, 1], self.length[part]))

    def inside(self, height):
        """Arc length at which the inner wall has this height (of the original cup)."""
        height = height * self.design.height
        part = slice(self.top, len(self.points))
        return float(np.interp(-height, -self.points[part, 1], self.length[part]))

    def radius_on_flat(self, radius, underside):
        """Arc length at which the underside (or the tea) has this radius (of the original cup)."""
        factor = self.design.factor(0.03 if underside else 0.828)
        radius = radius * factor
        if underside:
            n = int(np.argmax(self.points[:, 1] < 0.029 * self.design.height))
            return float(np.interp(radius, self.points[:n, 0], self.length[:n]))
        n = int(np.argmax(self.points[::-1, 0] > 0.47 * factor))
        return float(self.length[-1] - np.interp(radius, self.points[::-1, 0][:n], self.length[-1] - self.length[::-1][:n]))


def polyline_distance(points, line):
    """Signed distances (#P) of 2-D points to a polyline, positive on its right, and the index of the nearest segment."""
    (ax, ay), (dx, dy) = line[:-1].T, np.diff(line, axis=0).T
    px, py = points[:, :1] - ax, points[:, 1:] - ay
    t = np.clip((px * dx + py * dy) / (dx * dx + dy * dy), 0, 1)
    x, y = px - t * dx, py - t * dy
    distance = np.sqrt(x * x + y * y)
    nearest = np.argmin(distance, axis=1)
    pick = np.arange(len(points)), nearest
    side = x[pick] * dy[nearest] - y[pick] * dx[nearest]
    return np.where(side >= 0, 1, -1) * distance[pick], nearest


class Shape:
    """Implicit description of the outer wall with the handle: negative inside."""

    def __init__(self, profile):
        self.wall = profile.points[profile.foot_end:profile.top:4]
        self.middle = bspline(profile.design.handle(), 32)
        self.radii, self.blend = profile.design.handle_radii, profile.design.blend

    def parts(self, p):
        wall, _ = polyline_distance(np.stack([np.hypot(p[:, 0], p[:, 2]), p[:, 1]], axis=1), self.wall)
        across, _ = polyline_distance(p[:, :2], self.middle)
        a, b = self.radii
        q = np.hypot(across / a, p[:, 2] / b)
        slope = np.hypot(across / a**2, p[:, 2] / b**2)
        handle = np.where(slope > 1e-9, q * (q - 1) / np.maximum(slope, 1e-9), -a)
        return wall, handle

    def __call__(self, p):
        wall, handle = self.parts(p)
        h = np.maximum(self.blend - np.abs(wall - handle), 0) / self.blend
        return np.minimum(wall, handle) - h**3 * self.blend / 6

    def project(self, p, steps=4):
        """Moves points onto the surface along the gradient (Newton)."""
        e = 1e-5
        for _ in range(steps):
            gradient = np.stack([(self(p + e * d) - self(p - e * d)) / (2 * e) for d in np.eye(3)], axis=1)
            move = self(p) / np.maximum(np.einsum("ij,ij->i", gradient, gradient), 0.05)
            p = p - np.clip(move, -0.03, 0.03)[:, None] * gradient
        return p


def ring(radius, height, count):
    angle = 2 * np.pi * np.arange(count) / count
    return np.stack([radius * np.cos(angle), np.full(count, height), radius * np.sin(angle)], axis=1)


def disc(first, radii, height, offset):
    """Closes the ring of vertex indices `first` by rings of half its number and so on down to a middle vertex.

    Returns new vertices and triangles; `offset` is the index of the first new vertex. Orientation: as a ring pair whose
    first ring is `first`.
    """
    vertices, triangles, outer = [], [], np.asarray(first)
    for radius in radii:
        n = len(outer) // 2
        inner = offset + np.arange(n)
        offset += n
        vertices.append(ring(radius, height, n))
        for i in range(n):
            a, b, c = outer[2 * i], outer[2 * i + 1], outer[(2 * i + 2) % (2 * n)]
            p, q = inner[i], inner[(i + 1) % n]
            triangles += [(a, b, p), (b, q, p), (b, c, q)]
        outer = inner
    vertices.append(np.array([[0.0, height, 0.0]]))
    for i in range(len(outer)):
        triangles.append((outer[i], outer[(i + 1) % len(outer)], offset))
    return np.concatenate(vertices), np.array(triangles)


def body(profile):
    """Vertices, triangles and the part name of each triangle of the closed body."""
    shape, design = Shape(profile), profile.design
    upper, lower = profile.outside(0.684), profile.outside(0.256)
    half = 0.076 * design.factor(0.47)  # openings are square
    # Arc length up to which rings are laid, number of rings, part.
    plan = [
        (profile.radius_on_flat(0.21, underside=True), 0, "foot"),
        (profile.length[profile.foot_end], 16, "foot"),
        (lower - half, 5, "porcelain"),
        (lower + half, BLOCK, "porcelain"),
        (upper - half, 12, "porcelain"),
        (upper + half, BLOCK, "porcelain"),
        (profile.outside(0.818), 1, "porcelain"),
        (profile.outside(0.830), 1, "gold"),
        (profile.outside(0.890), 4, "band"),
        (profile.outside(0.902), 1, "gold"),
        (profile.outside(0.955), 4, "porcelain"),
        (profile.inside(0.968), 9, "gold"),
        (profile.inside(0.846), 7, "inside"),
        (profile.radius_on_flat(0.455, underside=False), 6, "tea"),
    ]
    lengths, labels, blocks = [plan[0][0]], [], []
    for end, count, part in plan[1:]:
        if part == "porcelain" and count == BLOCK:
            blocks.append(len(lengths) - 1)
        lengths += list(lengths[-1] + (end - lengths[-1]) * np.arange(1, count + 1) / count)
        labels += [part] * count
    lengths = np.array(lengths)
    rz = profile.at(lengths)
    rz[np.abs(rz[:, 1]) < 1e-9, 1] = 0.0
    vertices = np.concatenate([ring(r, y, AROUND) for r, y in rz])

    def index(j, i):
        return j * AROUND + np.asarray(i) % AROUND

    lo, hi = -BLOCK // 2, BLOCK // 2
    quads, parts = [], []
    for j, part in enumerate(labels):
        for i in range(lo, AROUND + lo):
            if i < hi and any(j0 <= j < j0 + BLOCK for j0 in blocks):
                continue
            quads.append((index(j, i), index(j + 1, i), index(j + 1, i + 1), index(j, i + 1)))
            parts.append(part)

    # The handle: rings between the two openings, counted around its middle line from the lower opening to the upper.
    count = 4 * BLOCK
    loops = []
    for j0 in blocks:
        side = [(j0, lo + k) for k in range(BLOCK)] + [(j0 + k, hi) for k in range(BLOCK)]
        side += [(j0 + BLOCK, hi - k) for k in range(BLOCK)] + [(j0 + BLOCK - k, lo) for k in range(BLOCK)]
        loops.append(np.array([index(j, i) for j, i in side]))
    low_loop, high_loop = loops
    # Seen along the middle line, the upper opening is crossed from outside: mirror it so that rings correspond.
    high_loop = np.roll(high_loop.reshape(4, BLOCK), 0, axis=0).reshape(-1)
    order = [3 * BLOCK - k for k in range(count)]
    high_loop = high_loop[np.array(order) % count]

    middle = shape.middle[::-1]  # from the lower to the upper end
    wall = np.abs(polyline_distance(np.stack([middle[:, 0], middle[:, 1]], axis=1), shape.wall)[0])
    centre = len(middle) // 2
    start, end = int(np.argmin(wall[:centre])), centre + int(np.argmin(wall[centre:]))
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(middle, axis=0), axis=1))])
    free = np.linspace(along[start] + 0.105 * design.thickness, along[end] - 0.105 * design.thickness, 27)
    corner = np.arange(count) * 2 * np.pi / count
    handle_rings = []
    for s in free:
        c = np.array([np.interp(s, along, middle[:, k]) for k in (0, 1)])
        t = np.array([np.interp(s + 1e-3, along, middle[:, k]) - np.interp(s - 1e-3, along, middle[:, k]) for k in (0, 1)])
        t /= np.linalg.norm(t)
        normal = np.array([-t[1], t[0], 0])  # in the plane of the handle; at its lower end this points upwards
        # Vertex 0 of a loop is the corner with low j (below) and low i (z < 0); i grows along the loop first.
        angle = corner + np.pi * 1.25
        a, b = shape.radii
        handle_rings.append(np.array([c[0], c[1], 0]) + a * np.sin(angle)[:, None] * normal
                            + b * np.cos(angle)[:, None] * np.array([0, 0, 1]))
    blend_rings = 3
    first, last = vertices[low_loop], vertices[high_loop]
    weights = np.arange(1, blend_rings + 1)[:, None, None] / (blend_rings + 1)
    sweep = np.concatenate([first + weights * (handle_rings[0] - first), np.array(handle_rings),
                            handle_rings[-1] + weights * (last - handle_rings[-1])])
    base = len(vertices)
    sweep_index = base + np.arange(sweep.shape[0] * count).reshape(-1, count)
    vertices = np.concatenate([vertices, sweep.reshape(-1, 3)])
    chain = np.concatenate([low_loop[None], sweep_index, high_loop[None]])
    for a, b in zip(chain[:-1], chain[1:]):
        for k in range(count):
            quads.append((a[k], b[k], b[(k + 1) % count], a[(k + 1) % count]))
            parts.append("porcelain")
    quads = np.array(quads)

    # Pull the seam onto the smooth union and even it out there.
    on_wall = np.zeros(len(vertices), bool)
    j_low, j_high = blocks[0] - 8, blocks[1] + BLOCK + 1
    on_wall[j_low * AROUND:(j_high + 1) * AROUND] = True
    on_wall[base:] = True
    near = on_wall & (vertices[:, 0] > 0.3 * design.factor(0.47)) & (np.abs(vertices[:, 2]) < 0.3)
    wall_d, handle_d = np.full(len(vertices), 1.0), np.full(len(vertices), -1.0)
    wall_d[near], handle_d[near] = shape.parts(vertices[near])
    moving = near & (np.abs(wall_d - handle_d) < shape.blend)
    moving[low_loop] = moving[high_loop] = True
    moving[sweep_index[:blend_rings + 1]] = moving[sweep_index[-blend_rings - 1:]] = True
    edges = np.unique(np.sort(np.concatenate([quads[:, [k, (k + 1) % 4]] for k in range(4)]), axis=1), axis=0)
    edges = np.concatenate([edges, edges[:, ::-1]])
    edges = edges[moving[edges[:, 0]]]
    degree = np.bincount(edges[:, 0], minlength=len(vertices))
    moving &= degree > 0
    moving[:base] &= vertices[:base, 1] < 0.817 * design.height  # the painted rings stay round
    ids = np.flatnonzero(moving)
    vertices[ids] = shape.project(vertices[ids], 8)
    for _ in range(40):
        mean = np.stack([np.bincount(edges[:, 0], vertices[edges[:, 1], k], len(vertices)) for k in range(3)], axis=1)
        vertices[ids] += 0.5 * (mean[ids] / degree[ids, None] - vertices[ids])
        vertices[ids] = shape.project(vertices[ids], 2)
    vertices[ids] = shape.project(vertices[ids], 6)

    triangles = quads_to_triangles(vertices, quads)
    names = [part for part in parts for _ in (0, 1)]
    # The two discs: the underside and the tea.
    under = np.multiply((0.175, 0.115, 0.06, 0.03), design.factor(0.03))
    v, f = disc(index(0, np.arange(AROUND)), under, float(rz[0, 1]), len(vertices))
    vertices, triangles, names = np.concatenate([vertices, v]), np.concatenate([triangles, f]), names + ["foot"] * len(f)
    tea = np.multiply((0.41, 0.29, 0.15, 0.07), design.factor(0.828))
    v, f = disc(index(len(lengths) - 1, np.arange(AROUND)), tea, float(rz[-1, 1]), len(vertices))
    vertices, triangles = np.concatenate([vertices, v]), np.concatenate([triangles, f[:, ::-1]])
    names += ["tea"] * len(f)
    if signed_volume(vertices, triangles) < 0:
        triangles = triangles[:, ::-1]
    used, triangles = np.unique(triangles, return_inverse=True)  # the openings left vertices without faces
    return vertices[used], triangles.reshape(-1, 3), np.array(names)


def face_chart(profile):
    """Chart of the outer wall for face.Face, about the middle of the face; its metre is `face` metres of the wall."""
    design = profile.design
    s0, k = profile.outside(design.face_height), design.face

    def frame(u, v):
        s = s0 + k * v
        r, y = np.moveaxis(profile.at(s), -1, 0)
        nr, ny = np.moveaxis(profile.normal(s), -1, 0)
        angle = np.pi / 2 - k * u / design.belly
        cos, sin = np.cos(angle), np.sin(angle)
        return np.stack([r * cos, y, r * sin], -1), k * np.stack([nr * cos, ny, nr * sin], -1)
    return frame


def face_parts(profile):
    """List of (part name, vertices, triangles) of everything that is set on the body; each one closed."""
    face, mood, parts = Face(face_chart(profile)), profile.design.mood, []
    for side in (-1, 1):
        eye_u, eye_v, eye_a, eye_b, eye_h, turn = 0.168 * side, 0.055, 0.098, 0.128, 0.034, -0.10 * side

        def eye_base(u, v):
            cos, sin = np.cos(turn), np.sin(turn)
            x, y = cos * (u - eye_u) + sin * (v - eye_v), -sin * (u - eye_u) + cos * (v - eye_v)
            rho = np.clip((x / eye_a)**2 + (y / eye_b)**2, 0, 1)
            return (eye_h + 0.004) * np.sqrt(1 - rho) - 0.004

        look_u, look_v = eye_u - 0.010 * side, eye_v
        parts.append(("eye_white", *face.dome(ellipse(eye_u, eye_v, eye_a, eye_b, turn), eye_h, rings=12)))

        def spot(u, v, a, b):
            """Outline of what lies on the eye, from the middle of the iris."""
            return ellipse(look_u + mood.iris * u, look_v + mood.iris * v, mood.iris * a, mood.iris * b)

        parts.append(("iris", *face.dome(spot(0, 0, 0.077, 0.097), 0.0035, eye_base, 8.0, 0.003, 12)))
        parts.append(("pupil", *face.dome(spot(0, 0, 0.052, 0.067), 0.0065, eye_base, 8.0, -0.002, 10)))
        for glint, fine in (((-0.026, 0.043, 0.024, 0.028), (6, 24)), ((0.028, -0.040, 0.011, 0.012), (5, 16))):
            parts.append(("eye_white", *face.dome(spot(*glint), 0.0095, eye_base, 4.0, -0.004, *fine)))
        cheek = ellipse(0.315 * side, -0.085, 0.062, 0.040, 0.1 * side)
        parts.append(("blush", *face.dome(cheek, 0.0022, None, 6.0, 0.003, 8)))
        if mood.lid:
            height, slope = mood.lid
            parts.append(("lid", *face.dome(cap(eye_u, eye_v, 1.05 * eye_a, 1.05 * eye_b, height, slope * side), 0.016,
                                            eye_base, 6.0, 0.006, 12, 64)))
        t = np.linspace(-1, 1, 25)
        brow_u = 0.168 * side + 0.072 * t
        brow_v = 0.222 + mood.brow_lift + 0.022 * (1 - t**2) + mood.brow_tilt * t * -side
        parts.append(("brow", *face.tube(brow_u, brow_v, 0.0145 * np.sqrt(np.maximum(1 - t**4, 0)))))

    (mouth_a, mouth_b, smile), mouth_v = mood.mouth, -0.088

    def mouth(rho, psi):
        x = mouth_a * rho * np.cos(psi)
        y = mouth_b * rho * np.where(np.sin(psi) > 0, 0.16, 1.0) * np.sin(psi)
        return x, mouth_v + y + smile * (x / mouth_a)**2

    parts.append(("mouth", *face.dome(mouth, 0.0030, None, 10.0, 0.003, 12, 64)))
    if mouth_b > 0.08:
        parts.append(("tongue", *face.dome(ellipse(0, mouth_v - 0.056, 0.043, 0.025), 0.0085, None, 3.0, 0.001, 8, 40)))
    return parts


# Looks of the parts for other viewers; the scene file has its own.
LOOKS = {
    "porcelain": ((0.30, 0.58, 0.60), 0.0, 0.15), "inside": ((0.90, 0.86, 0.78), 0.0, 0.15),
    "foot": ((0.90, 0.86, 0.78), 0.0, 0.3), "band": ((0.90, 0.86, 0.78), 0.0, 0.15), "gold": ((0.95, 0.66, 0.27), 1.0, 0.2),
    "tea": ((0.16, 0.045, 0.008), 0.0, 0.05), "eye_white": ((0.92, 0.92, 0.90), 0.0, 0.05),
    "iris": ((0.17, 0.07, 0.025), 0.0, 0.05), "pupil": ((0.008, 0.006, 0.005), 0.0, 0.05),
    "brow": ((0.07, 0.03, 0.015), 0.0, 0.4), "mouth": ((0.16, 0.02, 0.02), 0.0, 0.3),
    "tongue": ((0.80, 0.24, 0.20), 0.0, 0.3), "lid": ((0.30, 0.58, 0.60), 0.0, 0.15),
    "blush": ((0.90, 0.36, 0.30), 0.0, 0.5),
}
BODY_PARTS = ("foot", "porcelain", "gold", "band", "inside", "tea")


def make(design):
    """All parts for glb_bytes, and the closed body as (vertices, triangles)."""
    profile = Profile(design)
    vertices, triangles, names = body(profile)
    vertices = vertices.astype(np.float32).astype(float)
    parts = merge([(name, vertices, triangles[names == name]) for name in BODY_PARTS] + face_parts(profile))
    looks = LOOKS | design.looks
    out = [{"name": name, "positions": v, "triangles": f, "color": looks[name][0], "metallic": looks[name][1],
            "roughness": looks[name][2]} for name, (v, f) in parts.items()]
    return out, (vertices, triangles)
