# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the mouse does on the picture, and editors to add: as far as the elements offer it."""
import dataclasses

from . import elements
from .selection import RECOLOR as RECOLOR_FACTORY
from .selection import SELECT as SELECT_FACTORY
from .stage import MOUSE_MODE

# Keys for what the elements may offer; what is not named here has a button without a key.
STROKE_KEYS = {"shading": "s", "reflectance": "f", "recolor": "c", "erase": "e"}
SELECT_TOOLS = {"add": ("Select", "m"), "subtract": ("Not this", "u"), "lasso": ("Lasso", "a")}
EDITOR_KEYS = {"intrinsictone": "t", "intrinsictexture": "x", "intrinsicrelight": "l", "intrinsickey": "k",
               "intrinsicstylize": "y", "intrinsicdespill": "d"}


@dataclasses.dataclass(frozen=True)
class Tool:
    """`mouse`: a value of the decomposer's stroke-mode. `draws`: one of intrinsicselect's, drawn by the window, as the
    element is added by the first stroke; `paints`: with an intrinsicrecolor. `reads`: whether it reads colors."""
    name: str
    label: str
    key: str
    hint: str
    mouse: str = "off"
    draws: str = ""
    paints: bool = False
    reads: bool = False


LOOK = Tool("look", "Look", "v", "Only looks; lamps and corners of editors can be dragged")
RECOLOR = Tool("recolor", "Recolor", "r", "Click on an object to paint it; click again to add a part, with Shift to "
               "leave one out", draws="add", paints=True)
EVERYWHERE = Tool("everywhere", "Recolor a color", "g", "Click on a color to replace it wherever it is", reads=True)
PICK = Tool("pick", "Pick up color", "p", "Click to give the color there to the selected editor", reads=True)


def _stroke_tool(nick, meaning):
    label = "Erase strokes" if nick == "erase" else f"{nick.capitalize()} stroke"
    return Tool(f"stroke-{nick}", label, STROKE_KEYS.get(nick, ""), meaning, mouse=nick)


def _select_tool(nick, meaning):
    label, key = SELECT_TOOLS.get(nick, (nick.capitalize(), ""))
    return Tool(f"select-{nick}", label, key, meaning, draws=nick)


def _drawn(factory, made):
    """A tool for each value of an element's stroke-mode."""
    mode = elements.properties(factory).get(MOUSE_MODE)
    return [made(nick, meaning) for nick, meaning in mode.choices if nick != "off"] if mode else []


def offered(project):
    """The tools for a project's elements."""
    found = [LOOK]
    known = elements.editors()
    if SELECT_FACTORY in known and RECOLOR_FACTORY in known:
        found.append(RECOLOR)
    if SELECT_FACTORY in known:
        found += _drawn(SELECT_FACTORY, _select_tool)
    if RECOLOR_FACTORY in known:
        found.append(EVERYWHERE)
    if any(p.kind == "color" for factory in known for p in elements.properties(factory).values()):
        found.append(PICK)
    return found + _drawn(project.decomposer.factory, _stroke_tool)


def editors():
    """(factory, title, key, description) of the editors that can be added."""
    return [(factory, elements.title(factory), EDITOR_KEYS.get(factory, ""), elements.description(factory))
            for factory in elements.editors()]
