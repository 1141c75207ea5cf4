# SPDX-License-Identifier: LGPL-2.1-or-later
"""Elements that this installation has, and their properties: found at run time, none is named here."""
import dataclasses
import functools

from gi.repository import GObject, Gst
from inverse_common.gst import enum_values

LAYERS = "meta:InverseLayers"
BASE_PROPERTIES = {"name", "parent", "qos", "stats", "async-handling", "message-forward"}


class ElementError(Exception):
    """An element or a property that does not exist, or a value that does not fit. Says what to do."""


def version():
    """Of the elements, which this program is a part of."""
    plugin = Gst.Registry.get().find_plugin("inverse")
    return plugin.get_version() if plugin else "without elements"


def _takes_layers(factory, direction, first=False):
    """Whether a pad of that direction that is always there takes layers; `first`: rather than pictures."""
    found = []
    for template in factory.get_static_pad_templates():
        if template.direction != direction or template.presence != Gst.PadPresence.ALWAYS:
            continue
        caps = template.get_caps()
        for i in range(caps.get_size()):
            features = caps.get_features(i) if not caps.is_any() else None
            found.append(features is not None and not features.is_any() and features.contains(LAYERS))
    return any(found[:1] if first else found)


def _video_factories():
    factories = Gst.Registry.get().get_feature_list(Gst.ElementFactory)
    return sorted((f for f in factories if "Video" in (f.get_metadata("klass") or "")), key=lambda f: f.get_name())


@functools.cache
def editors():
    """Names of the elements that take layers and output layers. One that takes pictures first, as materialclone, is
    none: to layers without a scene it does nothing."""
    return [f.get_name() for f in _video_factories()
            if _takes_layers(f, Gst.PadDirection.SINK, first=True) and _takes_layers(f, Gst.PadDirection.SRC)]


@functools.cache
def decomposers():
    """Names of the elements that make layers of pictures."""
    return [f.get_name() for f in _video_factories()
            if not _takes_layers(f, Gst.PadDirection.SINK) and _takes_layers(f, Gst.PadDirection.SRC)]


def merges(factory):
    """Whether an element takes layers by pads on request, as those that bring branches of a launch line together do:
    alone in a chain it changes nothing."""
    layers = {nick for nick, _ in property_of("intrinsiccompose", "show").choices}
    return any(t.name_template in layers for t in Gst.ElementFactory.find(factory).get_static_pad_templates()
               if (t.direction, t.presence) == (Gst.PadDirection.SINK, Gst.PadPresence.REQUEST))


def title(factory):
    """The element's name for people: "Recolor" for "Intrinsic recolor"."""
    found = Gst.ElementFactory.find(factory)
    words = (found.get_metadata("long-name") if found else factory).split()
    if len(words) > 1 and words[0] == "Intrinsic":
        words = words[1:]
    return " ".join([words[0].capitalize()] + words[1:])


def description(factory):
    """What the element does, in a sentence."""
    found = Gst.ElementFactory.find(factory)
    return found.get_metadata("description") if found else ""


def make(factory, name):
    """A new element."""
    element = Gst.ElementFactory.make(factory, name)
    if not element:
        raise ElementError(f"there is no element {factory}; install the plugin that has it "
                           f"(gst-inspect-1.0 {factory}), or remove it from the project")
    return element


@dataclasses.dataclass(frozen=True)
class Property:
    """What a panel needs of a property. `kind`: bool, enum, color, int, float, text or file."""
    name: str
    kind: str
    blurb: str
    default: object
    minimum: float = 0
    maximum: float = 0
    choices: tuple = ()  # (nick, meaning)
    live: bool = True  # takes effect while playing; otherwise the element is made anew
    effect: str = ""  # what a text does beyond the picture: "runs" elements, "writes" a file


NUMBERS = {"gint": "int", "guint": "int", "gint64": "int", "guint64": "int", "gfloat": "float", "gdouble": "float"}


def _color_text(value):
    return f"0x{value:08x}"


def _number(spec, kind, live):
    values = [spec.default_value, spec.minimum, spec.maximum]
    if kind == "float":
        values = [rounded(v) for v in values]
    return Property(spec.name, kind, spec.blurb or spec.name, *values, live=live)


def _is_file(name, blurb):
    """Whether a text names a file that there is already."""
    return (name == "location" or name.endswith("-location") or blurb.startswith("File")) and "written" not in blurb


def _describe(spec):
    """The Property of a GParamSpec; None if a panel cannot show it."""
    live = bool(spec.flags & Gst.PARAM_MUTABLE_PLAYING)
    name, blurb, type_name = spec.name, spec.blurb or spec.name, spec.value_type.name
    if type_name == "gboolean":
        return Property(name, "bool", blurb, spec.default_value, live=live)
    if type_name in NUMBERS:
        if "0xAARRGGBB" in blurb:
            return Property(name, "color", blurb, _color_text(spec.default_value), live=live)
        return _number(spec, NUMBERS[type_name], live)
    if spec.value_type.is_a(GObject.TYPE_ENUM):
        values, default = enum_values(spec)
        choices = tuple((v.value_nick, v.value_name) for v in values)
        return Property(name, "enum", blurb, default.value_nick, choices=choices, live=live)
    if type_name == "gchararray":
        return Property(name, "file" if _is_file(name, blurb) else "text", blurb, spec.default_value or "", live=live,
                        effect=_effect(blurb))
    return None


def _effect(blurb):
    if blurb.startswith("Elements that"):
        return "runs"
    return "writes" if "written" in blurb or "to write" in blurb else ""


@functools.cache
def properties(factory):
    """The writable properties of an element and of its child objects ("strokes::radius"), by name, in the element's order."""
    element = make(factory, None)
    found = {}
    for prefix, owner in (("", element), *((f"{c.get_name()}::", c) for c in children(element))):
        for spec in owner.list_properties():
            writable = spec.flags & GObject.ParamFlags.WRITABLE and spec.flags & GObject.ParamFlags.READABLE
            described = _describe(spec) if writable and spec.name not in BASE_PROPERTIES else None
            if described:
                found[prefix + spec.name] = dataclasses.replace(described, name=prefix + spec.name)
    return found


def children(element):
    """The child objects that have some of an element's properties; none of a bin, whose children are elements."""
    if not isinstance(element, Gst.ChildProxy) or isinstance(element, Gst.Bin):
        return []
    return [element.get_child_by_index(i) for i in range(element.get_children_count())]


def _owner(element, name):
    """The object that has a property, and its name there."""
    child, found, own = name.rpartition("::")
    return (element.get_child_by_name(child), own) if found else (element, name)


def is_own(factory):
    """Whether an element is one of gst-inverse, whose properties' effects are known."""
    found = Gst.ElementFactory.find(factory)
    return bool(found) and (found.get_plugin_name() or "").startswith("inverse")


def property_of(factory, name):
    """The Property; raises ElementError where the element has none of that name."""
    found = properties(factory).get(name)
    if not found:
        raise ElementError(f"{factory} has no property {name}; it has {', '.join(properties(factory))}")
    return found


def read(element, name):
    """A property's value as plain data: bool, number or text (colors as 0xAARRGGBB, enums by nick)."""
    described = property_of(element.get_factory().get_name(), name)
    owner, own = _owner(element, name)
    value = owner.get_property(own)
    if described.kind == "color":
        return _color_text(value)
    if described.kind == "enum":
        return value.value_nick
    if described.kind in ("text", "file"):
        return value or ""
    return rounded(value) if described.kind == "float" else value


def rounded(value):
    """A float of single precision, without the digits that it does not have."""
    return float(f"{value:.7g}")


def checked(factory, name, value):
    """The value as `read` would return it; raises ElementError if it does not fit the property."""
    described = property_of(factory, name)
    try:
        return _converted(described, value)
    except (TypeError, ValueError, OverflowError):
        raise ElementError(f"{name} of {factory} cannot be {repr(value)[:200]}: {described.blurb}") from None


def _converted(described, value):
    if described.kind == "bool":
        words = {"true": True, "1": True, "false": False, "0": False}
        return words[value.lower()] if isinstance(value, str) and value.lower() in words else _only(bool, value)
    if described.kind == "color":
        number = int(value, 0) if isinstance(value, str) else _only(int, value)
        return _color_text(number) if 0 <= number <= 0xffffffff else _refuse()
    if described.kind in ("int", "float"):
        number = int(value) if described.kind == "int" else float(value)
        return number if described.minimum <= number <= described.maximum else _refuse()
    if described.kind == "enum":
        return value if value in (nick for nick, _ in described.choices) else _refuse()
    return text_of(value)


def text_of(value):
    """A text that GStreamer takes; raises ValueError for others."""
    _only(str, value).encode()  # no lone surrogates
    return value if "\0" not in value else _refuse()


def _only(kind, value):
    return value if isinstance(value, kind) else _refuse()


def _refuse():
    raise ValueError


def write(element, name, value):
    """Sets a property from plain data."""
    described = property_of(element.get_factory().get_name(), name)
    owner, own = _owner(element, name)
    if described.kind in ("text", "file"):
        owner.set_property(own, value)
    else:
        Gst.util_set_object_arg(owner, own, str(value).lower() if described.kind == "bool" else str(value))
