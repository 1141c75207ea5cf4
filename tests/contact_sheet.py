#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fails unless a contact sheet of ./dev run on the bundled clip has the four parts of a frame: the input, its reflectance, its
shading, and the frame with one color repainted. Reads the PNG by gst-launch-1.0.

usage: contact_sheet.py SHEET.png
"""
import statistics
import struct
import subprocess
import sys
import tempfile

GAP, COLUMNS, ROWS, TILE_WIDTH = 8, 2, 3, 640  # tools/runner/contact_sheet
FLAT = 8  # steps of 255: less spread than any part of the clip has
EQUAL = 4  # mean difference of two parts that show the same
BLUER, PAINTED = 60, 0.005  # by how much blue over red grows in what is repainted; the least share of such pixels
GRAY = 12  # mean spread of the channels of shading


def pixels(path):
    """(width, height, bytes of RGB) of a PNG."""
    with open(path, "rb") as file:
        width, height = struct.unpack(">II", file.read(24)[16:])
    with tempfile.NamedTemporaryFile() as raw:
        subprocess.run(["gst-launch-1.0", "-q", "filesrc", f"location={path}", "!", "pngdec", "!", "videoconvert", "!",
                        "video/x-raw,format=RGBA", "!", "filesink", f"location={raw.name}"], check=True, timeout=60)
        return width, height, raw.read()


def part(data, width, left, top, size, step=3):
    """Every third pixel of a rectangle, as (r, g, b)."""
    return [tuple(data[4 * (y * width + x):4 * (y * width + x) + 3])
            for y in range(top, top + size[1], step) for x in range(left, left + size[0], step)]


def difference(a, b):
    return statistics.fmean(abs(p - q) for x, y in zip(a, b) for p, q in zip(x, y))


def main():
    width, height, data = pixels(sys.argv[1])
    if width != GAP + COLUMNS * (TILE_WIDTH + GAP) or len(data) != 4 * width * height:
        sys.exit(f"the contact sheet is {width} x {height} pixels, not two frames across")
    tile_height = (height - GAP) // ROWS - GAP
    size = TILE_WIDTH // 2, tile_height // 2
    parts = {name: part(data, width, GAP + column * size[0], GAP + row * size[1], size) for name, column, row in
             [("input", 0, 0), ("reflectance", 1, 0), ("shading", 0, 1), ("repainted", 1, 1)]}
    faults = [f"{name} is flat" for name, seen in parts.items() if statistics.pstdev(sum(p) / 3 for p in seen) < FLAT]
    names = list(parts)
    faults += [f"{a} and {b} are the same" for i, a in enumerate(names) for b in names[i + 1:]
               if (a, b) != ("input", "repainted") and difference(parts[a], parts[b]) < EQUAL]
    painted = statistics.fmean((q[2] - q[0]) - (p[2] - p[0]) > BLUER for p, q in zip(parts["input"], parts["repainted"]))
    if painted < PAINTED:
        faults.append(f"{painted:.2%} of the frame is repainted")
    gray = statistics.fmean(max(p) - min(p) for p in parts["shading"])
    if gray > GRAY:
        faults.append(f"shading has colors ({gray:.1f} steps)")
    if faults:
        sys.exit("contact sheet: " + "; ".join(faults))
    print("contact sheet: input, reflectance, shading and repainted frame")


main()
