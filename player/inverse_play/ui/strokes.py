# SPDX-License-Identifier: LGPL-2.1-or-later
"""Strokes and the brush, drawn over the picture while a tool for strokes is chosen."""
import json
import math

from gi.repository import Gtk

from .. import elements

COLORS = {"shading": (1.0, 0.8, 0.2), "reflectance": (0.3, 0.8, 1.0)}
OTHER_COLOR = (0.9, 0.4, 0.9)
ALPHA = 0.12


class StrokeView(Gtk.DrawingArea):
    """`frame_place`() returns (left edge, top edge, scale) of the frame in the widget."""

    def __init__(self, frame_place):
        super().__init__(no_show_all=True)
        self.set_has_window(False)  # so that the mouse reaches the picture
        self._frame_place, self._shown = frame_place, None
        self._strokes, self._brush, self._radius = [], None, 0
        self.connect("draw", self._draw)

    def show_strokes(self, decomposer, frame):
        """Shows the strokes of a decomposer; None hides them. `frame`: size of the video."""
        properties = elements.properties(decomposer.factory) if decomposer else {}
        shown = (decomposer.get("strokes"), decomposer.get("stroke-radius"), frame) if "strokes" in properties else None
        self.set_visible(shown is not None)
        if shown != self._shown:
            self._shown = shown
            self._strokes = parse(shown[0], frame) if shown else []
            self._radius = shown[1] if shown else 0
            self.queue_draw()

    def mouse(self, _kind, x, y):
        """Moves the brush."""
        self._brush = (x, y)
        if self.get_visible():
            self.queue_draw()

    def _draw(self, _widget, context):
        left, top, scale = self._frame_place()
        context.translate(left, top)
        context.scale(scale, scale)
        context.set_line_cap(1)  # round
        context.set_line_join(1)
        for kind, radius, points in self._strokes:
            context.set_source_rgba(*COLORS.get(kind, OTHER_COLOR), ALPHA)
            context.set_line_width(2 * radius)
            context.move_to(*points[0])
            for point in points:
                context.line_to(*point)
            context.stroke()
        if self._brush:
            context.set_source_rgba(1, 1, 1, 0.8)
            context.set_line_width(1.5 / scale)
            context.arc(*self._brush, self._radius, 0, 2 * math.pi)
            context.stroke()
        return False


def parse(text, frame):
    """(kind, radius, points) of each stroke in the property strokes, in pixels of `frame`."""
    data = json.loads(text) if text else []
    size = data.get("frame", frame) if isinstance(data, dict) else frame
    strokes = data.get("strokes", []) if isinstance(data, dict) else data
    across, down = frame[0] / (size[0] or 1), frame[1] / (size[1] or 1)
    return [(stroke.get("kind", ""), stroke.get("radius", 1),
             [(x * across, y * down) for x, y in stroke["points"]]) for stroke in strokes if stroke.get("points")]
