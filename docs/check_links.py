#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fails if a relative link of a committed page leads nowhere: docs/check_links.py [ROOT]. Checks files and headings."""
import pathlib
import re
import sys

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)


def anchors(page):
    """Anchors of a page's headings, as GitHub makes them, and explicit ones."""
    text = page.read_text()
    found = set(re.findall(r'<a id="([^"]+)"', text))
    for heading in re.findall(r"^#+ (.*)$", re.sub(r"```.*?```", "", text, flags=re.DOTALL), re.MULTILINE):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower().replace("`", "")
        found.add(re.sub(r"[^\w\- ]", "", plain).strip().replace(" ", "-"))
    return found


def broken(page, link):
    """What is wrong with a link of `page`; empty if nothing is."""
    target, _, anchor = link.partition("#")
    path = page.parent / target if target else page
    if not path.exists():
        return "no such file"
    if anchor and path.suffix == ".md" and anchor not in anchors(path):
        return "no such heading"
    return ""


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    # Build folders and what the tools write are left out; git, which knows them, need not be installed.
    pages = [p for p in sorted(root.rglob("*.md")) if not p.relative_to(root).parts[0].startswith((".", "build", "out"))]
    wrong = 0
    for page in pages:
        if not page.exists():
            continue
        for link in LINK.findall(CODE.sub("", page.read_text())):
            if not re.match(r"[a-z]+:", link) and (why := broken(page, link)):
                print(f"{page.relative_to(root)}: {link}: {why}")
                wrong += 1
    return 1 if wrong else 0


sys.exit(main())
