# SPDX-License-Identifier: LGPL-2.1-or-later
"""A project as a line for gst-launch-1.0."""
import shlex

from . import elements, source

DRAWING = {"strokes::mode", "strokes::radius", "strokes::fill"}  # what the mouse or a hand draws, not what was drawn


def value_text(factory, name, value):
    """A property's value in a launch line."""
    kind = elements.property_of(factory, name).kind
    if kind in ("text", "file"):
        return source.quoted(value)
    return str(value).lower() if kind == "bool" else str(value)


def element_text(element):
    """An element with its settings, for Gst.parse_launch."""
    left_out = set() if element.properties.get("strokes::touch") else DRAWING
    settings = [f"{name}={value_text(element.factory, name, value)}"
                for name, value in element.properties.items() if name not in left_out]
    return " ".join([element.factory, *settings])


def chain_text(project):
    """From the decomposer to the last editor."""
    parts = [project.decomposer, *(e for e in project.editors if e.on)]
    return " ! ".join(element_text(part) for part in parts)


def _split_text(project, width):
    """Two branches that a compositor lays over each other. `width`: of the video, pixels."""
    cut = round(width * project.split)
    return ("tee name=layers "
            f"layers. ! queue ! {element_text(project.compose)} ! videoconvert ! compositor name=split "
            "sink_1::zorder=1 ! videoconvert ! autovideosink "
            "layers. ! queue ! intrinsiccompose show=input ! videoconvert ! "
            f"videocrop right={width - cut} ! split.sink_1")


def parse_text(project, width=0):
    """The project for Gst.parse_launch. `width`: of the video, needed to show the split view."""
    begin = f"{source.parse(project.source).line} ! videoconvert ! {chain_text(project)} ! "
    if project.split is not None and width > 0 and round(width * project.split) > 0:
        return begin + _split_text(project, width)
    return begin + f"{element_text(project.compose)} ! videoconvert ! autovideosink"


def shell_text(project, width=0):
    """The project as a command for a shell."""
    words = _words(parse_text(project, width))
    return " ".join(["gst-launch-1.0", *(word if word == "!" else shlex.quote(word) for word in words)])


def _words(text):
    """Splits at spaces outside of quotes. The quotes stay: gst-launch-1.0 reads them."""
    words, word, inside, escaped = [], "", False, False
    for letter in text:
        if letter == " " and not inside:
            words, word = words + [word] if word else words, ""
            continue
        if letter == '"' and not escaped:
            inside = not inside
        escaped = letter == "\\" and not escaped
        word += letter
    return words + [word] if word else words
