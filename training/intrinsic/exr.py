# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reads uncompressed scanline OpenEXR files with any channels, as Blender writes them with the codec NONE."""
import struct

import numpy as np


def read(path):
    """Channels by name, each height × width, float32."""
    data = open(path, "rb").read()
    if data[:4] != b"\x76\x2f\x31\x01":
        raise ValueError(f"{path} is not an OpenEXR file")
    at, attributes = 8, {}
    while data[at]:
        end = data.index(0, at)
        name, at = data[at:end].decode(), end + 1
        at = data.index(0, at) + 1
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    at += 1
    if attributes["compression"][0] != 0:
        raise ValueError(f"{path} is compressed: write it with the codec NONE")
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels, table, p = [], attributes["channels"], 0
    while table[p]:
        end = table.index(0, p)
        (kind,) = struct.unpack_from("<i", table, end + 1)
        channels.append((table[p:end].decode(), {0: "<u4", 1: "<f2", 2: "<f4"}[kind]))
        p = end + 17
    row = np.dtype([("y", "<i4"), ("size", "<i4")] + [(name, kind, (width,)) for name, kind in channels])
    rows = np.frombuffer(data, row, height, at + 8 * height)
    rows = rows[np.argsort(rows["y"])]
    return {name: rows[name].astype(np.float32) for name, _ in channels}


def passes(path):
    """Passes by name: height × width × 3 for colors and normals, height × width for depth."""
    channels, result = read(path), {}
    names = {c.rsplit(".", 1)[0] for c in channels}
    for name in names:
        parts = {c.rsplit(".", 1)[1]: v for c, v in channels.items() if c.rsplit(".", 1)[0] == name}
        for order in ("RGB", "XYZ"):
            if all(c in parts for c in order):
                result[name.split(".")[-1]] = np.stack([parts[c] for c in order], -1)
                break
        else:
            result[name.split(".")[-1]] = next(iter(parts.values()))
    return result
