"""Writers and readers of the file formats the generators need: GLB (binary glTF 2.0), PNG, EXR. Same input, same bytes."""

import json
import struct
import zlib

import numpy as np

FLOAT, UINT16, UINT32 = 5126, 5123, 5125


def glb_bytes(name, parts, images=(), generator="assets/teacup/make_teacup.py"):
    """Bytes of a GLB with one mesh and one primitive per part.

    parts: list of dicts with `name`, `positions` (#V by 3), `triangles` (#F by 3, counter-clockwise outward), `color`
    (linear RGB), `metallic`, `roughness`, and optionally `uv` (#V by 2, v downwards as in glTF).
    """
    blob = bytearray()
    views, accessors, primitives, materials = [], [], [], []

    def put(array, component, kind, target, bounds=False):
        while len(blob) % 4:
            blob.append(0)
        data = np.ascontiguousarray(array).tobytes()
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data), "target": target})
        blob.extend(data)
        accessor = {"bufferView": len(views) - 1, "componentType": component, "count": len(array), "type": kind}
        if bounds:
            accessor["min"] = [float(x) for x in array.min(axis=0)]
            accessor["max"] = [float(x) for x in array.max(axis=0)]
        accessors.append(accessor)
        return len(accessors) - 1

    for part in parts:
        used, local = np.unique(part["triangles"], return_inverse=True)
        positions = np.asarray(part["positions"])[used].astype("<f4")
        attributes = {"POSITION": put(positions, FLOAT, "VEC3", 34962, bounds=True)}
        if "uv" in part:
            attributes["TEXCOORD_0"] = put(np.asarray(part["uv"])[used].astype("<f4"), FLOAT, "VEC2", 34962)
        small = len(used) < 65535
        indices = put(local.reshape(-1).astype("<u2" if small else "<u4"), UINT16 if small else UINT32, "SCALAR", 34963)
        primitives.append({"attributes": attributes, "indices": indices, "material": len(materials)})
        materials.append({
            "name": part["name"],
            "pbrMetallicRoughness": {
                "baseColorFactor": [*part["color"], 1.0],
                "metallicFactor": part["metallic"],
                "roughnessFactor": part["roughness"],
            },
        })
    document = {
        "asset": {"version": "2.0", "generator": "vivify " + generator},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": name}],
        "meshes": [{"name": name, "primitives": primitives}],
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    blob.extend(b"\0" * (-len(blob) % 4))
    total = 12 + 8 + len(text) + 8 + len(blob)
    return b"".join([
        struct.pack("<4sII", b"glTF", 2, total),
        struct.pack("<I4s", len(text), b"JSON"), text,
        struct.pack("<I4s", len(blob), b"BIN\0"), bytes(blob),
    ])


def read_glb(data):
    """Parts of a GLB written by glb_bytes: name -> (positions #V by 3, triangles #F by 3)."""
    magic, version, total = struct.unpack_from("<4sII", data)
    if magic != b"glTF" or version != 2 or total != len(data):
        raise ValueError("not a complete GLB file")
    size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + size])
    blob = data[28 + size:]

    def get(index):
        accessor = document["accessors"][index]
        kind = {FLOAT: "<f4", UINT16: "<u2", UINT32: "<u4"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
        offset = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
        array = np.frombuffer(blob, kind, accessor["count"] * width, offset)
        return array.reshape(-1, width) if width > 1 else array

    return {
        document["materials"][p["material"]]["name"]:
            (get(p["attributes"]["POSITION"]), get(p["indices"]).reshape(-1, 3).astype(np.int64))
        for p in document["meshes"][0]["primitives"]
    }


def png_bytes(indices, palette):
    """Bytes of an indexed PNG. indices: H by W uint8; palette: #C by 3 uint8 (sRGB)."""
    height, width = indices.shape
    rows = np.zeros((height, width + 1), np.uint8)
    rows[:, 0] = 1  # filter type "sub": difference to the pixel on the left
    rows[:, 1] = indices[:, 0]
    rows[:, 2:] = indices[:, 1:] - indices[:, :-1]

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    return b"".join([
        b"\x89PNG\r\n\x1a\n",
        chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)),
        chunk(b"sRGB", b"\0"),
        chunk(b"PLTE", palette.astype(np.uint8).tobytes()),
        chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)),
        chunk(b"IEND", b""),
    ])


def read_png(data):
    """Indices (H by W) and palette of a PNG written by png_bytes."""
    position, body, size, palette = 8, b"", None, None
    while position < len(data):
        length, kind = struct.unpack_from(">I4s", data, position)
        content = data[position + 8:position + 8 + length]
        if kind == b"IHDR":
            size = struct.unpack_from(">II", content)
        elif kind == b"PLTE":
            palette = np.frombuffer(content, np.uint8).reshape(-1, 3)
        elif kind == b"IDAT":
            body += content
        position += 12 + length
    width, height = size
    rows = np.frombuffer(zlib.decompress(body), np.uint8).reshape(height, width + 1)
    return np.cumsum(rows[:, 1:], axis=1, dtype=np.uint8), palette


def exr_bytes(pixels):
    """Bytes of an uncompressed EXR with half-float scanlines. pixels: H by W by 3, linear RGB."""
    height, width, _ = pixels.shape
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(name + b"\0" + struct.pack("<iiii", 1, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    attributes = [
        (b"channels", b"chlist", channels), (b"compression", b"compression", b"\0"), (b"dataWindow", b"box2i", box),
        (b"displayWindow", b"box2i", box), (b"lineOrder", b"lineOrder", b"\0"),
        (b"pixelAspectRatio", b"float", struct.pack("<f", 1)), (b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0)),
        (b"screenWindowWidth", b"float", struct.pack("<f", 1)),
    ]
    header = struct.pack("<ii", 20000630, 2)
    header += b"".join(n + b"\0" + t + b"\0" + struct.pack("<i", len(v)) + v for n, t, v in attributes) + b"\0"
    rows = [struct.pack("<ii", y, width * 6) + pixels[y, :, ::-1].T.astype("<f2").tobytes() for y in range(height)]
    first = len(header) + 8 * height
    table = struct.pack(f"<{height}q", *(first + y * len(rows[0]) for y in range(height)))
    return header + table + b"".join(rows)


def read_exr(data):
    """Pixels (H by W by 3) of an EXR written by exr_bytes."""
    start = data.index(b"dataWindow\0box2i\0") + 17 + 4
    width, height = (x + 1 for x in struct.unpack_from("<4i", data, start)[2:])
    rows = np.frombuffer(data[len(data) - height * (width * 6 + 8):], np.uint8).reshape(height, -1)[:, 8:]
    return np.ascontiguousarray(rows).view("<f2").reshape(height, 3, width).transpose(0, 2, 1)[..., ::-1].astype(float)
