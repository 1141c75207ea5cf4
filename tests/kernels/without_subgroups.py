#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the tests of kernels without subgroups, but for those that call no kernel that has a version without.

usage: without_subgroups.py KERNEL_TESTS BUILT_KERNELS LEFT_OUT [OPTION OF GOOGLETEST …]     LEFT_OUT: patterns with ':' between
"""
import os
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def reducing(built):
    """Names of the shaders of which embed.py wrote a version without subgroups."""
    found = set()
    for written in pathlib.Path(built).glob("*.spv.inc"):
        name = None
        for line in written.read_text().splitlines():
            name = line.split()[1] if line.startswith("namespace ") and not line.startswith("namespace {") else name
            if "slots_no_subgroups[]" in line:
                found.add(name)
    return found


def reached(file, known, shaders):
    """Adds to `shaders` those that a C++ file calls, or what it includes; sources go with their headers."""
    if file in known or not file.exists():
        return shaders
    known.add(file)
    for name in re.findall(r'#include "(.+)"', file.read_text()):
        if name.endswith(".spv.hpp"):
            shaders.add(pathlib.Path(name).name.removesuffix(".spv.hpp"))
            continue
        header = ROOT / name if (ROOT / name).exists() else file.parent / name
        reached(header, known, shaders)
        if ROOT / "kernels" in header.parents:
            reached(header.with_suffix(".cpp"), known, shaders)
    return shaders


def main():
    program, built, left_out, *options = sys.argv[1:]
    shaders = reducing(built)
    patterns = [left_out] if left_out else []
    for test in sorted((ROOT / "tests" / "kernels").rglob("*_test.cpp")):
        if not reached(test, set(), set()) & shaders:
            suites = set(re.findall(r"^(?:TYPED_)?TEST(?:_[FP])?\((\w+)", test.read_text(), re.MULTILINE))
            patterns += [f"{prefix}{suite}.*" for suite in sorted(suites) for prefix in ("", "*/")]
    os.execv(program, [program, f"--gtest_filter=-{':'.join(patterns)}", *options])


main()
