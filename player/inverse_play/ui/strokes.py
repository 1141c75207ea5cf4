# SPDX-License-Identifier: LGPL-2.1-or-later
"""Strokes and the brush, drawn over the picture while a tool for strokes is chosen."""
import json
import math

from gi.repository import Gtk

COLORS = {"shading": (1.0, 0.8, 0.2), "reflectance": (0.3, 0.8, 1.0), "add": (0.4, 1.0, 0.4),
          "subtract": (1.0, 0.3, 0.3)}
OTHER_COLOR = (0.9, 0.4, 0.9)
ALPHA, LINE_ALPHA = 0.12, 0.6


class StrokeView(Gtk.DrawingArea):
    """`frame_place`() returns (left edge, top edge, scale) of the frame in the widget."""

    def __init__(self, frame_place):
        super().__init__(no_show_all=True)
        self.set_has_window(False)  # so that the mouse reaches the picture
        self._frame_place, self._shown = frame_place, None
        self._strokes, self._brush, self._radius, self._line = [], None, 0, None
        self.connect("draw", self._draw)

    def show_strokes(self, text, radius, frame):
        """Shows strokes as a property has them; None hides them. `radius`: of the brush, `frame`: size of the
        video."""
        self.set_visible(text is not None)
        if (text, radius, frame) != self._shown:
            self._shown, self._radius = (text, radius, frame), radius
            self._strokes = parse(text, frame) if text else []
            self.queue_draw()

    def show_line(self, stroke):
        """Shows a selection.Stroke while it is drawn; None ends that."""
        self._line = stroke
        self.queue_draw()

    def move(self, x, y):
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
            _draw_line(context, kind, ALPHA, 2 * radius, points)
        if self._line:
            width = 2 / scale if self._line.closed else 2 * self._line.radius
            _draw_line(context, self._line.kind, LINE_ALPHA, width, self._line.points)
        if self._brush:
            context.set_source_rgba(1, 1, 1, 0.8)
            context.set_line_width(1.5 / scale)
            context.arc(*self._brush, self._radius, 0, 2 * math.pi)
            context.stroke()
        return False


def _draw_line(context, kind, alpha, width, points):
    context.set_source_rgba(*COLORS.get(kind, OTHER_COLOR), alpha)
    context.set_line_width(width)
    context.move_to(*points[0])
    for point in points:
        context.line_to(*point)
    context.stroke()


def parse(text, frame):
    """(kind, radius, points) of each stroke in the property strokes::list, in pixels of `frame`."""
    data = json.loads(text) if text else []
    size = data.get("frame", frame) if isinstance(data, dict) else frame
    strokes = data.get("strokes", []) if isinstance(data, dict) else data
    across, down = frame[0] / (size[0] or 1), frame[1] / (size[1] or 1)
    return [(stroke.get("kind", ""), stroke.get("radius", 1),
             [(x * across, y * down) for x, y in stroke["points"]]) for stroke in strokes if stroke.get("points")]
