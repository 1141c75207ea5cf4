# SPDX-License-Identifier: LGPL-2.1-or-later
"""What differs between the versions of Python's bindings of GStreamer and GLib."""
import re

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402


def structure_of(thing, index=0):
    """A copy of the Gst.Structure of caps (the one of an index), an event or a message; None without one. Gst 1.26 of python3-gst-1.0 wraps
    it, and it ends with what it belongs to."""
    found = thing.get_structure(index) if isinstance(thing, Gst.Caps) else thing.get_structure()
    if found is not None and not isinstance(found, Gst.Structure):
        found = found.__enter__()
    return found.copy() if found is not None else None


def size_of(caps):
    """(width, height) of fixed caps."""
    structure = structure_of(caps)
    return structure.get_value("width"), structure.get_value("height")


def without(caps, field):
    """Caps of one structure without a field."""
    return Gst.Caps.from_string(re.sub(rf", {field}=\([A-Za-z]+\)[^,;]*", "", caps.to_string()))


def with_field(caps, field, value):
    """Caps of one structure whose field has another value, as text with its type."""
    return Gst.Caps.from_string(f"{without(caps, field).to_string()}, {field}={value}")


def enum_values(spec):
    """The values of a GParamSpec of an enum, and its default."""
    default = spec.default_value
    if not hasattr(default, "value_nick"):  # PyGObject 3.50 gives a number
        default = spec.get_default_value()
    return list(type(default).__enum_values__.values()), default
