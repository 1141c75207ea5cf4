# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the mouse does over the picture, by the tool that is chosen."""
from gi.repository import GLib

from .. import elements, selection, tools
from ..playback import PLAYING

COLOR_MS = 50  # between looks for the first color after a tool was chosen
COLOR_SECONDS = 5, 60  # of them: while the video stands still, while it plays


class Mouse:
    """Draws strokes on objects, shown in `view`, and reads colors. `note`(text) tells what comes next, `back`()
    leaves a tool that serves once."""

    def __init__(self, session, panel, view, note, back):
        self._session, self._panel, self._view, self._note, self._back = session, panel, view, note, back
        self.tool = tools.LOOK
        self._anew = False  # the next stroke is on another object
        self._picks = None  # the property that the tool Pick sets
        self._stroke = None
        self._reading = None  # identifies the last click that reads a color

    def use(self, tool, picks=None):
        """What the mouse does from now on."""
        self.tool, self._picks, self._stroke, self._anew = tool, picks, None, False
        self._reading = None
        self.use_element()

    def use_element(self):
        """Another element is selected."""
        tap = {tools.EVERYWHERE: "", tools.PICK: self._panel.selected}.get(self.tool)
        self._session.use_tool(self.tool.mouse, self.lit_by() if self.tool.lamps else "decomposer", tap)

    def lit_by(self):
        """The name of the element that the tool's lamps belong to: the one that is selected, or the last; None if
        there is none."""
        found = tools.relights(self._session.project)
        return self._panel.selected if self._panel.selected in found else found[-1] if found else None

    def begin_anew(self):
        """The next stroke selects another object."""
        self._anew = True

    def drawn_on(self):
        """The element that has the strokes of the tool; None if it has none yet."""
        if not self.tool.draws:
            return self._session.project.decomposer
        return None if self._anew else selection.selection_of(self._session.project, self._panel.selected)

    def brush(self):
        """The radius of the brush, pixels of the frame."""
        described = self.drawn_on()
        if self.tool.draws and not described:
            return elements.property_of(selection.SELECT, "strokes::radius").default
        return described.get("strokes::radius") if "strokes::radius" in elements.properties(described.factory) else 0

    def take(self, kind, x, y, shift):
        """Playback.on_mouse."""
        if self.tool.draws:
            GLib.idle_add(self._draw, kind, x, y, shift)
        elif self.tool.reads and kind == "mouse-button-press":
            self._reading = reading = object()
            GLib.idle_add(self._read, reading, x, y, 0.0)
        elif self.tool.lamps and kind == "mouse-button-press":
            GLib.idle_add(self._tell_of_lamps)
        self._view.move(x, y)
        return bool(self.tool.draws or self.tool.reads)

    def _tell_of_lamps(self):
        """Elements find the room under the mouse in frames that follow each other."""
        playback = self._session.playback
        if self.tool == tools.LAMP and playback.stage and playback.stage.scene() and playback.state != PLAYING:
            self._note("While the video stands still, lamps are placed in the picture. Play to place them in the room.")
        return GLib.SOURCE_REMOVE

    def _draw(self, kind, x, y, shift):
        if kind == "mouse-button-press" and self._session.playback.width:
            subtracts = shift or self.tool.draws == "subtract"
            if subtracts and not self.drawn_on():
                self._note("Select an object first: click on it without Shift.")
                return GLib.SOURCE_REMOVE
            if selection.is_full(self.drawn_on()):
                self._note(f"This object has {selection.MAX_STROKES} strokes and takes no more. Undo one, or press N "
                           "and click to begin another object.")
                return GLib.SOURCE_REMOVE
            self._stroke = selection.Stroke("subtract" if subtracts else "add", self.brush(), [(x, y)],
                                            closed=self.tool.draws == "lasso")
        elif self._stroke:
            self._stroke.extend(x, y)
            if kind == "mouse-button-release":
                self._finish()
        self._view.show_line(self._stroke)
        return GLib.SOURCE_REMOVE

    def _finish(self):
        stroke, self._stroke = self._stroke, None
        selected = None if self._anew else self._panel.selected
        self._anew = False
        self._panel.select(self._session.draw(stroke, selected, self.tool.paints))
        more = "Click again to add a part, with Shift to leave one out; N begins another object."
        what = "Choose its new color at the right (B)." if self.tool.paints else \
            "Add an editor to change it; key 5 shows what is selected."
        self._note(f"{what} {more}")

    def _read(self, reading, x, y, waited):
        """Uses the color that was clicked on; the first one may take some frames to come. `waited`: a share of what is
        waited at most."""
        if reading is not self._reading or self._use_color(x, y):
            return GLib.SOURCE_REMOVE
        if waited >= 1:
            self._note("The color could not be read, as no frame comes. Play, then click again.")
        else:
            seconds = COLOR_SECONDS[self._session.playback.state == PLAYING]
            GLib.timeout_add(COLOR_MS, self._read, reading, x, y, waited + COLOR_MS / 1000 / seconds)
        return GLib.SOURCE_REMOVE

    def _use_color(self, x, y):
        """Whether the tool is done."""
        if self.tool == tools.EVERYWHERE:
            name = self._session.recolor_everywhere(x, y)
            if name:
                self._panel.select(name)
                self._note("Choose its new color at the right (B). If too much or too little is painted, "
                           "change tolerance.")
            return name is not None
        picks = self._picks or self._panel.settings.first_color()
        color = self._session.color_at(x, y) if picks else None
        if color:
            self._session.set_property(self._panel.selected, picks, color)
            self._back()
            if self._session.project.element(self._panel.selected).factory == selection.KEY:
                self._note("Key 5 shows what is kept; editors behind this one change that alone.")
        elif not picks:
            self._note("Select an editor that has a color first.")
        return color is not None or not picks
