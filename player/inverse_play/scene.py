# SPDX-License-Identifier: LGPL-2.1-or-later
"""The scene that a decomposer remembers of frames with depth: what is done with it, and what is said of it."""
import dataclasses
import json

from . import elements
from .json_list import entries, with_entries

TOUCH, UPDATE, LOAD, MODE, STROKES = "strokes::touch", "scene::update", "scene::load", "strokes::mode", "strokes::list"
SAVE_ACTION, FORGET_ACTION = "save-scene", "forget-scene"


def is_offered(factory):
    """Whether a decomposer can remember a scene."""
    return {TOUCH, UPDATE, LOAD} <= set(elements.properties(factory))


def text(stats):
    """What fields of stats say, for people."""
    if not stats:
        return ""
    lost = stats.get("scene-frames-lost", 0)
    camera = "camera found" if stats.get("scene-camera-found") else f"camera lost for {lost} frames"
    touched = " · touched" if stats.get("scene-touched") else ""
    return f"Scene: {camera} · {stats.get('scene-blocks', 0)} blocks{touched}"


def touched(on):
    """Settings by which a hand draws, or no longer does: meanwhile the scene stays as it is."""
    return {TOUCH: True, UPDATE: False} if on else {TOUCH: False, UPDATE: True, MODE: "off"}


def placed(before, after):
    """If a decomposer has put strokes of a property into the scene, and maybe got others behind them, a function that
    describes them in the same way in a project of before; None if something else has changed."""
    old, new = entries(before, "strokes"), entries(after, "strokes")
    pairs = list(zip(old, new))
    moved = any("balls" in now and "balls" not in then for then, now in pairs)
    if not moved or len(new) < len(old) or any(then["kind"] != now["kind"] for then, now in pairs):
        return None
    changed = {json.dumps(then): now for then, now in pairs}

    def described_anew(project):
        text_before = project.decomposer.properties.get(STROKES)
        if not text_before:
            return project
        text_after = after if text_before == before and len(new) == len(old) else _exchanged(text_before, changed)
        return dataclasses.replace(project, decomposer=project.decomposer.with_property(STROKES, text_after))
    return described_anew


def _exchanged(value, changed):
    """A property with other strokes in place of some, which are named by their JSON."""
    strokes = entries(value, "strokes")
    exchanged = [changed.get(json.dumps(stroke), stroke) for stroke in strokes]
    if exchanged == strokes:
        return value
    return with_entries(value, "strokes", exchanged)
