# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which layers a project has to show."""
from . import elements
from .selection import KEY, SELECT

NEEDS = {"direct": "globalintrinsic", "indirect": "globalintrinsic", "layer": "globalintrinsic",
         "diffuse": "limematerial", "specular": "limematerial", "mirror": "limematerial"}
NOT_OF_MATERIAL = ("reflectance", "shading")
NAMES = {"composed": "Picture", "input": "Original", "layer": "By base color"}


def choices():
    """(value of show, name, meaning) of all layers, in the element's order."""
    show = elements.property_of("intrinsiccompose", "show")
    return [(nick, NAMES.get(nick, nick.capitalize()), meaning) for nick, meaning in show.choices]


def missing(layer, project):
    """Why the project does not have the layer, and what to do; None if it has."""
    material = project.decomposer.factory == "limematerial"
    needed = NEEDS.get(layer)
    if needed and not project.decomposer.factory.startswith(needed):
        return f"{project.decomposer.factory} makes no layer {layer}.", f"Decompose by {needed} to see it."
    if material and layer in NOT_OF_MATERIAL:
        return f"limematerial makes no layer {layer}.", "Decompose by intrinsicdecomp to see it."
    if layer == "mask" and not material and not any(_writes_mask(e) for e in project.editors):
        return "There is no mask.", "Select an object (M), or turn on write-mask of an editor."
    return None


def _writes_mask(editor):
    if not editor.on:
        return False
    if "write-mask" in elements.properties(editor.factory):
        return editor.get("write-mask")
    return editor.factory == SELECT or editor.factory == KEY and editor.get("strength") > 0


def corrected(project):
    """The project, with the whole picture shown in place of a layer that is not there."""
    if missing(project.compose.get("show"), project):
        return project.with_element(project.compose.with_property("show", "composed"))
    return project
