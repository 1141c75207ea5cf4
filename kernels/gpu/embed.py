#!/usr/bin/env python3
"""Compiles one .comp file into both variants of SPIR-V, validates them, and writes them as a C++ source.

usage: embed.py INPUT.comp NAME OUTPUT.cpp DEPFILE INCLUDES GLSLANG SPIRV_VAL
"""
import pathlib
import struct
import subprocess
import sys
import tempfile


def run(arguments):
    result = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if result.returncode:
        sys.exit(" ".join(map(str, arguments)) + "\n" + result.stdout)


def main():
    source, name, output, depfile, includes, glslang, spirv_val = sys.argv[1:]
    text = [f'// Generated from {pathlib.Path(source).name}.', '#include "kernels/gpu/kernel_source.hpp"', "namespace {"]
    dependencies = set()
    sizes = []
    with tempfile.TemporaryDirectory() as folder:
        for variant, defines in (("fast", []), ("portable", ["-DPORTABLE"])):
            spv = pathlib.Path(folder) / f"{variant}.spv"
            deps = pathlib.Path(folder) / f"{variant}.d"
            run([glslang, "-V", "--target-env", "vulkan1.1", f"-I{includes}", *defines, "--depfile", deps, "-o", spv, source])
            run([spirv_val, "--target-env", "vulkan1.1", spv])
            dependencies.update(deps.read_text().split(":", 1)[1].split())
            data = spv.read_bytes()
            sizes.append(len(data) // 4)
            words = struct.unpack(f"<{len(data) // 4}I", data)
            text.append(f"constexpr uint32_t {variant}[] = {{")
            text += [",".join(map(str, words[i:i + 16])) + "," for i in range(0, len(words), 16)]
            text.append("};")
    text += ["}", "namespace inverse::shaders {", f"extern const gpu::KernelSource {name};",
             f'const gpu::KernelSource {name}{{"{name}", {{fast, {sizes[0]}}}, {{portable, {sizes[1]}}}}};', "}"]
    pathlib.Path(output).write_text("\n".join(text) + "\n")
    pathlib.Path(depfile).write_text(f"{output}: {' '.join(sorted(dependencies))}\n")


main()
