#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes a file of half floats (little-endian) as a C++ source: embed_halves.py INPUT NAME OUTPUT.cpp"""
import pathlib
import struct
import sys

source, name, output = sys.argv[1:]
data = pathlib.Path(source).read_bytes()
values = struct.unpack(f"<{len(data) // 2}e", data)
lines = [", ".join(f"{v:.6g}F" if "." in f"{v:.6g}" or "e" in f"{v:.6g}" else f"{v:.6g}.0F" for v in values[i:i + 12])
         for i in range(0, len(values), 12)]
pathlib.Path(output).write_text(
    "#include <cstddef>\n"
    f"namespace inverse {{\nextern const float {name}[];\nextern const std::size_t {name}_size;\n"
    f"const std::size_t {name}_size = {len(values)};\n"
    f"const float {name}[] = {{\n" + ",\n".join(lines) + "};\n}  // namespace inverse\n")
