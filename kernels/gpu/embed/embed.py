#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Compiles the .comp files of one folder into their variants of SPIR-V and writes these as one piece of C++ with one file
of words, and for each shader a header by which C++ calls it: its buffers, push constants and specialization constants by name,
and the constants of its GLSL.

usage: embed.py COMPILE_SHADERS ROOT PREFIX DEPFILE OUTPUT.spv.inc OUTPUT.spv.bin SHADER.comp…

SHADER.comp becomes PREFIX_SHADER.spv.hpp beside OUTPUT. PREFIX names the folder.
"""
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

# SPIR-V specification 1.x, sections 2.3 and 3.
OP_NAME, OP_MEMBER_NAME, OP_CAPABILITY, OP_CONSTANT, OP_VARIABLE, OP_DECORATE, OP_MEMBER_DECORATE = 5, 6, 17, 43, 59, 71, 72
TYPE_INT, TYPE_FLOAT, TYPE_VECTOR, TYPE_ARRAY, TYPE_RUNTIME_ARRAY, TYPE_STRUCT, TYPE_POINTER = 21, 22, 23, 28, 29, 30, 32
SPEC_TRUE, SPEC_FALSE, SPEC_CONSTANT = 48, 49, 50
SPEC_ID, NON_WRITABLE, NON_READABLE, BINDING, OFFSET = 1, 24, 25, 33, 35
UNIFORM_CONSTANT, PUSH_CONSTANT, STORAGE_BUFFER = 0, 9, 12
SUBGROUP_ARITHMETIC = 63  # a capability
VARIANTS = {"fast": [], "no_subgroups": ["NO_SUBGROUPS"], "portable": ["NO_SUBGROUPS", "NO_TEXEL_VIEWS"]}  # of KernelSource
MAX_STORAGE_BUFFERS = 8  # a stage, with texel views: V3D has no more
WORKGROUP, SUBGROUPS = 0, 99  # constants that Kernel gives


def included(file, root, known):
    """The file and all that it includes, in any variant, as keys of `known`."""
    if file in known:
        return known
    known[file] = None
    for name in re.findall(r'#include "(.+)"', file.read_text()):
        beside = file.parent / name
        included(beside if beside.exists() else root / name, root, known)
    return known


def text_of(words):
    return struct.pack(f"<{len(words)}I", *words).split(b"\0")[0].decode()


class Interface:
    """What a shader declares: `buffers` as (name, texel, reads, writes, element) by binding, `push` as (name, type, offset) in
    order, `constants` as (name, type, default) by id, but for Kernel's."""

    def __init__(self, words):
        self.names, self.types, self.values, decorations, variables = {}, {}, {}, {}, []
        self.reduces = False  # with subgroup arithmetic
        at = 5
        while at < len(words):
            length, op = words[at] >> 16, words[at] & 0xffff
            a = words[at + 1:at + length]
            if op == OP_NAME:
                self.names[a[0]] = text_of(a[1:])
            elif op == OP_CAPABILITY:
                self.reduces |= a[0] == SUBGROUP_ARITHMETIC
            elif op == OP_MEMBER_NAME:
                self.names[a[0], a[1]] = text_of(a[2:])
            elif op in (TYPE_INT, TYPE_FLOAT, TYPE_VECTOR, TYPE_ARRAY, TYPE_RUNTIME_ARRAY, TYPE_STRUCT, TYPE_POINTER):
                self.types[a[0]] = (op, a[1:])
            elif op in (OP_CONSTANT, SPEC_TRUE, SPEC_FALSE, SPEC_CONSTANT):
                self.values[a[1]] = (op, a[0], a[2:])
            elif op == OP_VARIABLE:
                variables.append((a[1], self.types[a[0]][1][1], a[2]))
            elif op == OP_DECORATE:
                decorations.setdefault(a[0], {})[a[1]] = a[2:]
            elif op == OP_MEMBER_DECORATE:
                decorations.setdefault((a[0], a[1]), {})[a[2]] = a[3:]
                decorations.setdefault(a[0], {}).setdefault(a[2], a[3:])
            at += length
        buffers, self.push = {}, []
        for variable, block, storage in variables:
            marks = {**decorations.get(block, {}), **decorations.get(variable, {})}
            if storage == PUSH_CONSTANT:
                self.push = [(self.names[block, i], self.type_name(member), decorations[block, i][OFFSET][0])
                             for i, member in enumerate(self.types[block][1])]
            elif storage == UNIFORM_CONSTANT:
                buffers[marks[BINDING][0]] = (self.names[variable], True, True, False, None)
            elif storage == STORAGE_BUFFER:
                buffers[marks[BINDING][0]] = (self.names[block].removesuffix("_block"), False,
                                              NON_READABLE not in marks, NON_WRITABLE not in marks, self.element(block))
        if sorted(buffers) != list(range(len(buffers))):
            sys.exit(f"bindings are not numbered from 0 on: {buffers}")
        self.buffers = [buffers[i] for i in range(len(buffers))]
        constants = {decorations[i][SPEC_ID][0]: i for i in self.values if SPEC_ID in decorations.get(i, {})}
        constants.pop(WORKGROUP, None)
        constants.pop(SUBGROUPS, None)
        self.constants = [self.constant(i) for _, i in sorted(constants.items())]
        self.constant_ids = sorted(constants)

    def type_name(self, type_id):
        op, a = self.types[type_id]
        if op == TYPE_INT:
            return "int32_t" if a[1] else "uint32_t"
        if op == TYPE_FLOAT:
            return "float"
        if op == TYPE_VECTOR:
            return f"gpu::Vector<{self.type_name(a[0])}, {a[1]}>"
        if op == TYPE_ARRAY:
            return f"std::array<{self.type_name(a[0])}, {self.values[a[1]][2][0]}>"
        sys.exit(f"a push constant of an unknown type ({op})")

    def element(self, block):
        """Of a storage buffer, which is an array."""
        array = self.types[self.types[block][1][0]]
        return {TYPE_VECTOR: "vec4", TYPE_FLOAT: "scalar", TYPE_INT: "word"}[self.types[array[1][0]][0]]

    def constant(self, value):
        op, type_id, literal = self.values[value]
        name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", self.names[value].removeprefix("k")).lower()
        if op != SPEC_CONSTANT:
            return name, "bool", "true" if op == SPEC_TRUE else "false"
        type_name = self.type_name(type_id)
        default = struct.unpack("<" + {"int32_t": "i", "uint32_t": "I", "float": "f"}[type_name],
                                struct.pack("<I", literal[0]))[0]
        return name, type_name, repr(default) + ("F" if type_name == "float" else "")

    def named(self):
        """What is the same in both variants, whose inputs are of other types."""
        return [(name, reads, writes) for name, _, reads, writes, _ in self.buffers], self.push, self.constants


def glsl_constants(files):
    """The `#define`s and constants at file scope whose values are plain numbers, as (name, type, value)."""
    defined = {}  # name -> {(type, value as written)}
    for file in files:
        for line in pathlib.Path(file).read_text().splitlines():
            line = line.split("//")[0].rstrip()
            if define := re.fullmatch(r"#define (\w+) +(.+)", line):
                defined.setdefault(define[1], set()).add(("uint32_t", define[2]))
            elif constant := re.fullmatch(r"const (u?int|float) (.+);", line):
                kind = {"int": "int32_t", "uint": "uint32_t", "float": "float"}[constant[1]]
                for item in constant[2].split(","):
                    name, _, value = item.partition("=")
                    defined.setdefault(name.strip(), set()).add((kind, value))
    known = {}
    for _ in range(3):  # what others are made of comes first, wherever it stands
        for name, written in defined.items():
            kind, value = next(iter(written))
            value = re.sub(r"[A-Za-z_]\w*", lambda m: str(known.get(m[0], ("", m[0]))[1]), re.sub(r"\b(\d+)u\b", r"\1", value))
            if len(written) == 1 and re.fullmatch(r"[-+*/() .\de]+" if kind == "float" else r"[-+*() \d]+", value):
                value = eval(value)  # numbers and operators alone
                known[name] = kind, float(value) if kind == "float" else value
    return [(name, *known[name]) for name in defined if name in known]


def header(name, shader, constants):
    lines = [f"extern const gpu::KernelSource {name}_source;", f"/// {name}: what the build reads from the shader.", f"struct {name} {{",
             f"  static constexpr const gpu::KernelSource& source = {name}_source;"]
    lines += [f"  static constexpr {kind} {constant} = {value}{'F' if kind == 'float' else ''};" for constant, kind, value in constants]
    lines += ["  struct Buffers {", "    gpu::ByName by_name = gpu::ByName();"]
    on_tiles = [constant for constant, _, _ in shader.constants][-2:] == ["tile_across", "tile_down"]
    for buffer, _, reads, writes, _ in shader.buffers:
        kind = "InOut" if reads and writes else "In" if reads else "Out"
        elsewhere = (on_tiles and buffer == "list") or re.fullmatch(r"frames\d", buffer)  # TileProgram, dispatch_with_frames
        given = " = gpu::BufferPtr()" if elsewhere else ""
        lines.append(f"    gpu::{kind} {buffer}{given};")
    members = ", ".join(buffer for buffer, *_ in shader.buffers)
    lines += [f"    std::array<gpu::Binding, {len(shader.buffers)}> all() const {{ return {{{members}}}; }}", "  };"]
    if shader.push:
        lines += ["  struct Push {", "    [[no_unique_address]] gpu::ByName by_name = gpu::ByName();"]
        lines += [f"    {kind if '<' in kind else f'gpu::Required<{kind}>'} {member};" for member, kind, _ in shader.push]
        layout = " ".join(f"{kind} {member} {offset}".replace("gpu::", "") for member, kind, offset in shader.push)
        lines += [f'    static constexpr std::string_view layout = "{layout}";', "  };"]
    lines.append("  struct Constants {")
    lines += [f"    {kind} {constant} = {default};" for constant, kind, default in shader.constants]
    values = ["0"] * max(shader.constant_ids, default=0)  # a shader may go without some
    for i, (constant, *_) in zip(shader.constant_ids, shader.constants):
        values[i - 1] = f"gpu::constant({constant})"
    joined = ", ".join(values)
    lines += [f"    std::vector<uint32_t> all() const {{ return {{{joined}}}; }}", "  };", "};"]
    lines += [f"static_assert(offsetof({name}::Push, {member}) == {offset});" for member, _, offset in shader.push]
    return lines


def write_if_changed(path, lines):
    """Leaves the file alone where nothing changed, so that what includes it is not compiled again."""
    text = "\n".join(lines) + "\n"
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def embed(source, name, root, spirv, blob):
    """Appends the words of a shader's variants to `blob`. Returns the lines of its C++ source, and of its header."""
    words, shaders, places = {}, {}, {}
    for variant in VARIANTS:
        data = (spirv / f"{source.stem}.{variant}.spv").read_bytes()
        words[variant] = struct.unpack(f"<{len(data) // 4}I", data)
        shaders[variant] = Interface(words[variant])
    if not shaders["fast"].reduces:
        del shaders["no_subgroups"]  # as the fast one
    if any(shader.named() != shaders["fast"].named() for shader in shaders.values()):
        sys.exit(f"{source}: the variants differ in what they declare")
    if sum(not texel for _, texel, *_ in shaders["fast"].buffers) > MAX_STORAGE_BUFFERS:
        sys.exit(f"{source}: binds more than {MAX_STORAGE_BUFFERS} storage buffers, too many for some devices")
    text = [f"namespace {name} {{"]
    elements = [element for *_, element in shaders["portable"].buffers]  # a texel buffer does not declare its own
    for variant, shader in shaders.items():
        places[variant] = f"{{{{words + {len(blob) // 4}, {len(words[variant])}}}, slots_{variant}}}"
        blob += struct.pack(f"<{len(words[variant])}I", *words[variant])
        slots = ", ".join("{" + ", ".join(str(fact).lower() for fact in facts) + f", inverse::gpu::Element::{element}}}"
                          for (_, *facts, _), element in zip(shader.buffers, elements))
        text.append(f"constexpr inverse::gpu::Slot slots_{variant}[] = {{{slots}}};")
    entry = ", ".join(places.get(variant, places["fast"]) for variant in VARIANTS)
    text += [f'constexpr inverse::gpu::KernelSource source = {{"{name}", {entry}}};', "}"]
    constants = glsl_constants(included(source, root, {}))
    return text, [f"// Generated from {source.name}.", "#pragma once", "#include <cstddef>", '#include "kernels/gpu/binding.hpp"',
                  "namespace inverse::shaders {", *header(name, shaders["fast"], constants), "}"]


def main():
    compiler, root, prefix, depfile, *paths = sys.argv[1:]
    root, (output, words, *sources) = pathlib.Path(root), map(pathlib.Path, paths)
    blob, text, names = bytearray(), [], [f"{prefix}_{source.stem}" for source in sources]
    with tempfile.TemporaryDirectory() as folder:
        variants = [",".join([variant, *defines]) for variant, defines in VARIANTS.items()]
        compiled = subprocess.run([compiler, root, folder, *variants, "--", *sources], stdout=subprocess.PIPE, text=True, check=False)
        if compiled.returncode:
            sys.exit(compiled.returncode)
        for source, name in zip(sources, names):
            lines, header_lines = embed(source, name, root, pathlib.Path(folder), blob)
            text += lines
            write_if_changed(output.parent / f"{name}.spv.hpp", header_lines)
    words.write_bytes(blob)
    symbol = f"inverse_words_{prefix}"
    output.write_text("\n".join([
        f"// Generated from the shaders of {prefix}; included by one source of each library.",
        f'asm(".pushsection .rodata\\n.balign 4\\n{symbol}:\\n.incbin \\"{words.absolute()}\\"\\n.popsection");',
        f"namespace words_of_{prefix} {{",
        f'extern "C" __attribute__((visibility("hidden"))) const uint32_t {symbol}[{len(blob) // 4}];', "namespace {",
        *(line.replace("words + ", f"{symbol} + ") for line in text), "}", "}",
        "namespace inverse::shaders {",
        *(line for name in names for line in (f"extern const gpu::KernelSource {name}_source;",
                                              f"const gpu::KernelSource {name}_source = words_of_{prefix}::{name}::source;")), "}", ""]))
    pathlib.Path(depfile).write_text(f"{output}: {' '.join(compiled.stdout.split())}\n")


main()
