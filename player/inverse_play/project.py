# SPDX-License-Identifier: LGPL-2.1-or-later
"""What was done to a video, as plain data: it is saved, loaded, undone, and written as a launch line."""
import dataclasses
import json
import os
import tempfile

from . import elements
from .elements import ElementError
from .source import unreadable

VERSION = 1


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


def _read_element(name, data, what):
    if not isinstance(data, dict) or not isinstance(data.get("element"), str):
        raise ElementError(f'{what} must be an object with "element" and "properties"')
    properties, on = data.get("properties", {}), data.get("on", True)
    if not isinstance(properties, dict) or not isinstance(on, bool):
        raise ElementError(f'"properties" of {what} must be an object, "on" true or false')
    element = Element(name, data["element"], {}, on)
    for key, value in properties.items():
        element = element.with_property(key, value)
    return element


def from_data(data):
    """The Project in a project file's data; raises ElementError."""
    if not isinstance(data, dict) or data.get("version") != VERSION:
        raise ElementError(f'a project is a JSON object with "version": {VERSION}')
    source, split, editors = data.get("source", ""), data.get("split"), data.get("editors", [])
    if not isinstance(source, str) or not isinstance(editors, list):
        raise ElementError('"source" must be a text, "editors" a list')
    if split is not None and not (isinstance(split, (int, float)) and 0 <= split <= 1):
        raise ElementError('"split" must be a number from 0 to 1, or null')
    default = Project()
    project = Project(source=source, split=split)
    for name in ("decomposer", "compose"):
        if name in data:
            project = project.with_element(_read_element(name, data[name], f'"{name}"'))
    _check_kind(project.decomposer, elements.decomposers(), "decomposer")
    _check_kind(project.compose, [default.compose.factory], "compose")
    return _with_editors(project, editors)


def _with_editors(project, editors):
    for place, data in enumerate(editors):
        editor = _read_element("", data, f"editor {place + 1}")
        _check_kind(editor, elements.editors(), f"editor {place + 1}")
        editor = dataclasses.replace(editor, name=project.new_name(editor.factory))
        project = project.with_editors(project.editors + (editor,))
    return project


def _check_kind(element, known, what):
    if element.factory not in known:
        raise ElementError(f"{element.factory} cannot be used as {what}; this installation has {', '.join(known)}")


def load(path):
    """Reads a project file; raises ElementError or OSError."""
    reason = unreadable(path)
    if reason:
        raise ElementError(f"the project cannot be loaded: {reason}")
    with open(path, encoding="utf-8") as file:
        try:
            data = json.load(file)
        except ValueError as error:
            raise ElementError(f"{path} is no project file: {error}") from None
    try:
        return from_data(data)
    except ElementError as error:
        raise ElementError(f"{path}: {error}") from None


def save(project, path):
    """Writes a project file; the one before stays whole until the new one is. Raises OSError."""
    folder = os.path.dirname(os.path.abspath(path))
    with tempfile.NamedTemporaryFile("w", dir=folder, encoding="utf-8", delete=False) as file:
        try:
            json.dump(to_data(project), file, indent=2)
            file.write("\n")
            file.close()
            os.chmod(file.name, 0o666 & ~_umask())
            os.replace(file.name, path)
        except BaseException:
            os.unlink(file.name)
            raise


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask


def parse_editor(text, project):
    """The project with one more editor, from a piece of a launch line: "intrinsicrecolor key=0xffc03020"."""
    factory, *settings = text.split()
    _check_kind(Element("", factory), elements.editors(), "editor")
    editor = Element(project.new_name(factory), factory)
    for setting in settings:
        name, equals, value = setting.partition("=")
        if not equals:
            raise ElementError(f"{setting} is no NAME=VALUE")
        editor = editor.with_property(name, value)
    return project.with_editors(project.editors + (editor,))
