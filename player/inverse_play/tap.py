# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reads colors of the reflectance in the middle of a chain."""
from gi.repository import Gst
from inverse_common.gst import size_of

LINE = ("tee name=tee tee. ! queue max-size-buffers=1 max-size-bytes=0 max-size-time=0 leaky=downstream ! "
        "intrinsiccompose show=reflectance ! videoconvert ! video/x-raw,format=RGB ! "
        "fakesink name=last sync=false async=false")
RADIUS = 2  # of the square whose median is taken, pixels


class Tap:
    """`element` belongs into a chain; it passes everything on."""

    def __init__(self):
        self.element = Gst.parse_bin_from_description(LINE, False)
        tee = self.element.get_by_name("tee")
        self.element.add_pad(Gst.GhostPad.new("sink", tee.get_static_pad("sink")))
        self.element.add_pad(Gst.GhostPad.new("src", tee.request_pad_simple("src_%u")))
        self._last = None
        # Not the sink's last sample: it has none while the pipeline is paused.
        self.element.get_by_name("last").get_static_pad("sink").add_probe(Gst.PadProbeType.BUFFER, self._on_buffer)

    def _on_buffer(self, pad, info):
        self._last = info.get_buffer(), size_of(pad.get_current_caps())
        return Gst.PadProbeReturn.OK

    def color_at(self, x, y):
        """The reflectance around a pixel of the frame as 0xffRRGGBB; None before the first frame."""
        if not self._last:
            return None
        buffer, (width, height) = self._last
        data = buffer.extract_dup(0, buffer.get_size())
        return _median(data, len(data) // height, _range(x, width), _range(y, height))


def _range(center, size):
    center = min(max(int(center), 0), size - 1)
    return range(max(center - RADIUS, 0), min(center + RADIUS + 1, size))


def _median(data, stride, columns, rows):
    """The median of each channel: a square across an edge takes the larger side's color."""
    color = 0xff
    for channel in range(3):
        values = sorted(data[y * stride + 3 * x + channel] for y in rows for x in columns)
        color = color << 8 | values[len(values) // 2]
    return color
