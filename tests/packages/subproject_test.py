#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Another meson project takes this one by the wrap file of docs/guides/packages.md, and compiles against its headers.

  subproject_test.py SOURCE
"""
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(sys.argv[1])
PAGE = (SOURCE / "docs" / "guides" / "packages.md").read_text()
PROGRAM = """#include <gst/inverse/inverse_layers_meta.h>
#include <gst/inverse/inverse_depth_meta.h>
int main(void) { return GST_INVERSE_LAYERS_META_VERSION < 1; }
"""


def block(title):
    """The lines of the page's block that begins with this comment."""
    return re.search(rf"```\w*\n(# {re.escape(title)}\n.*?)```", PAGE, re.DOTALL).group(1)


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "subprojects").mkdir()
    (folder / "subprojects" / "gst-inverse").symlink_to(SOURCE)  # in place of a clone
    (folder / "subprojects" / "gst-inverse.wrap").write_text(block("subprojects/gst-inverse.wrap"))
    (folder / "meson.build").write_text("project('other', 'c', 'cpp')\n" + block("meson.build") +
                                        "executable('program', 'program.c', dependencies: inverse)\n")
    (folder / "program.c").write_text(PROGRAM)
    build = folder / "build"
    subprocess.run(["meson", "setup", build, folder], check=True)
    subprocess.run(["ninja", "-C", build, "program"], check=True)
    subprocess.run([build / "program"], check=True)
    planned = subprocess.run(["meson", "introspect", "--installed", build], check=True, stdout=subprocess.PIPE, text=True).stdout
    sys.exit("the plugin is not installed with the project" if "libgstinverse.so" not in planned else 0)
