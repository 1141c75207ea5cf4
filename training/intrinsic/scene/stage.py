# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a scene is built on: Blender's render settings, its lights in light groups, meshes, and where they stand. Units are meters."""
import math

import bpy
import numpy as np
from mathutils import Matrix, Vector


class Stage:
    """An empty scene with a random generator, and the names of all that was put into it."""

    def __init__(self, rng, assets):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.rng, self.assets = rng, assets
        self.scene = bpy.context.scene
        self.layer = self.scene.view_layers[0]
        self.groups, self.used = {}, set()  # light groups by name: their kind; files of the assets that were used
        self.scene.world = bpy.data.worlds.new("world")
        self.scene.world.use_nodes = True
        self.sky(0)

    def chance(self, p):
        return self.rng.random() < p

    def uniform(self, low, high):
        return float(self.rng.uniform(low, high))

    def pick(self, items, weights=None):
        items = list(items)
        p = None if weights is None else np.array(weights, float) / np.sum(weights)
        return items[int(self.rng.choice(len(items), p=p))]

    # -- lights, all white: colors are chosen when pictures are mixed

    def group(self, kind):
        """A new light group of this kind: sun, sky, lamp or window."""
        name = f"{kind}{len(self.groups)}"
        self.groups[name] = kind
        self.layer.lightgroups.add(name=name)
        return name

    def lamp(self, data, at, group, toward=None):
        item = bpy.data.objects.new(group, data)
        item.location = at
        if toward is not None:
            item.rotation_euler = (Vector(toward) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
        item.lightgroup, item.visible_camera = group, False
        self.scene.collection.objects.link(item)
        return item

    def area(self, at, toward, size, power, group, spread=180):
        data = bpy.data.lights.new("area", "AREA")
        data.shape, data.size, data.size_y, data.energy = "RECTANGLE", size[0], size[1], power
        data.spread = math.radians(spread)
        return self.lamp(data, at, group, toward)

    def bulb(self, at, radius, power, group):
        data = bpy.data.lights.new("bulb", "POINT")
        data.shadow_soft_size, data.energy = radius, power
        return self.lamp(data, at, group)

    def spot(self, at, toward, radius, power, angle, group):
        data = bpy.data.lights.new("spot", "SPOT")
        data.shadow_soft_size, data.energy, data.spot_size, data.spot_blend = radius, power, math.radians(angle), 0.6
        return self.lamp(data, at, group, toward)

    def sun(self, elevation, azimuth, strength, group, disk=0.53):
        """Elevation and azimuth point to the sun, in degrees; disk is its diameter."""
        data = bpy.data.lights.new("sun", "SUN")
        data.energy, data.angle = strength, math.radians(disk)
        e, a = math.radians(elevation), math.radians(azimuth)
        direction = Vector((math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)))
        self.lamp(data, direction * 50, group, (0, 0, 0))
        return direction

    def sky(self, strength, group=None):
        """Gray sky: brighter or darker toward the horizon, with clouds; below the horizon a dark ground."""
        world, tree = self.scene.world, self.scene.world.node_tree
        tree.nodes.clear()
        background, output = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
        tree.links.new(background.outputs[0], output.inputs[0])
        background.inputs[1].default_value = strength
        background.inputs[0].default_value = (1, 1, 1, 1)
        if strength == 0:
            return
        world.lightgroup = group
        world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 128  # 1024, the default, takes 3 s
        place, ramp = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeValToRGB")
        split, noise = tree.nodes.new("ShaderNodeSeparateXYZ"), tree.nodes.new("ShaderNodeTexNoise")
        mix, clouds = tree.nodes.new("ShaderNodeMixRGB"), tree.nodes.new("ShaderNodeValToRGB")
        tree.links.new(place.outputs["Generated"], split.inputs[0])
        tree.links.new(split.outputs["Z"], ramp.inputs[0])
        horizon, zenith = self.uniform(0.5, 1.6), self.uniform(0.5, 1.2)
        stops = ((0.0, 0.12), (0.49, 0.12), (0.5, horizon), (1.0, zenith))
        while len(ramp.color_ramp.elements) < len(stops):
            ramp.color_ramp.elements.new(0.5)
        for element, (position, value) in zip(ramp.color_ramp.elements, stops):
            element.position, element.color = max(0, 2 * position - 1) if position > 0.5 else 0, (value, value, value, 1)
        noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = self.uniform(1.5, 4), 5
        tree.links.new(place.outputs["Generated"], noise.inputs["Vector"])
        tree.links.new(noise.outputs["Fac"], clouds.inputs[0])
        clouds.color_ramp.elements[0].position, clouds.color_ramp.elements[1].position = 0.45, 0.7
        clouds.color_ramp.elements[0].color = (1, 1, 1, 1)
        top = self.pick([1.0, 1.6, 2.2])
        clouds.color_ramp.elements[1].color = (top, top, top, 1)
        mix.blend_type, mix.inputs[0].default_value = "MULTIPLY", 1
        tree.links.new(ramp.outputs[0], mix.inputs[1])
        tree.links.new(clouds.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], background.inputs[0])

    # -- meshes

    def mesh(self, vertices, faces, material, smooth=False, uv=None):
        """uv: a pair for each corner of each face, in order."""
        data = bpy.data.meshes.new("mesh")
        data.from_pydata([tuple(map(float, v)) for v in vertices], [], [tuple(map(int, f)) for f in faces])
        data.materials.append(material)
        if smooth:
            data.polygons.foreach_set("use_smooth", [True] * len(data.polygons))
        if uv is not None:
            data.uv_layers.new().data.foreach_set("uv", np.asarray(uv, float).ravel())
        data.update()
        item = bpy.data.objects.new("item", data)
        self.scene.collection.objects.link(item)
        return item

    def place(self, items, at=(0, 0, 0), turn=0.0, tilt=(0, 0)):
        """Turns things about z (radians), after tilts about x and y, and moves them."""
        move = Matrix.Translation(at) @ Matrix.Rotation(turn, 4, "Z") @ Matrix.Rotation(tilt[0], 4, "X") @ Matrix.Rotation(tilt[1], 4, "Y")
        for item in items:
            item.matrix_basis = move @ item.matrix_basis
        return items

    def soften(self, item, width, segments=2):
        """Rounds its edges."""
        bevel = item.modifiers.new("bevel", "BEVEL")
        bevel.width, bevel.segments, bevel.limit_method = width, segments, "ANGLE"
        item.data.polygons.foreach_set("use_smooth", [True] * len(item.data.polygons))
        item.data.use_auto_smooth, item.data.auto_smooth_angle = True, math.radians(40)
        return item

    def box(self, size, material, at=(0, 0, 0), turn=0.0, soft=0.0):
        """Its center at `at`."""
        x, y, z = (s / 2 for s in size)
        vertices = [(i * x, j * y, k * z) for k in (-1, 1) for j in (-1, 1) for i in (-1, 1)]
        faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        item = self.mesh(vertices, faces, material)
        if soft:
            self.soften(item, soft)
        return self.place([item], at, turn)[0]

    def quad(self, corners, material):
        """Four corners against the clock, the first at the lower left of its picture."""
        return self.mesh(corners, [(0, 1, 2, 3)], material, uv=[(0, 0), (1, 0), (1, 1), (0, 1)])

    def card(self, width, height, material, at=(0, 0, 0), turn=0.0, upright=False):
        """A sheet with a picture: flat with its front up, or upright with its front to -y."""
        w, h = width / 2, height / 2
        if upright:
            corners = [(-w, 0, -h), (w, 0, -h), (w, 0, h), (-w, 0, h)]
        else:
            corners = [(-w, -h, 0), (w, -h, 0), (w, h, 0), (-w, h, 0)]
        return self.place([self.quad(corners, material)], at, turn)[0]

    def lathe(self, profile, material, at=(0, 0, 0), sides=32, smooth=True, closed=True):
        """A solid of revolution about z from (radius, height) pairs, bottom first."""
        angle = np.arange(sides) * 2 * math.pi / sides
        rings = [np.stack([r * np.cos(angle), r * np.sin(angle), np.full(sides, z)], 1) for r, z in profile]
        faces = [
            (i * sides + j, i * sides + (j + 1) % sides, (i + 1) * sides + (j + 1) % sides, (i + 1) * sides + j)
            for i in range(len(profile) - 1)
            for j in range(sides)
        ]
        if closed:
            faces += [tuple(reversed(range(sides))), tuple(range((len(profile) - 1) * sides, len(profile) * sides))]
        item = self.mesh(np.concatenate(rings), faces, material, smooth)
        item.data.use_auto_smooth, item.data.auto_smooth_angle = True, math.radians(45)
        return self.place([item], at)[0]

    def cylinder(self, radius, height, material, at=(0, 0, 0), sides=32, top=None):
        """Stands on `at`."""
        return self.lathe([(radius, 0), (radius if top is None else top, height)], material, at, sides)

    def tube(self, path, radius, material, sides=10):
        """A round bar along points."""
        path = [Vector(p) for p in path]
        vertices, faces = [], []
        for i, p in enumerate(path):
            along = (path[min(i + 1, len(path) - 1)] - path[max(i - 1, 0)]).normalized()
            across = along.orthogonal().normalized()
            other = along.cross(across)
            for j in range(sides):
                a = 2 * math.pi * j / sides
                vertices.append(p + radius * (math.cos(a) * across + math.sin(a) * other))
        for i in range(len(path) - 1):
            for j in range(sides):
                k = (j + 1) % sides
                faces.append((i * sides + j, i * sides + k, (i + 1) * sides + k, (i + 1) * sides + j))
        faces += [tuple(reversed(range(sides))), tuple(range((len(path) - 1) * sides, len(path) * sides))]
        return self.mesh(vertices, faces, material, True)

    def ball(self, radius, material, at=(0, 0, 0), scale=(1, 1, 1), rings=16):
        a = np.linspace(0, math.pi, rings)[1:-1]
        profile = [(1e-4, -radius)] + [(radius * math.sin(t), -radius * math.cos(t)) for t in a] + [(1e-4, radius)]
        item = self.lathe(profile, material, sides=2 * rings)
        item.matrix_basis = Matrix.Translation(at) @ Matrix.Diagonal((*scale, 1)) @ item.matrix_basis
        return item

    def cloth(self, width, height, material, height_of, cells=48):
        """A sheet over x and y whose z is height_of(x, y), with a picture on it."""
        x, y = np.meshgrid(np.linspace(-0.5, 0.5, cells + 1), np.linspace(-0.5, 0.5, cells + 1))
        z = height_of(x * width, y * height)
        vertices = np.stack([x * width, y * height, z], -1).reshape(-1, 3)
        n = cells + 1
        faces = [(j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i) for j in range(cells) for i in range(cells)]
        flat = np.stack([x + 0.5, y + 0.5], -1).reshape(-1, 2)
        return self.mesh(vertices, faces, material, True, flat[np.array(faces).ravel()])

    def glow(self, corners, value, group):
        """A bright pane that the camera sees and that lights nothing; its pixels are not part of the truth."""
        material = bpy.data.materials.new("glow")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        emit, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
        emit.inputs[1].default_value = value
        tree.links.new(emit.outputs[0], output.inputs[0])
        material.cycles.sample_as_light = False  # else half of all rays to lights go to panes, which light nothing
        item = self.quad(corners, material)
        item.lightgroup = group
        item.visible_diffuse = item.visible_shadow = item.visible_glossy = item.visible_transmission = False
        return item
