# SPDX-License-Identifier: LGPL-2.1-or-later
"""The lamps of an editor: the one that was placed or moved last is set together with those that come next."""
import math

from .json_list import entries, with_entries

LAMPS = "lamps"
# Properties of the editor about its next lamp; what they are of a lamp.
OF_NEXT = ("lamp-power", "lamp-color", "lamp-height")


def touched(before, after):
    """The place of the lamp that was added or moved between two values of the property; None if none was."""
    old, new = entries(before, LAMPS), entries(after, LAMPS)
    if len(new) < len(old):
        return None
    return next((i for i, lamp in enumerate(new) if i >= len(old) or _moved(old[i], lamp)), None)


def _moved(before, after):
    """Whether a lamp is elsewhere; the element rounds what is set."""
    pairs = [(a, b) for field in ("position", "direction") for a, b in zip(before.get(field, ()), after.get(field, ()))]
    return any(not math.isclose(a, b, rel_tol=1e-3, abs_tol=1e-3) for a, b in pairs)


def settings(described, place):
    """What makes the next lamp of an editor like the one at that place: properties that differ."""
    lamp = entries(described.get(LAMPS), LAMPS)[place]
    found = {"lamp-power": lamp["power"]} if "power" in lamp else {}
    if _has_height(lamp):
        found["lamp-height"] = lamp["position"][2]
    found = {name: value for name, value in found.items() if not math.isclose(value, described.get(name), rel_tol=1e-3)}
    color = "0xff" + lamp.get("color", "#ffffff").lstrip("#")
    return found if color == described.get("lamp-color") else {**found, "lamp-color": color}


def changed(value, place, given):
    """The property when the lamp at that place gets what is given of OF_NEXT; None if there is no such lamp."""
    lamps = entries(value, LAMPS)
    if place is None or place >= len(lamps):
        return None
    lamp = dict(lamps[place])
    if "lamp-power" in given:
        lamp["power"] = given["lamp-power"]
    if "lamp-color" in given:
        lamp["color"] = "#" + given["lamp-color"][-6:]
    if "lamp-height" in given and _has_height(lamp):
        lamp["position"] = [*lamp["position"][:2], given["lamp-height"]]
    return with_entries(value, LAMPS, [*lamps[:place], lamp, *lamps[place + 1:]])


def _has_height(lamp):
    """Whether a lamp is at a height above the picture: not in a remembered room."""
    return "position" in lamp and not lamp.get("room")
