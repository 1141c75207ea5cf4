# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the mouse does on the picture, and editors to add: as far as the elements offer it."""
import dataclasses

from . import elements
from .selection import KEY as KEY_FACTORY
from .selection import RECOLOR as RECOLOR_FACTORY
from .selection import SELECT as SELECT_FACTORY
from .stage import LAMP_MODE, STROKE_MODE

# Keys for what the elements may offer; what is not named here has a button without a key.
STROKE_KEYS = {"shading": "s", "reflectance": "f", "recolor": "c", "erase": "e"}
SELECT_TOOLS = {"add": ("Select", "m"), "subtract": ("Not this", "u"), "lasso": ("Lasso", "a")}
RELIGHT_FACTORY, TEXTURE_FACTORY = "intrinsicrelight", "intrinsictexture"
EDITOR_KEYS = {"intrinsictone": "t", TEXTURE_FACTORY: "x", KEY_FACTORY: "k", "intrinsicstylize": "y",
               "intrinsicdespill": "d"}


@dataclasses.dataclass(frozen=True)
class Tool:
    """`mouse`: a value of the decomposer's strokes::mode, or of lamp-mode if `lamps`. `draws`: one of intrinsicselect's,
    drawn by the window, as the element is added by the first stroke; `paints`: with an intrinsicrecolor. `reads`:
    whether it reads colors."""
    name: str
    label: str
    key: str
    hint: str
    mouse: str = "off"
    draws: str = ""
    paints: bool = False
    reads: bool = False
    lamps: bool = False


LOOK = Tool("look", "Look", "v", "Only looks; lamps and corners of editors can be dragged")
RECOLOR = Tool("recolor", "Recolor", "r", "Click on an object to paint it; click again to add a part, with Shift to "
               "leave one out", draws="add", paints=True)
EVERYWHERE = Tool("everywhere", "Recolor a color", "g", "Click on a color to replace it wherever it is", reads=True)
PICK = Tool("pick", "Pick up color", "p", "Click to give the color there to the selected editor", reads=True)

LAMP = Tool("lamp", "Lamp", "l", "Click to place a lamp; drag it to move it", mouse="add", lamps=True)
NO_LAMP = Tool("no-lamp", "Remove lamp", "", "Click on a lamp to remove it", mouse="remove", lamps=True)


def _stroke_tool(nick, meaning):
    label = "Erase strokes" if nick == "erase" else f"{nick.capitalize()} stroke"
    return Tool(f"stroke-{nick}", label, STROKE_KEYS.get(nick, ""), meaning, mouse=nick)


def _select_tool(nick, meaning):
    label, key = SELECT_TOOLS.get(nick, (nick.capitalize(), ""))
    return Tool(f"select-{nick}", label, key, meaning, draws=nick)


def _drawn(factory, made):
    """A tool for each value of an element's strokes::mode; colors are picked up by PICK."""
    mode = elements.properties(factory).get(STROKE_MODE)
    return [made(nick, meaning) for nick, meaning in mode.choices if nick not in ("off", "pick")] if mode else []


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
    if RELIGHT_FACTORY in known:
        found += [LAMP, NO_LAMP] if relights(project) else [LAMP]
    return found + _drawn(project.decomposer.factory, _stroke_tool)


def relights(project):
    """Names of the elements of a project that have lamps."""
    return [e.name for e in project.editors if e.on and LAMP_MODE in elements.properties(e.factory)]


def editors():
    """(factory, title, key, description) of the editors that can be added: not those that tools of the same name
    add by a click, and not those that need a second branch."""
    return [(factory, elements.title(factory), EDITOR_KEYS.get(factory, ""), elements.description(factory))
            for factory in elements.editors()
            if factory not in (SELECT_FACTORY, RECOLOR_FACTORY) and not elements.merges(factory)]
