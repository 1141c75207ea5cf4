# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reads colors of the reflectance in the middle of a chain."""
from gi.repository import Gst

LINE = ("tee name=tee tee. ! queue max-size-buffers=1 max-size-bytes=0 max-size-time=0 leaky=downstream ! "
        "intrinsiccompose show=reflectance ! videoconvert ! video/x-raw,format=RGB ! "
        "fakesink name=last sync=false async=false enable-last-sample=true")
RADIUS = 2  # of the square whose median is taken, pixels


def make():
    """An element for a chain that passes everything on. `color_at` reads what came to it last."""
    tap = Gst.parse_bin_from_description(LINE, False)
    tee = tap.get_by_name("tee")
    tap.add_pad(Gst.GhostPad.new("sink", tee.get_static_pad("sink")))
    tap.add_pad(Gst.GhostPad.new("src", tee.request_pad_simple("src_%u")))
    return tap


def color_at(tap, x, y):
    """The reflectance around a pixel of the frame as 0xffRRGGBB; None before the first frame."""
    sample = tap.get_by_name("last").get_property("last-sample")
    if not sample:
        return None
    caps = sample.get_caps().get_structure(0)
    width, height = caps.get_value("width"), caps.get_value("height")
    found, mapped = sample.get_buffer().map(Gst.MapFlags.READ)
    if not found:
        return None
    try:
        stride = mapped.size // height
        return _median(mapped.data, stride, _range(x, width), _range(y, height))
    finally:
        sample.get_buffer().unmap(mapped)


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
