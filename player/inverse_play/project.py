# SPDX-License-Identifier: LGPL-2.1-or-later
"""What was done to a video, as plain data: it is saved, loaded, undone, and written as a launch line."""
import dataclasses
import json
import os
import shlex

from inverse_common import files

from . import elements
from .elements import ElementError
from .source import kind_of, unreadable

VERSION = 1
MAX_BYTES = 16 << 20  # of a project file; a stroke takes some hundred
MAX_EDITORS = 100
# Names of properties in older files, of elements that have them no longer.
RENAMED = {
    "strokes": "strokes::list", **{f"stroke-{n}": f"strokes::{n}" for n in ("mode", "radius", "fill", "color", "follow", "touch")},
    "scene-memory": "scene::remember", "scene-depth": "scene::max-depth", "voxel-size": "scene::voxel-size",
    **{f"scene-{n}": f"scene::{n}" for n in ("weight", "track", "update", "memory-limit", "load", "location")}}


@dataclasses.dataclass(frozen=True)
class Element:
    """An element of the chain with those properties that differ from their defaults."""
    name: str
    factory: str
    properties: dict = dataclasses.field(default_factory=dict)
    on: bool = True

    def get(self, name):
        """A property's value, as elements.read returns it."""
        default = elements.property_of(self.factory, name).default
        return self.properties.get(name, default)

    def with_property(self, name, value):
        """The element with another value."""
        value = elements.checked(self.factory, name, value)
        changed = {k: v for k, v in self.properties.items() if k != name}
        if value != elements.property_of(self.factory, name).default:
            changed[name] = value
        return dataclasses.replace(self, properties=changed)


@dataclasses.dataclass(frozen=True)
class Project:
    """A decomposer, the editors behind it in their order, and intrinsiccompose. `split`: where the divider
    between the original and the edited picture is, 0…1; None without one."""
    source: str = ""
    decomposer: Element = Element("decomposer", "intrinsicdecomp")
    editors: tuple = ()
    compose: Element = Element("compose", "intrinsiccompose")
    split: float = None

    def elements(self):
        """All elements."""
        return (self.decomposer, *self.editors, self.compose)

    def element(self, name):
        """The element of that name, or None."""
        return next((e for e in self.elements() if e.name == name), None)

    def with_element(self, changed):
        """The project with the element of that name replaced."""
        if changed.name == "decomposer":
            return dataclasses.replace(self, decomposer=changed)
        if changed.name == "compose":
            return dataclasses.replace(self, compose=changed)
        return self.with_editors(changed if e.name == changed.name else e for e in self.editors)

    def with_editors(self, editors):
        """The project with these editors."""
        return dataclasses.replace(self, editors=tuple(editors))

    def with_editor_behind(self, editor, name):
        """The project with one more editor behind the one of that name; behind all if there is none."""
        names = [e.name for e in self.editors]
        at = names.index(name) + 1 if name in names else len(names)
        return self.with_editors((*self.editors[:at], editor, *self.editors[at:]))

    def new_name(self, factory):
        """A name for another editor: recolor1, recolor2 …"""
        stem = factory.removeprefix("intrinsic") or factory
        taken = {e.name for e in self.editors}
        return next(n for n in (f"{stem}{i}" for i in range(1, len(taken) + 2)) if n not in taken)

    def index(self, name):
        """The place of an editor in the chain."""
        return [e.name for e in self.editors].index(name)


def _element_data(element, with_on):
    data = {"element": element.factory, "properties": element.properties}
    return {**data, "on": element.on} if with_on else data


def to_data(project):
    """What a project file has."""
    return {"version": VERSION, "source": project.source,
            "decomposer": _element_data(project.decomposer, False),
            "editors": [_element_data(e, True) for e in project.editors],
            "compose": _element_data(project.compose, False), "split": project.split}


def _read_element(name, data, known, what):
    if not isinstance(data, dict) or not isinstance(data.get("element"), str):
        raise ElementError(f'{what} must be an object with "element" and "properties"')
    _check_kind(data["element"], known, what)  # no other element is made
    properties, on = data.get("properties", {}), data.get("on", True)
    if not isinstance(properties, dict) or not isinstance(on, bool):
        raise ElementError(f'"properties" of {what} must be an object, "on" true or false')
    element = Element(name, data["element"], {}, on)
    for key, value in properties.items():
        known = elements.properties(element.factory)
        element = element.with_property(key if key in known else RENAMED.get(key, key), value)
    return element


def from_data(data):
    """The Project in a project file's data; raises ElementError."""
    if not isinstance(data, dict) or data.get("version") != VERSION:
        raise ElementError(f'a project is a JSON object with "version": {VERSION}')
    source, split, editors = data.get("source", ""), data.get("split"), data.get("editors", [])
    try:
        elements.text_of(source)
    except ValueError:
        raise ElementError('"source" must be a text') from None
    if not isinstance(editors, list) or len(editors) > MAX_EDITORS:
        raise ElementError(f'"editors" must be a list of at most {MAX_EDITORS}')
    if split is not None and not (isinstance(split, (int, float)) and 0 <= split <= 1):
        raise ElementError('"split" must be a number from 0 to 1, or null')
    default = Project()
    project = Project(source=source, split=split)
    for name, known in (("decomposer", elements.decomposers()), ("compose", [default.compose.factory])):
        if name in data:
            project = project.with_element(_read_element(name, data[name], known, f'"{name}"'))
    return _with_editors(project, editors)


def _with_editors(project, editors):
    for place, data in enumerate(editors):
        editor = _read_element("", data, elements.editors(), f"editor {place + 1}")
        editor = dataclasses.replace(editor, name=project.new_name(editor.factory))
        project = project.with_editors(project.editors + (editor,))
    return project


def _check_kind(factory, known, what):
    if factory not in known:
        raise ElementError(f"{factory} cannot be used as {what}; this installation has {', '.join(known)}")


def load(path):
    """Reads a project file; raises ElementError or OSError."""
    reason = unreadable(path)
    if reason:
        raise ElementError(f"the project cannot be loaded: {reason}")
    if os.path.getsize(path) > MAX_BYTES:
        raise ElementError(f"{path} is no project file: it has more than {MAX_BYTES >> 20} MiB")
    with open(path, encoding="utf-8") as file:
        try:
            data = json.load(file)
        except (ValueError, RecursionError) as error:
            raise ElementError(f"{path} is no project file: {error}") from None
    try:
        return from_data(data)
    except ElementError as error:
        raise ElementError(f"{path}: {error}") from None


def demands(project):
    """What a project does when it is opened that a picture does not need, a line each, as a person is asked about it: it runs elements, opens
    connections or writes files. Empty for one that does none of this."""
    found = []
    kind = kind_of(project.source) if project.source else ""
    if kind == "line":
        found.append(f"runs the launch line {project.source}")
    elif kind == "uri":
        found.append(f"opens {project.source}")
    for element in project.elements():
        for name, value in element.properties.items():
            described = elements.property_of(element.factory, name)
            effect = described.effect or ("" if elements.is_own(element.factory) or not isinstance(value, str) else "sets")
            words = {"runs": f"runs the elements {value}", "writes": f"writes the file {value}",
                     "sets": f"sets {name} of {element.factory} to {value}"}
            if effect and value:
                found.append(words[effect])
    return found


def save(project, path):
    """Writes a project file; the one before stays whole until the new one is. Raises OSError."""
    files.write(path, json.dumps(to_data(project), indent=2) + "\n")


def _words(text):
    """Those of a launch line: quotes keep spaces in one."""
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise ElementError(f"{text} is no editor: {error}") from None
    if not words:
        raise ElementError("an editor is an element with its settings, such as intrinsicrecolor key=0xffc03020")
    return words


def parse_editor(text, project):
    """The project with one more editor, from a piece of a launch line: "intrinsicrecolor key=0xffc03020"."""
    factory, *settings = _words(text)
    _check_kind(factory, elements.editors(), "editor")
    editor = Element(project.new_name(factory), factory)
    for setting in settings:
        name, equals, value = setting.partition("=")
        if not equals:
            raise ElementError(f"{setting} is no NAME=VALUE")
        editor = editor.with_property(name, value)
    return project.with_editors(project.editors + (editor,))
