# SPDX-License-Identifier: LGPL-2.1-or-later
"""Lambertian materials: one color, photographed textures, drawn pictures, and procedural ones. Colors are linear RGB."""
import colorsys
import math
import pathlib
import re

import bpy
import numpy as np

DARKEST = 0.02  # shading is radiance over reflectance
BRIGHTEST = 0.9

# What a photographed texture is good for, by words in its file's name; and the width of one tile in meters.
PHOTOS = {
    "asphalt": (r"asphalt", 2.5),
    "brick": (r"brick_wall|broken_brick|^brick_?\d|red_brick", 2.0),
    "paving": (r"brick_floor|brick_villa|cobble|paving|anti_slip", 2.0),
    "tiles": (r"tiles|terrazzo|marble", 1.2),
    "fabric": (r"fabric", 0.5),
    "carpet": (r"carpet|fabric", 1.0),
    "paper": (r"wallpaper|paper|cardboard", 1.0),
    "concrete": (r"concrete|broken_wall", 2.0),
    "wall": (r"beige_wall|beam_wall|concrete_wall|white_|plaster", 2.0),
    "planks": (r"planks", 1.5),
    "wood": (r"wood|veneer", 1.0),
    "ground": (r"aerial|mud|rock|grass|gravel|forest", 3.0),
    "metal": (r"metal|shutter", 1.5),
}


class Materials:
    def __init__(self, stage):
        self.stage, self.rng, self.pictures = stage, stage.rng, None  # pictures: Pictures, which need materials for their colors
        folder = pathlib.Path(stage.assets or "/nonexistent") / "textures"
        files = sorted(folder.glob("*.[jp][pn]g")) if folder.is_dir() else []
        self.photos = {kind: [f for f in files if re.search(words, f.name)] for kind, (words, _) in PHOTOS.items()}
        # what a scene's paints share: how colored they are, and whether things are dark before light walls or the reverse
        self.saturation = stage.pick([1, stage.uniform(0.2, 0.7), 0], [6, 1.5, 2])
        self.things = stage.pick(["any", "dark", "light"], [6, 2.5, 1])

    # -- colors

    def pale(self, color):
        """With the scene's saturation."""
        color = np.asarray(color, float)
        return tuple(np.clip(color.mean() + self.saturation * (color - color.mean()), DARKEST, BRIGHTEST))

    def toned(self, color):
        """Of a thing: dark or light where the scene's things are."""
        color = np.array(self.pale(color))
        if self.things == "dark" and self.stage.chance(0.7):
            color = color * self.stage.uniform(0.025, 0.1) / max(color.mean(), 0.025)
        elif self.things == "light" and self.stage.chance(0.7):
            color = color * self.stage.uniform(0.5, 0.8) / max(color.max(), 0.03)
        return tuple(np.clip(color, DARKEST, BRIGHTEST))

    def gray(self, low=0.03, high=0.85):
        value = math.exp(self.stage.uniform(math.log(low), math.log(high)))
        tint = 1 + self.rng.normal(0, 0.02, 3)
        return tuple(np.clip(value * tint, DARKEST, BRIGHTEST))

    def color(self):
        """Any paint: black, white and gray, dark, vivid or pale."""
        kind = self.stage.pick(["black", "white", "gray", "dark", "vivid", "pale", "earth"], [14, 22, 12, 14, 13, 12, 13])
        if kind in ("black", "white", "gray"):
            return self.gray(*{"black": (0.022, 0.06), "white": (0.65, 0.88), "gray": (0.08, 0.5)}[kind])
        hue, u = self.rng.random(), self.stage.uniform
        if kind == "dark":  # navy, brown, bottle green, maroon
            hsv = (self.stage.pick([0.62, 0.06, 0.38, 0.98, hue]), u(0.4, 0.85), u(0.05, 0.16))
        elif kind == "vivid":
            hsv = (hue, u(0.6, 0.92), u(0.25, 0.8))
        elif kind == "pale":
            hsv = (hue, u(0.08, 0.35), u(0.5, 0.85))
        else:
            hsv = (u(0.03, 0.12), u(0.3, 0.75), u(0.1, 0.55))
        return self.pale(colorsys.hsv_to_rgb(*hsv))

    def wall_color(self):
        if self.things == "light":
            return self.gray(0.025, 0.12) if self.stage.chance(0.5) else self.pale(np.array(self.color()) * 0.2)
        if self.things == "dark" or self.stage.chance(0.5):
            base = np.array(self.gray(0.5, 0.85)) * [1, self.stage.uniform(0.93, 1), self.stage.uniform(0.82, 1)]
            return tuple(base)
        u = self.stage.uniform
        if self.stage.chance(0.3):  # warm: light that comes off it is redder
            return self.pale(colorsys.hsv_to_rgb(u(0.03, 0.12), u(0.35, 0.7), u(0.4, 0.85)))
        hue = u(0.02, 0.16) if self.stage.chance(0.6) else self.rng.random()
        return self.pale(colorsys.hsv_to_rgb(hue, u(0.08, 0.45), u(0.25, 0.8)))

    # -- nodes

    def empty(self, color, roughness=0.0):
        material = bpy.data.materials.new("paint")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        output, diffuse = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeBsdfDiffuse")
        diffuse.inputs["Color"].default_value = (*color, 1)
        tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
        return material, tree, diffuse

    def paint(self, color=None):
        return self.empty(self.toned(self.color()) if color is None else color)[0]

    def _coordinates(self, tree, scale, kind="Object"):
        place, mapping = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = scale if np.ndim(scale) else (scale,) * 3
        mapping.inputs["Location"].default_value = tuple(self.rng.uniform(-9, 9, 3))
        tree.links.new(place.outputs[kind], mapping.inputs[0])
        return mapping.outputs[0]

    def _clamp(self, tree, color, diffuse):
        """No reflectance below DARKEST or above BRIGHTEST."""
        for blend, limit in (("LIGHTEN", DARKEST), ("DARKEN", BRIGHTEST)):
            mix = tree.nodes.new("ShaderNodeMixRGB")
            mix.blend_type, mix.inputs[0].default_value = blend, 1
            mix.inputs[2].default_value = (limit,) * 3 + (1,)
            tree.links.new(color, mix.inputs[1])
            color = mix.outputs[0]
        tree.links.new(color, diffuse.inputs["Color"])

    def _bump(self, tree, height, diffuse, distance):
        bump = tree.nodes.new("ShaderNodeBump")
        bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = 0.7, distance
        tree.links.new(height, bump.inputs["Height"])
        tree.links.new(bump.outputs[0], diffuse.inputs["Normal"])

    def _noise(self, tree, vector, scale, detail=5):
        noise = tree.nodes.new("ShaderNodeTexNoise")
        noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = scale, detail
        tree.links.new(vector, noise.inputs["Vector"])
        return noise.outputs["Fac"]

    def _ramp(self, tree, value, colors, low=0.3, high=0.7, sharp=False):
        ramp = tree.nodes.new("ShaderNodeValToRGB")
        ramp.color_ramp.interpolation = "CONSTANT" if sharp else "LINEAR"
        elements = ramp.color_ramp.elements
        while len(elements) < len(colors):
            elements.new(0.5)
        for i, (element, color) in enumerate(zip(elements, colors)):
            element.position, element.color = low + (high - low) * i / max(len(colors) - 1, 1), (*color, 1)
        tree.links.new(value, ramp.inputs[0])
        return ramp.outputs[0]

    def image(self, picture, width=None, uv=True):
        """A drawn picture (PIL, sRGB) over the texture coordinates of the mesh, once. With a width in meters it repeats: over the texture
        coordinates, which then must be in units of this width, or (uv=False) from the sides of the thing."""
        import os
        import tempfile

        handle, path = tempfile.mkstemp(".png")
        os.close(handle)
        picture.convert("RGB").save(path, compress_level=1)
        image = bpy.data.images.load(path)
        image.pack()
        os.remove(path)
        material, tree, diffuse = self.empty((0.5,) * 3)
        texture, place = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeTexCoord")
        texture.image, texture.extension = image, "EXTEND" if width is None else "REPEAT"
        if uv:
            tree.links.new(place.outputs["UV"], texture.inputs[0])
        else:
            texture.projection, texture.projection_blend = "BOX", 0.05
            tree.links.new(self._coordinates(tree, 1 / width), texture.inputs[0])
        self._clamp(tree, texture.outputs[0], diffuse)
        return material

    def photo(self, kind, bump=True):
        """A photographed texture of this kind, or none."""
        if not self.photos.get(kind):
            return None
        path = self.stage.pick(self.photos[kind])
        self.stage.used.add(path.name)
        material, tree, diffuse = self.empty((0.5,) * 3)
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = bpy.data.images.load(str(path), check_existing=True)
        texture.projection, texture.projection_blend = "BOX", 0.1
        scale = 1 / (PHOTOS[kind][1] * self.stage.uniform(0.7, 1.4))
        tree.links.new(self._coordinates(tree, scale), texture.inputs[0])
        change = tree.nodes.new("ShaderNodeHueSaturation")
        change.inputs["Hue"].default_value = 0.5 + self.rng.normal(0, 0.01)
        change.inputs["Saturation"].default_value = self.stage.uniform(0.7, 1.3) * self.saturation
        dark = self.things == "dark" and kind in ("wood", "fabric") and self.stage.chance(0.7)
        change.inputs["Value"].default_value = self.stage.uniform(0.15, 0.4) if dark else self.stage.uniform(0.75, 1.4)
        tree.links.new(texture.outputs[0], change.inputs["Color"])
        self._clamp(tree, change.outputs[0], diffuse)
        if bump and self.stage.chance(0.6):
            self._bump(tree, texture.outputs[0], diffuse, self.stage.uniform(0.002, 0.02) / max(scale, 0.5))
        return material

    # -- procedural

    def mottled(self, color=None, strength=None, scale=None, bump=0.0):
        """Paint with slow stains or fine grain: plaster, concrete, paper, dirt."""
        color = np.array(self.toned(self.color()) if color is None else color)
        strength = self.stage.uniform(0.03, 0.35) if strength is None else strength
        material, tree, diffuse = self.empty(color)
        vector = self._coordinates(tree, 1)
        scale = self.stage.pick([2, 8, 40]) * self.stage.uniform(0.5, 1.5) if scale is None else scale
        noise = self._noise(tree, vector, scale, 8)
        low, high = np.clip(color * (1 - strength), DARKEST, BRIGHTEST), np.clip(color * (1 + strength), DARKEST, BRIGHTEST)
        self._clamp(tree, self._ramp(tree, noise, [low, high]), diffuse)
        if bump:
            self._bump(tree, self._noise(tree, vector, self.stage.uniform(60, 200)), diffuse, bump)
        return material

    def grain(self, color=None):
        """Wood: fibers along x, in bands that a noise bends."""
        if color is None:
            color = self.toned(colorsys.hsv_to_rgb(self.stage.uniform(0.04, 0.1), self.stage.uniform(0.4, 0.8), self.stage.uniform(0.05, 0.6)))
        color = np.array(color)
        material, tree, diffuse = self.empty(color)
        wave, mix = tree.nodes.new("ShaderNodeTexWave"), tree.nodes.new("ShaderNodeMixRGB")
        wave.bands_direction = self.stage.pick("YZ")
        for name, value in (("Scale", 1), ("Distortion", self.stage.uniform(6, 14)), ("Detail", 4), ("Detail Scale", self.stage.uniform(1, 3))):
            wave.inputs[name].default_value = value
        tree.links.new(self._coordinates(tree, (0.5, 5, 5)), wave.inputs["Vector"])
        fibers = self._noise(tree, self._coordinates(tree, (2, 80, 80)), 1.5, 3)
        tree.links.new(wave.outputs["Fac"], mix.inputs[1])
        tree.links.new(fibers, mix.inputs[2])
        mix.inputs[0].default_value = self.stage.uniform(0.4, 0.85)
        depth = self.stage.uniform(0.5, 0.85)
        self._clamp(tree, self._ramp(tree, mix.outputs[0], [color * depth, np.clip(color * 1.1, 0, 0.9)], 0.2, 0.8), diffuse)
        return material

    def cells(self, colors=None, scale=None):
        """Stones, terrazzo, gravel: cells of a few colors."""
        colors = [self.color() for _ in range(3)] if colors is None else colors
        material, tree, diffuse = self.empty(colors[0])
        voronoi, split = tree.nodes.new("ShaderNodeTexVoronoi"), tree.nodes.new("ShaderNodeSeparateColor")
        voronoi.inputs["Scale"].default_value = self.stage.uniform(4, 40) if scale is None else scale
        tree.links.new(self._coordinates(tree, 1), voronoi.inputs["Vector"])
        tree.links.new(voronoi.outputs["Color"], split.inputs[0])
        self._clamp(tree, self._ramp(tree, split.outputs[0], colors, 0.1, 0.8, self.stage.chance(0.5)), diffuse)
        return material

    def bricks(self, colors=None, mortar=None, width=None):
        """Bricks or tiles with joints, on the plane that the coordinates x + y and z span."""
        base = np.array(self.color() if colors is None else colors[0])
        other = np.clip(base * self.rng.uniform(0.7, 1.25, 3), DARKEST, BRIGHTEST) if colors is None else colors[1]
        material, tree, diffuse = self.empty(base)
        place, split = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeSeparateXYZ")
        add, join = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeCombineXYZ")
        brick = tree.nodes.new("ShaderNodeTexBrick")
        tree.links.new(place.outputs["Object"], split.inputs[0])
        tree.links.new(split.outputs["X"], add.inputs[0])
        tree.links.new(split.outputs["Y"], add.inputs[1])
        tree.links.new(add.outputs[0], join.inputs[0])
        tree.links.new(split.outputs["Z"], join.inputs[1])
        tree.links.new(join.outputs[0], brick.inputs["Vector"])
        width = self.stage.uniform(0.2, 0.35) if width is None else width
        for name, value in (
            ("Color1", (*base, 1)),
            ("Color2", (*other, 1)),
            ("Mortar", (*(self.gray(0.2, 0.6) if mortar is None else mortar), 1)),
            ("Scale", 1),
            ("Mortar Size", 0.008),
            ("Brick Width", width),
            ("Row Height", width * self.stage.pick([0.3, 0.5])),
        ):
            brick.inputs[name].default_value = value
        self._clamp(tree, brick.outputs["Color"], diffuse)
        return material

    def two_tones(self):
        """Colors of a checkered floor."""
        kind = self.stage.pick(["black", "near", "any"], [4, 2, 2])
        if kind == "black":
            return self.gray(0.022, 0.08), self.gray(0.5, 0.85)
        a = np.array(self.color())
        return tuple(a), self.color() if kind == "any" else tuple(np.clip(a * self.stage.uniform(0.4, 0.8), DARKEST, BRIGHTEST))

    def checker(self, colors, size):
        material, tree, diffuse = self.empty(colors[0])
        checker = tree.nodes.new("ShaderNodeTexChecker")
        checker.inputs["Scale"].default_value = 1 / size
        checker.inputs["Color1"].default_value, checker.inputs["Color2"].default_value = ((*c, 1) for c in colors)
        tree.links.new(self._coordinates(tree, 1), checker.inputs["Vector"])
        self._clamp(tree, checker.outputs["Color"], diffuse)
        return material

    def pattern(self, colors=None, size=None):
        """Stripes or checkers."""
        a, b = (self.color(), self.color()) if colors is None else colors
        size = math.exp(self.stage.uniform(math.log(0.008), math.log(0.15))) if size is None else size
        if self.stage.chance(0.5):
            return self.checker((a, b), size)
        material, tree, diffuse = self.empty(a)
        wave = tree.nodes.new("ShaderNodeTexWave")
        wave.bands_direction = self.stage.pick("XYZ")
        wave.inputs["Scale"].default_value = 0.3 / size
        tree.links.new(self._coordinates(tree, 1), wave.inputs["Vector"])
        output = self._ramp(tree, wave.outputs["Fac"], [a, b], 0.4, self.stage.pick([0.45, 0.8]))
        self._clamp(tree, output, diffuse)
        return material

    # -- by use

    def wood(self):
        return (self.photo(self.stage.pick(["wood", "planks"])) if self.stage.chance(0.5) else None) or self.grain()

    def fabric(self):
        s = self.stage
        kind = s.pick(["plain", "mottled", "pattern", "weave", "photo", "textile"], [4, 3, 1, 2, 2, 2])
        if kind == "textile":
            return self.image(self.pictures.textile(), s.uniform(0.06, 0.4), uv=False)
        if kind == "photo":
            return self.photo("fabric") or self.paint()
        if kind == "plain":
            return self.paint()
        if kind == "weave":
            color = np.array(self.toned(self.color()))
            return self.pattern((tuple(color), tuple(np.clip(color * s.uniform(0.6, 0.85), DARKEST, 1))), s.uniform(0.003, 0.008))
        return self.pattern() if kind == "pattern" else self.mottled(strength=s.uniform(0.05, 0.2), scale=s.uniform(60, 200), bump=0.001)

    def wall(self):
        s = self.stage
        kind = s.pick(["paint", "plaster", "photo", "brick", "paper", "wood"], [5, 4, 3, 1.5, 1.5, 1])
        if kind == "wood":
            return self.wood()
        if kind == "photo":
            return self.photo(s.pick(["wall", "concrete", "brick", "planks", "wall", "paper"])) or self.mottled(self.wall_color(), 0.1)
        if kind == "brick":
            return self.photo("brick") or self.bricks()
        if kind == "paper":
            color = np.array(self.wall_color())
            return self.pattern((tuple(color), tuple(np.clip(color * self.rng.uniform(0.6, 1.2), DARKEST, BRIGHTEST))), s.uniform(0.03, 0.15))
        return (
            self.paint(self.wall_color())
            if kind == "paint"
            else self.mottled(self.wall_color(), s.uniform(0.02, 0.12), bump=s.uniform(0.0005, 0.003))
        )

    def floor(self):
        s = self.stage
        kind = s.pick(["wood", "planks", "tiles", "concrete", "carpet", "checker"], [4, 3, 3, 2, 3, 1])
        if kind == "carpet":
            photo = self.photo("carpet") if s.chance(0.5) else None
            return photo or self.mottled(strength=s.uniform(0.05, 0.3), scale=s.uniform(80, 250), bump=0.004)
        if kind == "checker":
            return self.checker(self.two_tones(), s.uniform(0.2, 0.5))
        return (self.photo(kind) if s.chance(0.75) else None) or (self.grain() if kind in ("wood", "planks") else self.cells())

    def any(self):
        s = self.stage
        kind = s.pick(["paint", "mottled", "pattern", "wood", "cells", "photo"], [10, 3, 2, 2, 1, 2])
        if kind == "photo":
            return self.photo(s.pick(list(PHOTOS))) or self.mottled()
        return getattr(self, kind)()
