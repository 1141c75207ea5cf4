# SPDX-License-Identifier: LGPL-2.1-or-later
"""In which shaders the variants of a kernel differ by more than how they read: by subgroups, workgroups or tables."""
import pathlib
import re

DIFFERS = re.compile(r"gl_(WorkGroup|NumWorkGroups|LocalInvocation|Subgroup)|subgroup|SUM_|barrier\(|^ *shared |NO_SUBGROUPS|NO_TEXEL|OWN_",
                     re.MULTILINE)
EVERYWHERE = "gpu/common.glsl"  # included by all, and tested by all


def included(file, root, known):
    """The file and all that it includes, in any variant, as keys of `known`."""
    if file in known:
        return known
    known[file] = None
    for name in re.findall(r'#include "(.+)"', file.read_text()):
        beside = file.parent / name
        included(beside if beside.exists() else root / name, root, known)
    return known


def varying(root):
    """Names of such shaders below the folder `kernels`: FOLDER_SHADER."""
    root = pathlib.Path(root)
    names = set()
    for source in root.rglob("*.comp"):
        files = [file for file in included(source, root, {}) if file != root / EVERYWHERE]
        if any(DIFFERS.search(file.read_text()) for file in files):
            names.add("_".join(source.relative_to(root).with_suffix("").parts))
    return names
