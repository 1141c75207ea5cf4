# SPDX-License-Identifier: LGPL-2.1-or-later
"""The elements of a project in a pipeline: decomposer, editors and intrinsiccompose, kept as the project says."""
from gi.repository import Gst

from . import elements
from .chain import Chain
from .tap import Tap

STROKE_MODE, LAMP_MODE = "strokes::mode", "lamp-mode"
# What elements do with the mouse, and the values by which they leave it to another one. Tools set it: no part of a
# project.
MOUSE = {STROKE_MODE: "off", LAMP_MODE: "off", "drag": False}


class Stage:
    """Elements between `entry`, a source pad, and `sink`, an element that takes pictures. `branch_pad` outputs the
    layers once more, for a branch that begins with a queue. There is none up to intrinsiccompose: so no frame is
    under way while the project changes, and each frame is edited by one project."""

    def __init__(self, pipeline, entry, sink, project, on_change):
        self._pipeline, self._on_change = pipeline, on_change
        self._elements = {}
        self.project = project
        self._tap, self._tap_place = None, None
        self._mouse = "off", "decomposer"
        self._setting = None  # the element that is being set to what the project says
        self._to_set = []  # (name, property) that are to be set between two frames
        layers = Gst.ElementFactory.make("tee", None)
        # The first one, as a tee waits for each of its pads in turn: the other one waits while the video is paused.
        self.branch_pad = layers.request_pad_simple("src_%u")
        self.compose = self._made(project.compose)
        self._convert = Gst.ElementFactory.make("videoconvert", None)
        for element in (layers, self.compose, self._convert):
            pipeline.add(element)
        layers.request_pad_simple("src_%u").link(self.compose.get_static_pad("sink"))
        self.compose.link(self._convert)
        self._convert.link(sink)
        self._chain = Chain(pipeline, entry, layers.get_static_pad("sink"))
        for editor in (project.decomposer, *project.editors):
            self._made(editor)
        self._link()

    @property
    def picture_pad(self):
        """The pad that outputs what is shown."""
        return self.compose.get_static_pad("src")

    @property
    def mouse_pad(self):
        """The pad that the mouse over the picture comes in by."""
        return self._convert.get_static_pad("src")

    def _made(self, described):
        element = elements.make(described.factory, None)  # names of those that are going may be in use still
        for name, value in described.properties.items():
            elements.write(element, name, value)
        self._elements[described.name] = element
        self._set_mouse(element, described)
        element.connect("notify", lambda e, spec: self._on_notify(e, spec.name, described.name))
        for child in elements.children(element):
            child.connect("notify", lambda c, spec: self._on_notify(element, f"{c.get_name()}::{spec.name}", described.name))
        return element

    def _on_notify(self, element, prop, name):
        """An element set its own property, as the mouse draws strokes."""
        factory = element.get_factory().get_name()
        if element is self._setting or prop in MOUSE or prop not in elements.properties(factory):
            return
        described = self.project.element(name)
        value = elements.read(element, prop)
        if described and described.factory == factory and self._elements.get(name) is element \
                and value != described.get(prop):
            self._on_change(name, prop, value)

    def keeps(self, name, prop, value):
        """Whether an element has a value, and is not about to get another one by the project."""
        element = self._elements.get(name)
        return element is not None and (name, prop) not in self._to_set and elements.read(element, prop) == value

    def accept(self, project):
        """Takes a project that the elements are in accordance with, as one of them changed itself."""
        self.project = project

    def apply(self, project):
        """Makes the pipeline as the project says."""
        before, self.project = self.project, project
        gone = [self._elements.pop(e.name) for e in before.elements() if not _stays(e, project.element(e.name))]
        changes = []
        for described in project.elements():
            if described.name in self._elements:
                changes.append((self._elements[described.name], before.element(described.name), described))
                self._to_set += [(described.name, prop) for prop in _changed(*changes[-1][1:])]
            else:
                self._made(described)
        self._link(gone, lambda: [self._configure(*change) for change in changes])

    def _configure(self, element, before, now):
        """Sets what differs between two states of an element; the mouse may have changed the rest meanwhile."""
        self._setting = element
        for name in _changed(before, now):
            elements.write(element, name, now.get(name))
            self._to_set.remove((now.name, name))
        self._set_mouse(element, now)
        self._setting = None

    def _link(self, gone=(), then=lambda: None):
        row = [self._elements["decomposer"]]
        for editor in self.project.editors:
            if self._tap and self._tap_place == editor.name:
                row.append(self._tap.element)
            if editor.on:
                row.append(self._elements[editor.name])
        if self._tap and self._tap.element not in row:
            row.append(self._tap.element)
        self._chain.set(row, gone, then)

    def tap(self, place):
        """Reads colors before the editor `place`, or behind the last one if that is ""; None stops. Whether colors
        are read from now on that were not before."""
        if place == self._tap_place:
            return False
        gone = [self._tap.element] if self._tap and place is None else []
        if place is None:
            self._tap = None
        elif not self._tap:
            self._tap = Tap()
        self._tap_place = place
        self._link(gone)
        return place is not None

    def color_at(self, x, y):
        """What the tap found there, or None."""
        return self._tap.color_at(x, y) if self._tap else None

    def mouse(self, mode, place):
        """What the mouse does: a value of strokes::mode or lamp-mode of the element `place`; "off": what each element
        is set to."""
        self._mouse = mode, place
        for described in self.project.elements():
            self._set_mouse(self._elements[described.name], described)

    def _set_mouse(self, element, described):
        mode, place = self._mouse
        known = elements.properties(described.factory)
        for name, left in MOUSE.items():
            if name not in known:
                continue
            takes = described.name == place and mode in (nick for nick, _ in known[name].choices)
            value = described.get(name) if mode == "off" else mode if takes else left
            if elements.read(element, name) != value:
                elements.write(element, name, value)

    def milliseconds(self):
        """What a frame takes in all elements together: on the device, or in the thread that waits for it, whichever
        is longer."""
        made = [self._elements[e.name] for e in self.project.elements() if e.on]
        return max(sum(_stat(element, field) for element in made) for field in ("wall-ms", "device-ms"))

    def scene(self):
        """Fields of stats about the scene that the decomposer remembers; empty while frames come without depth."""
        stats = self._elements["decomposer"].get_property("stats")
        names = [stats.nth_field_name(i) for i in range(stats.n_fields())] if stats else []
        return {name: stats.get_value(name) for name in names if name.startswith("scene-")}

    def act(self, name, action, *arguments):
        """Emits an action signal of an element; returns what that does."""
        return self._elements[name].emit(action, *arguments)

    def frames(self):
        """Frames that the decomposer has completed."""
        return _stat(self._elements["decomposer"], "frames")


def _stat(element, field):
    stats = element.get_property("stats") if element.find_property("stats") else None
    return stats.get_value(field) if stats and stats.has_field(field) else 0


def _stays(before, now):
    """Whether the element that there was can become the one that shall be."""
    if not now or now.factory != before.factory:
        return False
    return all(elements.property_of(now.factory, name).live for name in _changed(before, now))


def _changed(before, now):
    """Names of the properties that differ between two states of an element."""
    return {n for n in {**before.properties, **now.properties} if before.get(n) != now.get(n)}
