# SPDX-License-Identifier: LGPL-2.1-or-later
"""Things: each function builds one at the origin, standing on z = 0, and returns its objects. Sizes in meters."""
import math

import bpy
import numpy as np
from mathutils import Matrix, Vector

from . import models


class Things:
    def __init__(self, stage, materials, prints):
        self.stage, self.rng, self.m, self.p = stage, stage.rng, materials, prints

    def model(self, kind):
        """A mesh of the assets, or nothing."""
        return models.load(self.stage, self.m, kind)

    # -- small things

    def book(self, lying=True):
        s = self.stage
        w, h, d = s.uniform(0.11, 0.2), s.uniform(0.17, 0.28), s.uniform(0.012, 0.05)
        cover = self.m.image(self.p.cover()) if s.chance(0.6) else self.m.paint()
        items = [
            s.box((w - 0.006, h - 0.008, d - 0.004), self.m.paint(self.m.gray(0.55, 0.8)), (0, 0, d / 2)),
            s.card(w, h, cover, (0, 0, d)),
            s.card(w, h, self.m.paint(), (0, 0, 0.0005)),
            s.quad([(-w / 2, h / 2, 0), (-w / 2, -h / 2, 0), (-w / 2, -h / 2, d), (-w / 2, h / 2, d)], self.m.image(self.p.spine())),
        ]
        return items if lying else s.place(items, (0, 0, w / 2), tilt=(0, math.pi / 2))

    def row_of_books(self, length, height=0.3):
        """Standing books with their backs to -y, up to a length along x from 0."""
        s, items, x = self.stage, [], 0.0
        while True:
            d = s.uniform(0.015, 0.06)
            if x + d > length:
                return items
            h, w = s.uniform(0.55, 0.95) * height, s.uniform(0.12, 0.2)
            back = self.m.image(self.p.spine()) if s.chance(0.6) else self.m.paint()
            items.append(s.box((d - 0.002, w, h), self.m.paint(), (x + d / 2, w / 2 + 0.005, h / 2)))
            items.append(
                s.mesh(
                    [(x, 0, h), (x, 0, 0), (x + d - 0.002, 0, 0), (x + d - 0.002, 0, h)], [(0, 1, 2, 3)], back, uv=[(1, 1), (0, 1), (0, 0), (1, 0)]
                )
            )
            x += d
            if s.chance(0.06):
                x += s.uniform(0.03, 0.2)

    def mug(self):
        s, r, h = self.stage, self.stage.uniform(0.035, 0.05), self.stage.uniform(0.07, 0.11)
        paint = self.m.pattern() if s.chance(0.25) else self.m.paint()
        items = [s.lathe([(r * 0.85, 0), (r, 0.01), (r, h), (r * 0.9, h), (r * 0.88, 0.012)], paint)]
        a = np.linspace(-1.2, 1.2, 9)
        items.append(s.tube([(r * 0.9 + 0.03 * math.cos(t), 0, h * 0.5 + 0.032 * math.sin(t)) for t in a], 0.006, paint))
        if s.chance(0.5):
            items.append(s.cylinder(r * 0.88, 0.002, self.m.paint((0.05, 0.025, 0.02)), (0, 0, h * 0.8)))
        return items

    def bottle(self):
        s, r, h = self.stage, self.stage.uniform(0.025, 0.05), self.stage.uniform(0.15, 0.32)
        items = [s.lathe([(r * 0.95, 0), (r, 0.01), (r, h * 0.6), (r * 0.35, h * 0.78), (r * 0.35, h)], self.m.paint())]
        items.append(s.cylinder(r * 0.4, 0.025, self.m.paint(), (0, 0, h - 0.01)))
        if s.chance(0.7):
            items.append(self.wrap(r * 1.01, h * 0.15, h * 0.5, self.m.image(self.p.label())))
        return items

    def wrap(self, radius, low, high, material, sides=40):
        """A label around a cylinder."""
        a = np.linspace(0, 2 * math.pi, sides + 1)
        ring = np.stack([radius * np.cos(a), radius * np.sin(a)], 1)
        vertices = [(x, y, z) for z in (low, high) for x, y in ring]
        n = sides + 1
        faces = [(i, i + 1, n + i + 1, n + i) for i in range(sides)]
        uv = [c for i in range(sides) for c in ((2 * i / sides, 0), (2 * (i + 1) / sides, 0), (2 * (i + 1) / sides, 1), (2 * i / sides, 1))]
        return self.stage.mesh(vertices, faces, material, True, uv)

    def can(self):
        s, r, h = self.stage, self.stage.uniform(0.03, 0.09), self.stage.uniform(0.08, 0.2)
        items = [s.cylinder(r, h, self.m.paint(self.m.gray(0.2, 0.6)))]
        items.append(self.wrap(r * 1.005, h * 0.06, h * 0.94, self.m.image(self.p.label()) if s.chance(0.7) else self.m.paint()))
        return items

    def bowl(self):
        s, r = self.stage, self.stage.uniform(0.06, 0.15)
        paint = self.m.paint()
        items = [
            s.lathe(
                [(r * 0.4, 0), (r * 0.45, 0.005), (r * 0.85, r * 0.35), (r, r * 0.6), (r * 0.96, r * 0.6), (r * 0.8, r * 0.36), (r * 0.3, 0.02)],
                paint,
            )
        ]
        for _ in range(int(self.rng.integers(0, 5))):
            f = r * s.uniform(0.25, 0.35)
            items.append(s.ball(f, self.m.paint(), (s.uniform(-0.4, 0.4) * r, s.uniform(-0.4, 0.4) * r, 0.03 + f)))
        return items

    def carton(self, size=None):
        s = self.stage
        x, y, z = (s.uniform(0.08, 0.4) for _ in range(3)) if size is None else size
        paint = self.m.paint(tuple(np.array([0.42, 0.27, 0.15]) * s.uniform(0.6, 1.3))) if s.chance(0.6) else self.m.any()
        items = [s.box((x, y, z), paint, (0, 0, z / 2), soft=0.003)]
        if s.chance(0.7):
            w = min(x, z) * s.uniform(0.4, 0.85)
            items.append(s.card(w, w * 0.7, self.m.image(self.p.label()), (0, -y / 2 - 0.001, z * 0.5), upright=True))
        if s.chance(0.5):
            items.append(s.card(0.05, y, self.m.paint((0.5, 0.4, 0.25)), (0, 0, z + 0.001)))
        return items

    def cube(self):
        s, a = self.stage, self.stage.uniform(0.03, 0.12)
        return [s.box((a, a * s.uniform(0.6, 1.6), a * s.uniform(0.5, 1.5)), self.m.any(), (0, 0, a / 2), soft=0.003)]

    def ball(self):
        r = self.stage.uniform(0.03, 0.11)
        return [self.stage.ball(r, self.m.any(), (0, 0, r))]

    def pen(self):
        s, r = self.stage, 0.0045
        length = s.uniform(0.12, 0.17)
        item = s.lathe([(0.001, 0), (r, 0.015), (r, length)], self.m.paint())
        s.place([item], (-length / 2, 0, r), tilt=(0, math.pi / 2))
        return [item]

    def pot(self):
        """A plant in a pot."""
        s, r = self.stage, self.stage.uniform(0.06, 0.18)
        items = [s.lathe([(r * 0.7, 0), (r, r * 1.5), (r * 0.92, r * 1.5), (r * 0.9, r * 1.3)], self.m.mottled(strength=0.1))]
        items.append(s.cylinder(r * 0.9, 0.01, self.m.mottled((0.06, 0.04, 0.03)), (0, 0, r * 1.3)))
        leaf = self.m.mottled((s.uniform(0.03, 0.15), s.uniform(0.12, 0.35), s.uniform(0.02, 0.08)))
        items.append(
            self.leaves(leaf, r * s.uniform(1.5, 3), (0, 0, r * s.uniform(2.5, 4)), int(self.rng.integers(60, 250)), r * s.uniform(0.3, 0.9))
        )
        return items

    def leaves(self, material, radius, center, count, size, squash=0.8):
        """Leaves in a ball: one mesh of bent quads."""
        rng = self.rng
        direction = rng.normal(size=(count, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        at = np.array(center) + direction * radius * rng.uniform(0.35, 1, (count, 1)) ** 0.6 * [1, 1, squash]
        along = rng.normal(size=(count, 3)) + direction
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        across = np.cross(along, rng.normal(size=(count, 3)))
        across /= np.linalg.norm(across, axis=1, keepdims=True) + 1e-9
        length = size * rng.uniform(0.6, 1.3, (count, 1))
        width = length * rng.uniform(0.25, 0.5, (count, 1))
        quads = np.stack(
            [at, at + along * length * 0.5 + across * width * 0.5, at + along * length, at + along * length * 0.5 - across * width * 0.5], 1
        )
        return self.stage.mesh(quads.reshape(-1, 3), np.arange(4 * count).reshape(-1, 4), material)

    def papers(self, count=None):
        """Sheets on each other, turned at random."""
        s, items = self.stage, []
        for i in range(int(self.rng.integers(1, 4)) if count is None else count):
            sheet = s.card(0.21, 0.297, self.m.image(self.p.flat()))
            items += s.place([sheet], (s.uniform(-0.03, 0.03), s.uniform(-0.03, 0.03), 0.0004 + 0.0004 * i), s.uniform(-0.3, 0.3))
        return items

    def keyboard(self):
        s, image = self.stage, self.m.image(self.p.keys())
        return [
            s.box((0.43, 0.15, 0.018), self.m.paint(self.m.gray(0.02, 0.6)), (0, 0, 0.009), soft=0.004),
            s.card(0.42, 0.14, image, (0, 0, 0.0185)),
        ]

    def mouse(self):
        return [self.stage.ball(0.03, self.m.paint(self.m.gray(0.02, 0.7)), (0, 0, 0.012), (1, 1.7, 0.5))]

    def monitor(self):
        s, w = self.stage, self.stage.uniform(0.4, 0.6)
        h, dark = w * 0.58, self.m.paint(self.m.gray(0.02, 0.1))
        items = [
            s.box((w, 0.03, h), dark, (0, 0, 0.12 + h / 2), soft=0.006),
            s.box((0.05, 0.04, 0.15), dark, (0, 0.02, 0.08)),
            s.box((0.22, 0.16, 0.012), dark, (0, 0.02, 0.006), soft=0.004),
        ]
        items.append(
            s.card(
                w - 0.03,
                h - 0.03,
                self.m.image(self.p.flat()) if s.chance(0.4) else self.m.paint((0.025,) * 3),
                (0, -0.0165, 0.12 + h / 2),
                upright=True,
            )
        )
        return items

    def tag(self):
        """Something printed that stands: a small sign, a picture, a card."""
        s, w = self.stage, self.stage.uniform(0.06, 0.2)
        h = w * s.uniform(0.6, 1.4)
        image = self.m.image(self.p.flat() if s.chance(0.5) else self.p.label())
        items = [
            s.box((w * 1.08, 0.008, h * 1.08), self.m.paint(), (0, 0.005, h * 0.54), soft=0.002),
            s.card(w, h, image, (0, -0.0005, h * 0.54), upright=True),
        ]
        return s.place(items, tilt=(-s.uniform(0, 0.3), 0))

    def tea(self):
        return self.model("tea") or self.mug()

    def small(self):
        """A thing for a table or a shelf."""
        kind = self.stage.pick(
            ["book", "mug", "bottle", "can", "bowl", "carton", "cube", "ball", "pot", "tag", "stack"], [3, 3, 2, 2, 1.5, 2, 2, 1, 1.5, 2, 1.5]
        )
        if kind == "stack":
            items, z = [], 0.0
            for _ in range(int(self.rng.integers(2, 6))):
                book = self.stage.place(self.book(), (0, 0, z), self.stage.uniform(-0.4, 0.4))
                z = max(v.co.z + z for o in book[:1] for v in o.data.vertices) + 0.02
                items += book
                z += 0.004
            return items
        return getattr(self, kind)()

    # -- furniture

    def table(self, width, depth, height, top=None, leg=None):
        s = self.stage
        top = self.m.wood() if top is None else top
        leg = (self.m.wood() if s.chance(0.5) else self.m.paint()) if leg is None else leg
        items = [s.box((width, depth, 0.03), top, (0, 0, height - 0.015), soft=0.004)]
        for x in (-1, 1):
            for y in (-1, 1):
                items.append(s.box((0.05, 0.05, height - 0.03), leg, (x * (width / 2 - 0.05), y * (depth / 2 - 0.05), (height - 0.03) / 2)))
        return items

    def chair(self):
        items = self.model("seat") if self.stage.chance(0.75) else []
        if items:
            return items
        s, a, b = self.stage, self.m.wood(), self.m.fabric()
        items = self.table(0.42, 0.42, 0.45, b, a)
        items.append(s.box((0.42, 0.03, 0.3), b, (0, 0.2, 0.8), soft=0.01))
        return items + [s.box((0.035, 0.03, 0.5), a, (x, 0.2, 0.65)) for x in (-0.19, 0.19)]

    def sofa(self):
        items = self.model("sofa") if self.stage.chance(0.65) else []
        if items:
            return items
        s, f = self.stage, self.m.fabric()
        w = s.uniform(1.0, 2.1)
        items = [s.box((w, 0.85, 0.25), f, (0, 0, 0.2), soft=0.04), s.box((w, 0.22, 0.75), f, (0, 0.35, 0.45), soft=0.06)]
        items += [s.box((0.18, 0.85, 0.55), f, (x * (w / 2 - 0.05), 0, 0.3), soft=0.06) for x in (-1, 1)]
        n = max(1, round(w / 0.7))
        items += [s.box(((w - 0.3) / n - 0.01, 0.6, 0.16), f, ((i + 0.5 - n / 2) * (w - 0.3) / n, -0.08, 0.4), soft=0.05) for i in range(n)]
        for _ in range(int(self.rng.integers(0, 4))):
            items += self.pillow((s.uniform(-0.4, 0.4) * w, 0.12, 0.62))
        return items

    def pillow(self, at):
        s = self.stage
        item = s.ball(0.22, self.m.fabric(), scale=(1, 0.35, 0.9))
        return s.place([item], at, s.uniform(-0.5, 0.5), (s.uniform(0.1, 0.5), 0))

    def shelf(self, width, height, depth=0.3, boards=None, full=0.9):
        """Boards between sides, filled with books and things; its front to -y, its back at depth / 2."""
        s = self.stage
        wood = self.m.wood() if s.chance(0.6) else self.m.paint()
        boards = max(2, round(height / s.uniform(0.28, 0.42))) if boards is None else boards
        items = [s.box((0.025, depth, height), wood, (x * width / 2, 0, height / 2)) for x in (-1, 1)]
        if s.chance(0.6):
            items.append(s.box((width, 0.01, height), wood if s.chance(0.7) else self.m.paint(), (0, depth / 2, height / 2)))
        step = height / boards
        for i in range(boards + 1):
            z = i * step
            items.append(s.box((width, depth, 0.022), wood, (0, 0, z)))
            if i == boards or not s.chance(full):
                continue
            if s.chance(0.55):
                items += s.place(
                    self.row_of_books(s.uniform(0.4, 0.95) * width, step - 0.03), (-width / 2 + 0.02, -depth / 2 + s.uniform(0.01, 0.06), z + 0.011)
                )
            else:
                items += self.fill(width, depth, step, z + 0.011)
        return items

    def fill(self, width, depth, step, z):
        """Things beside each other on a board."""
        s, items, x = self.stage, [], -width / 2 + 0.05
        while x < width / 2 - 0.08:
            new = self.small()
            low, high = self.extent(new)
            size = high - low
            scale = min(1.0, (step - 0.03) / max(size[2], 1e-3), (depth - 0.02) / max(size[1], 1e-3))
            if x + size[0] * scale > width / 2 - 0.02:
                self.remove(new)
                return items
            for o in new:
                o.matrix_basis = (
                    Matrix.Translation((x - low[0] * scale, -low[1] * scale - size[1] * scale / 2, z - low[2] * scale))
                    @ Matrix.Scale(scale, 4)
                    @ o.matrix_basis
                )
            items += new
            x += size[0] * scale + s.uniform(0.005, 0.1)
        return items

    @staticmethod
    def extent(items):
        points = np.array([o.matrix_basis @ v.co for o in items for v in o.data.vertices])
        return points.min(0), points.max(0)

    @staticmethod
    def remove(items):
        for o in items:
            bpy.data.objects.remove(o)

    def floor_lamp(self, group, power=60):
        s, h = self.stage, self.stage.uniform(1.3, 1.75)
        metal, shade = self.m.paint(self.m.gray(0.02, 0.5)), self.m.paint(self.m.gray(0.4, 0.85) if s.chance(0.6) else None)
        r = s.uniform(0.14, 0.25)
        items = [
            s.cylinder(0.14, 0.02, metal),
            s.cylinder(0.012, h, metal),
            s.lathe([(r, h - 0.15), (r * s.uniform(0.5, 1), h + 0.15)], shade, closed=False),
        ]
        lamp = s.bulb((0, 0, h), 0.04, power, group)
        return items + [lamp]

    def desk_lamp(self, group, power=15, reach=0.35):
        """Shines down on what is in front of it (-y)."""
        s, h = self.stage, self.stage.uniform(0.35, 0.55)
        metal = self.m.paint()
        items = [
            s.cylinder(0.08, 0.02, metal),
            s.tube([(0, 0, 0), (0, 0.06, h * 0.6), (0, -0.05, h), (0, -reach, h * 1.02)], 0.008, metal),
            s.place([s.lathe([(0.07, -0.06), (0.035, 0.04), (0.03, 0.05)], metal, closed=False)], (0, -reach, h), tilt=(-0.25, 0))[0],
        ]
        items.append(s.spot((0, -reach, h - 0.0), (0, -reach - 0.12, 0), s.uniform(0.012, 0.05), power, s.uniform(110, 160), group))
        return items

    def picture(self, width=None):
        """A framed picture, its front to -y, its center at the origin."""
        s = self.stage
        w = s.uniform(0.25, 0.9) if width is None else width
        h = w * s.uniform(0.65, 1.4)
        border = s.uniform(0.01, 0.05)
        items = [s.box((w + 2 * border, 0.025, h + 2 * border), self.m.paint(), (0, 0.013, 0))]
        if s.chance(0.5):
            items.append(s.card(w, h, self.m.paint(self.m.gray(0.6, 0.85)), (0, -0.001, 0), upright=True))
            w, h = w * 0.75, h * 0.75
        return items + [s.card(w, h, self.m.image(self.p.poster()), (0, -0.002, 0), upright=True)]

    def curtain(self, width, height, material=None):
        """Hangs in folds from z = height, at y = 0."""
        a, b, c = self.stage.uniform(8, 20), self.stage.uniform(0, 6), self.stage.uniform(0.02, 0.06)
        item = self.stage.cloth(
            width,
            height,
            self.m.fabric() if material is None else material,
            lambda x, y: c * np.sin(a * x / 0.6 + b + 0.8 * np.sin(2 * y)) + 0.4 * c * np.sin(2.7 * a * x),
            64,
        )
        return self.stage.place([item], (0, 0, height / 2), tilt=(math.pi / 2, 0))

    # -- outdoors

    def tree(self, height=None, leaf=None):
        s = self.stage
        h = s.uniform(3, 7) if height is None else height
        bark = self.m.mottled(tuple(np.array([0.12, 0.09, 0.06]) * s.uniform(0.5, 2)), 0.4, 8)
        lean = self.rng.normal(0, 0.1, 2)
        top = Vector((lean[0] * h, lean[1] * h, h * 0.6))
        items = [s.tube([(0, 0, 0), top * 0.5, top], h * s.uniform(0.015, 0.03), bark)]
        green = (
            self.m.mottled((s.uniform(0.03, 0.14), s.uniform(0.1, 0.28), s.uniform(0.015, 0.05)), 0.4, 1)
            if s.chance(0.85)
            else self.m.mottled((0.3, 0.12, 0.03), 0.4)
        )
        spread = h * s.uniform(0.2, 0.32)
        for _ in range(int(self.rng.integers(3, 7))):
            end = top + Vector(self.rng.normal(0, spread * 0.7, 3)) * 1.0
            end.z = top.z + abs(s.uniform(-0.2, 1.1)) * spread
            items.append(s.tube([top * s.uniform(0.7, 1), (top + end) / 2, end], h * 0.007, bark, 6))
            items.append(
                self.leaves(
                    green, spread * s.uniform(0.6, 1), tuple(end), int(self.rng.integers(150, 600)), s.uniform(0.1, 0.28) if leaf is None else leaf
                )
            )
        return items

    def bush(self, radius=None):
        s = self.stage
        r = s.uniform(0.3, 0.9) if radius is None else radius
        green = self.m.mottled((s.uniform(0.03, 0.12), s.uniform(0.08, 0.3), s.uniform(0.015, 0.06)), 0.4, 2)
        return [self.leaves(green, r, (0, 0, r * 0.6), int(900 * r + 300), s.uniform(0.05, 0.12))]

    def car(self):
        items = self.model("car") if self.stage.chance(0.8) else []
        if items:
            return items
        s = self.stage
        paint, dark = self.m.paint(), self.m.paint((0.03,) * 3)
        side = np.array([(-2.1, 0.35), (2.1, 0.35), (2.15, 0.75), (1.2, 0.9), (0.6, 1.4), (-1.2, 1.4), (-1.9, 0.95), (-2.15, 0.8)])
        n = len(side)
        vertices = [(x, y, z) for y in (-0.85, 0.85) for x, z in side]
        faces = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)] + [tuple(reversed(range(n))), tuple(range(n, 2 * n))]
        items = [s.soften(s.mesh(vertices, faces, paint), 0.08, 3)]
        for x in (-1.3, 1.3):
            for y in (-0.8, 0.8):
                items += s.place([s.cylinder(0.32, 0.2, dark)], (x, y + 0.1, 0.32), tilt=(math.pi / 2, 0))
        items += [s.box((1.5, 1.74, 0.34), dark, (-0.3, 0, 1.13))]
        return s.place(items, turn=math.pi / 2)

    def sign(self):
        s, h = self.stage, self.stage.uniform(1.9, 2.8)
        items = [s.cylinder(0.03, h, self.m.paint(self.m.gray(0.15, 0.5)))]
        w = s.uniform(0.35, 0.9)
        items += [
            s.box((w, 0.02, w * 0.63), self.m.paint(self.m.gray(0.2, 0.6)), (0, -0.04, h - w * 0.3)),
            s.card(w, w * 0.63, self.m.image(self.p.sign()), (0, -0.052, h - w * 0.3), upright=True),
        ]
        return items

    def bench(self):
        s, wood, leg = self.stage, self.m.wood(), self.m.paint(self.m.gray(0.02, 0.3))
        items = [s.box((1.5, 0.09, 0.035), wood, (0, -0.2 + 0.11 * i, 0.45)) for i in range(4)]
        items += [s.box((1.5, 0.03, 0.09), wood, (0, 0.23, 0.6 + 0.13 * i)) for i in range(3)]
        return items + [s.box((0.06, 0.45, 0.9), leg, (x, 0.05, 0.45)) for x in (-0.6, 0.6)]

    def fence(self, length, height=None, gap=None):
        """Boards along x."""
        s = self.stage
        h, w = s.uniform(0.9, 2.0) if height is None else height, s.uniform(0.06, 0.15)
        gap = s.pick([0.004, 0.03, 0.08]) if gap is None else gap
        wood = self.m.wood() if s.chance(0.6) else self.m.paint()
        vertices, faces = [], []
        for i in range(int(length / (w + gap))):
            x0 = -length / 2 + i * (w + gap)
            base = len(vertices)
            top = h * s.uniform(0.98, 1.02)
            vertices += [(x, y, z) for z in (0.03, top) for y in (-0.01, 0.01) for x in (x0, x0 + w)]
            faces += [tuple(base + k for k in f) for f in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))]
        items = [s.mesh(vertices, faces, wood)]
        return items + [s.box((length, 0.04, 0.07), wood, (0, 0.03, z * h)) for z in (0.2, 0.8)]

    def person(self):
        """A person, at least as a shadow."""
        items = self.model("person")
        if items:
            return items
        s = self.stage
        skin, shirt, pants = self.m.paint((0.4, 0.24, 0.16)), self.m.fabric(), self.m.fabric()
        items = [s.ball(0.11, skin, (0, 0, 1.62), (0.9, 1, 1.2)), s.ball(0.25, shirt, (0, 0, 1.18), (0.95, 0.55, 1.35))]
        items += [s.tube([(x, 0, 0.95), (x * 1.2, 0.02, 0.5), (x * 1.3, 0, 0)], 0.075, pants) for x in (-0.09, 0.09)]
        return items + [s.tube([(x * 0.24, 0, 1.4), (x * 0.34, 0.03, 1.12), (x * 0.3, -0.12, 0.9)], 0.045, shirt) for x in (-1, 1)]

    def hand(self):
        """A hand flat over z = 0 that points to +y, at the end of an arm."""
        s = self.stage
        skin = self.m.paint(tuple(np.array([0.5, 0.28, 0.19]) * s.uniform(0.3, 1.2)))
        items = [
            s.ball(0.045, skin, (0, 0, 0), (1, 1.1, 0.35)),
            s.tube([(0, -0.04, 0), (0, -0.2, 0.02), (0, -0.5, 0.08)], 0.03, self.m.fabric() if s.chance(0.7) else skin),
        ]
        for i, x in enumerate((-0.036, -0.012, 0.012, 0.036)):
            l = (0.06, 0.075, 0.07, 0.055)[i]
            items.append(
                s.tube([(x, 0.03, 0), (x * 1.2, 0.03 + l * 0.6, s.uniform(-0.005, 0.01)), (x * 1.25, 0.04 + l, s.uniform(-0.02, 0.0))], 0.009, skin)
            )
        return items + [s.tube([(0.04, 0, 0), (0.065, 0.03, 0), (0.07, 0.055, -0.005)], 0.01, skin)]

    def blinds(self, width, height, slats=None):
        """Slats across a window, at y = 0, from z = 0."""
        s, paint = self.stage, self.m.paint(self.m.gray(0.4, 0.85))
        n = int(height / s.uniform(0.04, 0.12)) if slats is None else slats
        turn = s.uniform(-0.9, 0.9)
        return [item for i in range(n) for item in s.place([s.box((width, 0.045, 0.003), paint)], (0, 0, (i + 0.5) * height / n), tilt=(turn, 0))]
