# SPDX-License-Identifier: LGPL-2.1-or-later
"""The manual as a site: ./dev manual (Sphinx, MyST, Furo). Its pages are those of docs/ and the README; links to other files of the project
become links to its pages at $MANUAL_FILES, or plain text without it."""
import os
import pathlib
import re

from sphinx.builders.html import StandaloneHTMLBuilder

ROOT = pathlib.Path(__file__).resolve().parents[2]
FILES = os.environ.get("MANUAL_FILES", "")  # where files of the project are shown, such as https://HOST/PROJECT/-/blob/main

project = "gst-inverse"
author = "The gst-inverse authors"
copyright = "The gst-inverse authors; LGPL-2.1-or-later"  # noqa: A001 (Sphinx names it so)
version = release = (ROOT / "VERSION").read_text(encoding="utf-8").strip()
extensions = ["myst_parser"]
myst_heading_anchors = 6
myst_enable_extensions = ["html_image"]
exclude_patterns = ["manual"]
suppress_warnings = ["myst.header", "misc.highlighting_failure"]  # headings that leave out a level; listings that are no C
root_doc = "index"
html_theme = "furo"
html_title = f"gst-inverse {version}"
html_show_sphinx = False
StandaloneHTMLBuilder.supported_image_types = [*StandaloneHTMLBuilder.supported_image_types, "image/webp"]  # which Sphinx 5 leaves out
LINK = re.compile(r"(!?)\[([^\]\[]*)\]\(([^)\s]+)\)")


def rewrite(app, docname, source):
    """Links between pages stay; others leave the site."""
    docs = ROOT / "docs"
    page = (docs / docname).parent
    folder = ROOT if docname == "index" else page  # the README's

    def replace(found):
        image, text, link = found.groups()
        target, _, anchor = link.partition("#")
        if re.match("[a-z]+:", link) or not target:
            return found.group(0)
        path = (folder / target).resolve()
        if path == ROOT / "README.md":
            path = docs / "index.md"
        if docs in path.parents and (image or path.suffix == ".md"):
            return f"{image}[{text}]({os.path.relpath(path, page)}{'#' + anchor if anchor else ''})"
        return f"[{text}]({FILES}/{path.relative_to(ROOT)})" if FILES else text

    parts = re.split("(```.*?```)", source[0], flags=re.DOTALL)
    source[0] = "".join(part if k % 2 else LINK.sub(replace, part) for k, part in enumerate(parts))


def setup(app):
    app.connect("source-read", rewrite)
