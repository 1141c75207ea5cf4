# SPDX-License-Identifier: LGPL-2.1-or-later
"""The place where the video is shown: edited, and at the left of a divider the original."""
from gi.repository import Gdk, GLib, Gst, Gtk

from .style import add_class

DIVIDER = 9  # width of what can be grabbed, pixels


def make_sink():
    """A sink whose property `widget` shows what it gets."""
    sink = Gst.ElementFactory.make("gtksink", None)
    # The second press of a double click comes once more as such, for which the sink would send a release.
    sink.get_property("widget").connect("button-press-event", lambda _, e: e.type != Gdk.EventType.BUTTON_PRESS)
    sink.set_property("max-lateness", -1)  # QoS leaves out frames before they are worked on, not after
    return sink


class Picture(Gtk.Overlay):
    """`on_split`(0…1) is called while the divider is dragged."""

    def __init__(self, on_split):
        super().__init__(hexpand=True, vexpand=True)
        add_class(self, "picture")
        self._on_split, self._split, self._frame = on_split, None, (0, 0)
        self._video = self._original = None
        self._base = add_class(Gtk.EventBox(), "picture")
        self.add(self._base)
        # A Layout may be narrower than its child: so the original ends at the divider.
        self._left = Gtk.Layout(no_show_all=True)
        self._left.connect("draw", _cut_off)
        self.add_overlay(self._left)
        self._divider = self._make_divider()
        self.add_overlay(self._divider)
        self.spinner = Gtk.Spinner(no_show_all=True, halign=Gtk.Align.CENTER, valign=Gtk.Align.CENTER, width_request=48, height_request=48)
        self.add_overlay(self.spinner)
        self.set_overlay_pass_through(self.spinner, True)
        self.connect("get-child-position", self._place_child)
        self.connect("size-allocate", lambda *_: GLib.idle_add(self._resize_original))

    def _make_divider(self):
        divider = Gtk.EventBox(no_show_all=True)
        line = add_class(Gtk.Box(halign=Gtk.Align.CENTER, width_request=2), "divider")
        divider.add(line)
        line.show()
        divider.add_events(Gdk.EventMask.BUTTON_PRESS_MASK | Gdk.EventMask.POINTER_MOTION_MASK)
        divider.connect("motion-notify-event", self._on_drag)
        divider.connect("realize", lambda d: d.get_window().set_cursor(
            Gdk.Cursor.new_from_name(d.get_display(), "ew-resize")))
        return divider

    def make_sink(self):
        """A sink that shows the video here, in place of the one before."""
        sink = make_sink()
        self._video = self._exchange(self._base, self._video, sink.get_property("widget"))
        return sink

    def make_original_sink(self):
        """A sink that shows the video at the left of the divider."""
        sink = make_sink()
        widget = sink.get_property("widget")
        if self._original:
            self._left.remove(self._original)
        self._original = widget
        self._left.put(widget, 0, 0)
        self._resize_original()
        widget.show()
        return sink

    @staticmethod
    def _exchange(parent, before, after):
        if before:
            parent.remove(before)
        parent.add(after)
        after.show()
        return after

    def show_waiting(self, waits):
        """Shows that a frame is on its way."""
        if waits != self.spinner.get_visible():
            self.spinner.set_visible(waits)
            self.spinner.start() if waits else self.spinner.stop()

    def set_cursor(self, name):
        """The mouse pointer over the picture: "crosshair", "default" …"""
        if self.get_window():
            self.get_window().set_cursor(Gdk.Cursor.new_from_name(self.get_display(), name))

    def show_split(self, split, frame):
        """Places the divider at a share of the frame's width; None hides it. `frame`: its size."""
        if (split, frame) == (self._split, self._frame):
            return
        self._split, self._frame = split, frame
        for widget in (self._left, self._divider):
            widget.set_visible(split is not None)
        self.queue_resize()

    def frame_place(self):
        """(left edge, top edge, scale) of the frame in this widget, as the sink fits it in."""
        area, (width, height) = self.get_allocation(), self._frame
        if not width or not height:
            return 0, 0, 1
        scale = min(area.width / width, area.height / height)
        return (area.width - scale * width) / 2, (area.height - scale * height) / 2, scale

    def _across(self):
        left, _, scale = self.frame_place()
        return round(left), max(round(scale * self._frame[0]), 1)

    def _place_child(self, _overlay, child, place):
        if child not in (self._left, self._divider) or self._split is None:
            return False
        left, width = self._across()
        at = left + round(width * self._split)
        place.y, place.height = 0, self.get_allocation().height
        place.x, place.width = (0, max(at, 1)) if child is self._left else (at - DIVIDER // 2, DIVIDER)
        return True

    def _resize_original(self):
        if self._original:
            area = self.get_allocation()
            self._original.set_size_request(area.width, area.height)

    def _on_drag(self, _divider, event):
        if event.state & Gdk.ModifierType.BUTTON1_MASK:
            left, width = self._across()
            x = event.x_root - self.get_window().get_origin()[1] - self.get_allocation().x
            self._on_split(min(max((x - left) / width, 0.0), 1.0))
        return True


def _cut_off(widget, context):
    """Draws nothing beyond the widget."""
    area = widget.get_allocation()
    context.rectangle(0, 0, area.width, area.height)
    context.clip()
    return False
