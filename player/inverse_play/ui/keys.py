# SPDX-License-Identifier: LGPL-2.1-or-later
"""Keys of the window, in one table, and the overlay that lists them."""
from gi.repository import Gdk, Gtk

from .style import add_class, label

CONTROL, SHIFT, ALT = Gdk.ModifierType.CONTROL_MASK, Gdk.ModifierType.SHIFT_MASK, Gdk.ModifierType.MOD1_MASK

# (group, key as Gtk.accelerator_parse reads it, name of an action, words)
SHORTCUTS = (
    ("Play", "space", "play", "play, pause; play again at the end"),
    ("Play", "Left", "back", "5 s back"),
    ("Play", "Right", "forward", "5 s forward"),
    ("Play", "Home", "start", "to the beginning"),
    ("Play", "End", "end", "to the end"),
    ("Play", "<Control>o", "open-file", "open a file"),
    ("Play", "<Control>u", "open-uri", "open a URI or a piece of a launch line"),
    ("Play", "<Control>k", "open-menu", "choose a camera, a recording or a test picture"),
    ("View", "1", "layer-1", "picture, with its edits"),
    ("View", "2", "layer-2", "reflectance"),
    ("View", "3", "layer-3", "shading"),
    ("View", "4", "layer-4", "original"),
    ("View", "5", "layer-5", "mask of an editor"),
    ("View", "6", "layer-6", "difference by the edits"),
    ("View", "7", "layer-next", "further layers, one after the other"),
    ("View", "backslash", "split", "original beside the picture"),
    ("View", "bracketleft", "split-left", "divider to the left"),
    ("View", "bracketright", "split-right", "divider to the right"),
    ("View", "F9", "panel", "hide or show the panels"),
    ("View", "F11", "fullscreen", "full screen"),
    ("Edit", "Up", "select-previous", "select the element before"),
    ("Edit", "Down", "select-next", "select the element behind"),
    ("Edit", "<Alt>Up", "move-up", "move the editor towards the beginning"),
    ("Edit", "<Alt>Down", "move-down", "move the editor towards the end"),
    ("Edit", "o", "switch", "switch the editor off or on"),
    ("Edit", "Delete", "remove", "remove the editor"),
    ("Edit", "Return", "settings", "go to its settings; Tab and arrows change them"),
    ("Edit", "b", "color", "choose its color"),
    ("Edit", "n", "another-object", "the next click selects another object"),
    ("Edit", "plus", "brush-larger", "larger brush"),
    ("Edit", "minus", "brush-smaller", "smaller brush"),
    ("Edit", "<Control>z", "undo", "undo"),
    ("Edit", "<Control><Shift>z", "redo", "redo"),
    ("Scene", "h", "touch", "let a hand draw, or end that"),
    ("Scene", "j", "freeze", "leave the scene as it is, or go on"),
    ("Keep", "<Control>r", "record", "record to a file; again: end"),
    ("Keep", "<Control>p", "snapshot", "snapshot as PNG"),
    ("Keep", "<Control>s", "save", "save the project"),
    ("Keep", "<Control>l", "load", "load a project"),
    ("Keep", "<Control><Shift>c", "copy-line", "copy the launch line"),
    ("Keep", "<Control><Shift>s", "save-line", "save the launch line"),
    ("Window", "F1", "help", "this list"),
    ("Window", "Escape", "escape", "close what is open; the tool Look"),
    ("Window", "<Control>q", "quit", "close the window"),
)
ALIASES = (("question", "help"), ("equal", "brush-larger"), ("KP_Add", "brush-larger"),
           ("KP_Subtract", "brush-smaller"), ("<Control>y", "redo"))


def _parsed(text):
    key, modifiers = Gtk.accelerator_parse(text)
    return Gdk.keyval_to_lower(key), int(modifiers)


class Keys:
    """Finds the action of a key event. `more`: (key, action) of tools and editors."""

    def __init__(self, more):
        pairs = [(key, action) for _, key, action, _ in SHORTCUTS] + list(ALIASES) + list(more)
        self._actions = {_parsed(key): action for key, action in pairs if key}

    def action_of(self, event):
        """The action's name, or None."""
        key, modifiers = Gdk.keyval_to_lower(event.keyval), event.state & (CONTROL | SHIFT | ALT)
        found = self._actions.get((key, int(modifiers)))
        # Shift only serves to type some of these characters.
        return found or (self._actions.get((key, 0)) if modifiers == SHIFT and not _is_letter(key) else None)


def _is_letter(key):
    return chr(Gdk.keyval_to_unicode(key) or 32).isalpha()


def key_of(action):
    """The key of an action of SHORTCUTS; "" without one."""
    return next((key for _, key, name, _ in SHORTCUTS if name == action), "")


def words(key):
    """A key for people: "Ctrl+Z"."""
    return Gtk.accelerator_get_label(*Gtk.accelerator_parse(key)) if key else ""


def button_content(text, key):
    """A button's words with its key."""
    box = Gtk.Box(spacing=8)
    box.pack_start(label(text), True, True, 0)
    box.pack_end(label(words(key), "key"), False, False, 0)
    return box


def help_overlay(tools, editors):
    """The list of all keys. `tools`, `editors`: (key, words)."""
    groups = {}
    for group, key, _, text in SHORTCUTS:
        groups.setdefault(group, []).append((key, text))
    groups["Tools"] = [(key, text) for key, text in tools if key]
    groups["Add"] = [(key, text) for key, text in editors if key]
    columns = (("Tools", "Add", "Play"), ("Edit", "Scene", "Window"), ("View", "Keep"))
    box = add_class(Gtk.Box(spacing=28, halign=Gtk.Align.CENTER, valign=Gtk.Align.CENTER), "help")
    for column in columns:
        grid = Gtk.Grid(column_spacing=12, row_spacing=2)
        for group in column:
            _add_group(grid, group, groups.get(group, []))
        box.add(grid)
    for child in box.get_children():
        child.show_all()
    box.set_no_show_all(True)
    return box


def _add_group(grid, title, rows):
    at = len(grid.get_children())
    if rows:
        grid.attach(label(title, "heading"), 0, at, 2, 1)
    for place, (key, text) in enumerate(rows, at + 1):
        grid.attach(label(words(key), "key"), 0, place, 1, 1)
        grid.attach(label(text), 1, place, 1, 1)
