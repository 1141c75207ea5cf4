# SPDX-License-Identifier: LGPL-2.1-or-later
"""The tables of goals and settings that begin the elements' pages: which settings people change."""
import functools
import pathlib
import re

PACKAGE = pathlib.Path(__file__).resolve().parent
FOLDERS = (PACKAGE.parent / "elements",  # installed
           PACKAGE.parents[1] / "docs" / "reference" / "elements")
TABLE = re.compile(r"## What to set for what\n((?:\|.*\n)+)")
SETTING = re.compile(r"(?:^|[ :])([a-z][a-z0-9-]*(?:::[a-z][a-z0-9-]*)?)(?==|$| )")


@functools.cache
def _pages():
    """The tables, by element."""
    folder = next((f for f in FOLDERS if f.is_dir()), None)
    texts = {page.stem: TABLE.search(page.read_text(encoding="utf-8")) for page in folder.glob("*.md")} if folder else {}
    return {factory: table.group(1) for factory, table in texts.items() if table}


@functools.cache
def _named():
    """The settings that a table names. One counts for all elements that have it, as they mean the same."""
    codes = [code for table in _pages().values() for code in re.findall(r"`([^`]*)`", table)]
    return {name for code in codes for name in SETTING.findall(code)}


def is_rare(factory, name):
    """Whether a property is changed rarely: the element has a page, and no page's table names the property."""
    return factory in _pages() and name not in _named()
