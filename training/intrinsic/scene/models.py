# SPDX-License-Identifier: LGPL-2.1-or-later
"""Meshes of the assets, painted anew with Lambertian materials and scaled to their size in meters."""
import pathlib

import bpy
import numpy as np
from mathutils import Matrix

# Blender 3.4's importers use a name that NumPy 1.24 no longer has.
if not hasattr(np, "bool"):
    np.bool = bool

# Meshes of the assets: folder, words in the name, the length that is scaled and to what, in meters.
MODELS = {
    "sofa": [
        ("polyhaven", "sofa", "x", (1.7, 2.4)),
        ("quaternius/furniture2019", "Sofa", "z", (0.75, 0.9)),
        ("quaternius/furniture2017", "Sofa", "z", (0.75, 0.9)),
    ],
    "shelf": [
        ("polyhaven", "bookshelf", "z", (1.7, 2.1)),
        ("quaternius/furniture2019", "Bookcase", "z", (1.6, 2.1)),
        ("quaternius/furniture2017", "BookCase", "z", (1.4, 2)),
    ],
    "cabinet": [
        ("polyhaven", "cabinet", "z", (0.9, 2.1)),
        ("quaternius/furniture2019", "Closet", "z", (1.2, 2.1)),
        ("quaternius/furniture2017", "Closet", "z", (0.9, 1.8)),
    ],
    "seat": [
        ("polyhaven", "stool", "z", (0.45, 0.6)),
        ("quaternius/furniture2019", "hair", "z", (0.9, 1.1)),
        ("quaternius/furniture2017", "Chair", "z", (0.85, 1.0)),
        ("quaternius/furniture2019", "Stool", "z", (0.45, 0.6)),
    ],
    "table": [
        ("polyhaven", "table", "z", (0.7, 0.78)),
        ("quaternius/furniture2019", "Table", "z", (0.7, 0.78)),
        ("quaternius/furniture2017", "Table", "z", (0.45, 0.75)),
    ],
    "bed": [("quaternius/furniture2019", "Bed", "z", (0.8, 1)), ("quaternius/furniture2017", "Bed", "z", (0.6, 0.8))],
    "tea": [("polyhaven", "tea", "x", (0.5, 0.9))],
    "car": [("quaternius/cars", "", "y", (3.7, 4.6))],
    "person": [
        ("quaternius/people", "Standing", "z", (1.6, 1.85)),
        ("quaternius/people", "Walking", "z", (1.6, 1.85)),
        ("quaternius/people", "Running", "z", (1.6, 1.8)),
    ],
    "bicycle": [("quaternius/transport", "Bicycle", "y", (1.6, 1.8))],
    "light": [("quaternius/street", "Streetlight", "z", (3, 4.5))],
    "traffic": [
        ("quaternius/street", "TrafficLight", "z", (2.5, 3.5)),
        ("quaternius/transport", "TrafficLight", "z", (2.5, 3.5)),
        ("quaternius/transport", "TrafficCone", "z", (0.4, 0.8)),
    ],
}


def load(stage, materials, kind):
    """A mesh of this kind, painted anew, or none."""
    s, root = stage, pathlib.Path(stage.assets or "/nonexistent") / "models"
    found = []
    for folder, word, axis, sizes in MODELS[kind]:
        files = [f for f in sorted((root / folder).glob("*")) if f.suffix in (".fbx", ".gltf") and word in f.name and "Hair" not in f.name]
        if files:
            found.append((files, axis, sizes))
    if not found:
        return []
    files, axis, sizes = s.pick(found)
    path = s.pick(files)
    before = set(bpy.data.objects)
    try:
        (bpy.ops.import_scene.fbx if path.suffix == ".fbx" else bpy.ops.import_scene.gltf)(filepath=str(path))
    except (RuntimeError, AttributeError):
        return []
    s.used.add(path.name)
    new = [o for o in bpy.data.objects if o not in before]
    bpy.context.view_layer.update()
    items = []
    paints = {}
    for o in new:
        if o.type != "MESH":
            continue
        item = bpy.data.objects.new("item", o.data)
        o.data.transform(o.matrix_world)
        if o.matrix_world.determinant() < 0:
            o.data.flip_normals()
        s.scene.collection.objects.link(item)
        for i, material in enumerate(o.data.materials):
            if material and material.name not in paints:
                paints[material.name] = repaint(stage, materials, material)
            o.data.materials[i] = paints[material.name] if material else materials.paint()
        items.append(item)
    for o in new:
        bpy.data.objects.remove(o)
    points = np.array([v.co for i in items for v in i.data.vertices])
    if not len(points):
        return []
    low, high = points.min(0), points.max(0)
    scale = s.uniform(*sizes) / max((high - low)["xyz".index(axis)], 1e-6)
    shift = Matrix.Diagonal((scale,) * 3 + (1,)) @ Matrix.Translation((-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2]))
    for item in items:
        item.data.transform(shift)
    return items


def repaint(stage, materials, material):
    """A Lambertian material in its place: its picture, wood for wood, else any paint."""
    if material.use_nodes:
        base = [n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED"]
        links = base[0].inputs["Base Color"].links if base else ()
        node = links[0].from_node if links else None
        if node is not None and node.type == "TEX_IMAGE" and node.image:
            new, tree, diffuse = materials.empty((0.5,) * 3)
            texture, place = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeTexCoord")
            texture.image = node.image
            tree.links.new(place.outputs["UV"], texture.inputs[0])
            change = tree.nodes.new("ShaderNodeHueSaturation")
            change.inputs["Hue"].default_value = 0.5 if stage.chance(0.6) else stage.rng.random()
            change.inputs["Value"].default_value = stage.uniform(0.8, 1.5)
            tree.links.new(texture.outputs[0], change.inputs["Color"])
            materials._clamp(tree, change.outputs[0], diffuse)
            return new
    name = material.name.lower()
    fixed = {
        "black": (0.02, 0.05),
        "grey": (0.1, 0.3),
        "window": (0.02, 0.05),
        "glass": (0.03, 0.1),
        "white": (0.6, 0.85),
        "metal": (0.1, 0.5),
        "pages": (0.6, 0.8),
        "wheel": (0.02, 0.05),
    }
    for word, (low, high) in fixed.items():
        if word in name:
            return materials.paint(materials.gray(low, high))
    if "wood" in name or "brown" in name:
        return materials.wood() if stage.chance(0.8) else materials.paint()
    if "skin" in name:
        return materials.paint(tuple(np.array([0.5, 0.28, 0.18]) * stage.uniform(0.2, 1.3)))
    if any(w in name for w in ("sofa", "sheet", "cush", "pillow", "comfort", "shirt", "pants", "mattress", "chair")):
        return materials.fabric()
    return materials.paint()
