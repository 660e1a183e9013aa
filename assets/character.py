"""Characters: a closed body in painted parts, with closed parts set onto it."""

import numpy as np

import face
import files
import surface

FACE = {  # looks of what faces have in common
    "eye_white": ((0.86, 0.86, 0.84), 0.06), "pupil": ((0.006, 0.005, 0.004), 0.06), "mouth": ((0.16, 0.012, 0.014), 0.3),
    "tongue": ((0.75, 0.17, 0.14), 0.25), "teeth": ((0.85, 0.82, 0.74), 0.1), "blush": ((0.85, 0.26, 0.20), 0.3),
}


def glb(name, script, body, set_on, looks, genus=0):
    """Bytes of the character's GLB.

    body: vertices, triangles and the part of each triangle, standing on y = 0. set_on: (part, vertices, triangles), each
    closed. looks: part -> (linear RGB, roughness), what parts look like that a scene gives no `looks`.
    """
    vertices, triangles, names = body
    vertices = vertices.astype(np.float32).astype(float)
    volume = surface.verify(vertices, triangles, genus)
    parts = [(part, vertices, triangles[names == part]) for part in dict.fromkeys(names)]
    for part, v, f in set_on:
        surface.verify(v, f, 0)
    merged = face.merge(parts + list(set_on))
    total = sum(len(f) for _, f in merged.values())
    size = " x ".join(f"{x:.3f}" for x in np.ptp(vertices, axis=0))
    print(f"{name}: {total} triangles, body {len(triangles)}, closed, {size} m, lowest {vertices[:, 1].min():.4f} m, "
          f"volume {volume:.4f} m3; parts {' '.join(merged)}")
    out = [{"name": part, "positions": v, "triangles": f, "color": looks[part][0], "metallic": 0.0,
            "roughness": looks[part][1]} for part, (v, f) in merged.items()]
    return files.glb_bytes(name, out, generator=script)
