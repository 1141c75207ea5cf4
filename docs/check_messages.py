#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fails if a message of docs/guides/troubleshooting.md is none that the elements can print.

Messages are the first column of tables headed "message"; what varies is "…". Those of GStreamer itself are left out.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
GSTREAMERS = ("no element", "could not")


def printed():
    """Every string of the sources, with those that the compiler joins joined."""
    text = "\n".join(path.read_text() for folder in ("gst", "kernels", "common") for kind in ("cpp", "hpp")
                     for path in sorted((ROOT / folder).rglob(f"*.{kind}")))
    return re.sub(r'"\s*\n\s*"', "", text).replace('\\"', '"')


def main():
    page = (ROOT / "docs" / "guides" / "troubleshooting.md").read_text()
    messages = [message for table in re.findall(r"^\| message \|.*\n\|[-|]+\n((?:\|.*\n)+)", page, re.MULTILINE)
                for message in re.findall(r"^\| `([^`]+)`", table, re.MULTILINE)]
    sources, wrong = printed(), 0
    for message in messages:
        parts = [part.strip() for part in message.split("…")]
        if not message.startswith(GSTREAMERS) and (missing := [part for part in parts if part not in sources]):
            print(f"no source has: {missing} ({message})")
            wrong += 1
    return 1 if wrong or len(messages) < 10 else 0


sys.exit(main())
