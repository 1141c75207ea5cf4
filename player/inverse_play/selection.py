# SPDX-License-Identifier: LGPL-2.1-or-later
"""Objects that the mouse selects: strokes of intrinsicselect, and the editors that use them."""
import dataclasses
import json
import math

from .json_list import entries
from .project import Element

SELECT, RECOLOR, KEY = "intrinsicselect", "intrinsicrecolor", "intrinsickey"
MAX_STROKES, MAX_POINTS = 64, 4096  # that the element takes


@dataclasses.dataclass
class Stroke:
    """Drawn on an object. `points` are in pixels of the frame; `closed` takes what is inside of the line."""
    kind: str
    radius: float
    points: list
    closed: bool = False

    def extend(self, x, y):
        """Goes on to a point. Whether that is far enough to count."""
        far = math.dist(self.points[-1], (x, y)) >= max(self.radius / 4, 1) and len(self.points) < MAX_POINTS
        if far:
            self.points.append((x, y))
        return far

    def data(self, across, down):
        """The stroke as the property strokes::list has it. `across`, `down`: factors to the size that it is for."""
        made = {"kind": self.kind, "radius": round(self.radius, 1)}
        if self.closed:
            made["closed"] = True
        return {**made, "points": [[round(x * across, 1), round(y * down, 1)] for x, y in self.points]}


def is_full(select):
    """Whether an intrinsicselect has as many strokes as it may; None has none."""
    return bool(select) and len(entries(select.get("strokes::list"), "strokes")) >= MAX_STROKES


def with_stroke(text, stroke, frame):
    """The property strokes::list with one more stroke, which was drawn on a frame of the size `frame`. Ask `is_full` first."""
    data = json.loads(text) if text else {"frame": list(frame), "strokes": []}
    size, strokes = (data["frame"], data["strokes"]) if isinstance(data, dict) else (frame, data)
    strokes = strokes + [stroke.data(size[0] / frame[0], size[1] / frame[1])]
    whole = {"frame": size, "strokes": strokes} if isinstance(data, dict) else strokes
    return json.dumps(whole, separators=(",", ":"))


def selection_of(project, selected):
    """The intrinsicselect by strokes whose mask an editor uses: itself, or the last one before it. None without."""
    found = None
    for editor in project.editors:
        if editor.factory == SELECT and editor.on:
            found = editor if editor.get("by") == "strokes" else None
        if editor.name == selected:
            return found
    return None


def _painter_of(project, select):
    """The intrinsicrecolor that paints what `select` selects, or None."""
    for editor in project.editors[project.index(select.name) + 1:]:
        if editor.factory == SELECT and editor.on:
            return None
        if editor.factory == RECOLOR and editor.on and not {"key", "base-color", "cluster"} & set(editor.properties):
            return editor
    return None


def drawn(project, selected, stroke, frame, paints):
    """(project, name of the element to set next) after a stroke on the object that the editor `selected` belongs
    to; on a new object if it belongs to none. `paints`: it is recolored as well."""
    select = selection_of(project, selected)
    if not select:
        select = Element(project.new_name(SELECT), SELECT)
        project = project.with_editors((*project.editors, select))
    select = select.with_property("strokes::list", with_stroke(select.get("strokes::list"), stroke, frame))
    project = project.with_element(select)
    if not paints:
        return project, select.name
    painter = _painter_of(project, select)
    if not painter:
        painter = Element(project.new_name(RECOLOR), RECOLOR)
        project = project.with_editor_behind(painter, select.name)
    return project, painter.name
