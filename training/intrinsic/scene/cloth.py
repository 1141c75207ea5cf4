# SPDX-License-Identifier: LGPL-2.1-or-later
"""Cloth with folds: simulated where it lies over things or hangs, and rippled where it is worn."""
import math

import bpy
import numpy as np


def sheet(s, width, height, cells, material, place, repeat=1.0):
    """A grid of width × height, about `cells` along the longer side, whose point (x, y) lies at place(x, y)."""
    nx, ny = (max(4, round(cells * v / max(width, height))) for v in (width, height))
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, nx + 1), np.linspace(-0.5, 0.5, ny + 1))
    vertices = np.stack(place(x * width, y * height), -1).reshape(-1, 3)
    n = nx + 1
    faces = [(j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i) for j in range(ny) for i in range(nx)]
    flat = np.stack([x + 0.5, y + 0.5], -1).reshape(-1, 2) * repeat
    return s.mesh(vertices, faces, material, True, flat[np.array(faces).ravel()])


def settle(s, item, solids=(), pinned=(), frames=30, stiff=0.2):
    """Lets a sheet fall for so many frames (24 a second) onto solids, held at vertices `pinned`, and keeps its shape."""
    bpy.context.view_layer.update()
    for solid in solids:
        solid.modifiers.new("collision", "COLLISION")
        solid.collision.thickness_outer = 0.008
    if len(pinned):
        item.vertex_groups.new(name="pin").add([int(i) for i in pinned], 1, "REPLACE")
    cloth = item.modifiers.new("cloth", "CLOTH")
    cloth.settings.quality, cloth.settings.mass, cloth.settings.bending_stiffness = 4, 0.25, stiff
    cloth.collision_settings.collision_quality, cloth.collision_settings.distance_min = 2, 0.008
    cloth.point_cache.frame_end = frames
    if len(pinned):
        cloth.settings.vertex_group_mass = "pin"
    for frame in range(1, frames + 1):
        s.scene.frame_set(frame)
    shape = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    places = np.empty(3 * len(shape.vertices))
    shape.vertices.foreach_get("co", places)
    item.modifiers.clear()
    if np.isfinite(places).all():
        item.data.vertices.foreach_set("co", places)
    item.data.update()
    for solid in solids:
        solid.modifiers.remove(solid.modifiers["collision"])
    s.scene.frame_set(1)
    fine = item.modifiers.new("fine", "SUBSURF")
    fine.levels = fine.render_levels = 1
    return item


def drape(s, width, height, material, solids, at, cells=44, repeat=1.0):
    """A cloth that fell from `at` onto solids (which must stand on something)."""
    a = s.uniform(0, 6.28)
    tilt = s.rng.uniform(-0.15, 0.15, 2)

    def place(x, y):
        u, v = x * math.cos(a) - y * math.sin(a), x * math.sin(a) + y * math.cos(a)
        return at[0] + u, at[1] + v, at[2] + tilt[0] * u + tilt[1] * v

    return settle(s, sheet(s, width, height, cells, material, place, repeat), solids, frames=s.pick([22, 30]), stiff=s.pick([0.05, 0.3, 2]))


def hang(s, width, height, material, pins, gather=0.75, cells=44, repeat=1.0):
    """A cloth that hangs from its upper edge at y = 0, z = 0, held at `pins` points that are gathered to a share of its width."""

    def place(x, y):
        wave = 0.02 * np.sin(x / width * pins * 6.28 + 2 * y) + 0.01 * np.sin(x * 31 + 3)
        return x * gather, wave, y - height / 2

    item = sheet(s, width, height, cells, material, place, repeat)
    columns = max(4, round(cells * width / max(width, height))) + 1
    top = len(item.data.vertices) - columns
    return settle(s, item, pinned=top + np.linspace(0, columns - 1, pins).astype(int), frames=s.pick([20, 28]), stiff=s.pick([0.05, 0.3]))


def wrinkle(s, items, depth=0.012, size=0.12):
    """Rounds what is worn and gives it folds."""
    texture = bpy.data.textures.new("folds", "CLOUDS")
    texture.noise_scale, texture.noise_depth = size * s.uniform(0.7, 1.4), 1
    for item in items:
        fine = item.modifiers.new("fine", "SUBSURF")
        fine.levels = fine.render_levels = 2
        folds = item.modifiers.new("folds", "DISPLACE")
        folds.texture, folds.texture_coords, folds.mid_level, folds.strength = texture, "GLOBAL", 0.5, 2 * depth
        item.data.polygons.foreach_set("use_smooth", [True] * len(item.data.polygons))
    return items


def cushion(s, material, size=0.42):
    """A square pillow at the origin, flat."""

    def place(x, y):
        u, v = 2 * x / size, 2 * y / size
        return x * (1 - 0.06 * v * v), y * (1 - 0.06 * u * u), 0 * x

    k, b = s.uniform(0.14, 0.22) * size, s.rng.uniform(0, 6, 4)
    halves = []
    for side in (-1, 1):

        def bulge(x, y):
            px, py, _ = place(x, y)
            u, v = 2 * x / size, 2 * y / size
            body = np.sqrt(np.clip((1 - u**4) * (1 - v**4), 0, 1))
            folds = 0.12 * np.sin(7 * u * v + b[0]) * np.sin(5 * (u + v) + b[1]) + 0.08 * np.sin(11 * u + b[2]) * np.sin(3 * v + b[3])
            return px, py, side * k * body * (1 + folds)

        halves.append(sheet(s, size, size, 30, material, bulge))
    return halves


def folded(s, material, width=0.35, depth=0.28):
    """Folded towels or shirts in a pile, standing on z = 0; `material` makes one for each."""
    items, z = [], 0.0
    for _ in range(int(s.rng.integers(1, 4))):
        h = s.uniform(0.025, 0.05)
        items.append(s.box((width, depth, h * 0.95), material(), (s.uniform(-0.01, 0.01), 0, z + h / 2), s.uniform(-0.06, 0.06), soft=h * 0.45))
        z += h
    return wrinkle(s, items, 0.004, 0.1)


def crumpled(s, width, height, material, cells=40, depth=None):
    """A sheet that was folded or crumpled and lies nearly flat on z = 0."""
    depth = width * s.uniform(0.01, 0.05) if depth is None else depth
    lines = [(s.uniform(0, 3.14), s.uniform(-0.4, 0.4) * width, s.uniform(0.3, 1) * depth) for _ in range(int(s.rng.integers(2, 7)))]
    if s.chance(0.4):  # folded into halves or quarters
        lines = [(0.0, 0.0, depth), (math.pi / 2, 0.0, 0.7 * depth)][: s.pick([1, 2])]

    def place(x, y):
        z = 0 * x
        for a, shift, h in lines:
            z = z + h * np.exp(-np.abs(x * math.cos(a) + y * math.sin(a) - shift) / (0.2 * width)) * s.pick([-1, 1])
        return x, y, z - z.min() + 0.0005

    return sheet(s, width, height, cells, material, place)
