"""The main program of a generator: writes its files, or with --check compares them with what it makes now."""

import argparse
import pathlib
import sys

import numpy as np

import files


def difference(name, made, found):
    """What differs between two files of this name, or an empty string."""
    if made == found:
        return ""
    if name.endswith(".png"):
        (a, pa), (b, pb) = files.read_png(made), files.read_png(found)
        if a.shape != b.shape or not np.array_equal(pa, pb):
            return "size or palette"
        share = float(np.mean(a != b))
        return f"{share:.2%} of the pixels" if share > 1e-3 else ""
    if name.endswith(".exr"):
        a, b = files.read_exr(made), files.read_exr(found)
        return "" if a.shape == b.shape and np.allclose(a, b, rtol=2e-3) else "size or pixels"
    if not name.endswith(".glb"):
        return "contents"
    a, b = files.read_glb(made), files.read_glb(found)
    if list(a) != list(b):
        return f"parts {list(b)}, wanted {list(a)}"
    for part, (positions, triangles) in a.items():
        other, other_triangles = b[part]
        if positions.shape != other.shape or not np.array_equal(triangles, other_triangles):
            return f"triangles of part {part}"
        if np.abs(positions - other).max() > 1e-6:
            return f"positions of part {part} by {np.abs(positions - other).max():.2g} m"
    return ""


def main(make, script, about):
    """make() -> {file name: bytes}; script: the generator's __file__. Exits with 1 when --check finds a difference.

    The same NumPy makes the same bytes every time; --check compares what the files hold (positions to a micrometre,
    triangles exactly, all but one pixel in a thousand, and light to its last bit but one), so that another NumPy or zlib
    passes.
    """
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--check", action="store_true", help="compare with the files instead of writing them")
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path(script).resolve().parent,
                        help="folder of the files")
    options = parser.parse_args()
    wrong = 0
    for name, data in make().items():
        path = options.output / name
        if not options.check:
            path.write_bytes(data)
            print(f"{name}: {len(data)} bytes")
            continue
        reason = difference(name, data, path.read_bytes()) if path.exists() else "missing"
        print(f"{name}: {'differs: ' + reason if reason else 'the same'}")
        wrong += bool(reason)
    sys.exit(1 if wrong else 0)
