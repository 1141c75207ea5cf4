# SPDX-License-Identifier: LGPL-2.1-or-later
"""Prints BUILD_STAMP, a checksum of all headers below FOLDERS and of WORDS: plugins that have the same one can share C++
objects.    build_stamp.py ROOT WORDS FOLDER …"""
import hashlib
import pathlib
import sys

root, words, *folders = sys.argv[1:]
stamp = hashlib.sha256(words.encode())
for header in sorted(file for folder in folders for file in (pathlib.Path(root) / folder).rglob("*.hpp")):
    stamp.update(b"%s\0%s\0" % (str(header.relative_to(root)).encode(), header.read_bytes()))
print(f'// By build_stamp.py\n#pragma once\n#define BUILD_STAMP "{stamp.hexdigest()[:12]}"')
