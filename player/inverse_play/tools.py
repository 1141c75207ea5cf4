# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the mouse does on the picture, and editors to add: as far as the elements offer it."""
import dataclasses

from . import elements
from .stage import MOUSE_MODE

# Keys for what the elements may offer; what is not named here has a button without a key.
STROKE_KEYS = {"shading": "s", "reflectance": "f", "recolor": "c", "erase": "e"}
EDITOR_KEYS = {"intrinsictone": "t", "intrinsictexture": "x", "intrinsicrelight": "l", "intrinsickey": "k",
               "intrinsicstylize": "y", "intrinsicselect": "m", "intrinsicdespill": "d"}


@dataclasses.dataclass(frozen=True)
class Tool:
    """`mouse`: a value of the decomposer's stroke-mode. `reads`: whether it reads colors of the reflectance."""
    name: str
    label: str
    key: str
    hint: str
    mouse: str = "off"
    reads: bool = False


LOOK = Tool("look", "Look", "v", "Only looks; lamps and corners of editors can be dragged")
RECOLOR = Tool("recolor", "Recolor", "r", "Click on an object to paint it; choose the color at the right", reads=True)
PICK = Tool("pick", "Pick", "p", "Click to set the key of the selected editor: the color that it edits", reads=True)
RECOLOR_FACTORY = "intrinsicrecolor"


def _stroke_tool(nick, meaning):
    label = "Erase strokes" if nick == "erase" else f"{nick.capitalize()} stroke"
    return Tool(f"stroke-{nick}", label, STROKE_KEYS.get(nick, ""), meaning, mouse=nick)


def offered(project):
    """The tools for a project's elements."""
    found = [LOOK]
    if RECOLOR_FACTORY in elements.editors():
        found.append(RECOLOR)
    if any("key" in elements.properties(factory) for factory in elements.editors()):
        found.append(PICK)
    mode = elements.properties(project.decomposer.factory).get(MOUSE_MODE)
    strokes = mode.choices if mode else ()
    return found + [_stroke_tool(nick, meaning) for nick, meaning in strokes if nick != "off"]


def editors():
    """(factory, title, key, description) of the editors that can be added."""
    return [(factory, elements.title(factory), EDITOR_KEYS.get(factory, ""), elements.description(factory))
            for factory in elements.editors()]
