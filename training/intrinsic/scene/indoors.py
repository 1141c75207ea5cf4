# SPDX-License-Identifier: LGPL-2.1-or-later
"""Rooms, desks and shelves. Each function builds a scene and returns a function that draws a camera: eye, target, focal length in mm."""
import math

import numpy as np


class Shell:
    """A closed room, x and y around 0, with windows in its walls: each a light group."""

    def __init__(self, stage, materials, things, size, windows, one_wall=None):  # windows: their number by wall
        s, self.size = stage, size
        w, d, h = size
        self.windows = []
        floor, ceiling = materials.floor(), materials.wood() if s.chance(0.12) else materials.paint(materials.gray(0.55, 0.88))
        s.quad([(-w / 2, -d / 2, 0), (w / 2, -d / 2, 0), (w / 2, d / 2, 0), (-w / 2, d / 2, 0)], floor)
        s.quad([(-w / 2, d / 2, h), (w / 2, d / 2, h), (w / 2, -d / 2, h), (-w / 2, -d / 2, h)], ceiling)
        paint, skirting = materials.wall() if one_wall is None else one_wall, materials.paint(materials.gray(0.3, 0.85))
        # a wall's frame: x along it, -y into the room
        walls = [((0, d / 2, 0), 0.0, w), ((w / 2, 0, 0), -math.pi / 2, d), ((0, -d / 2, 0), math.pi, w), ((-w / 2, 0, 0), math.pi / 2, d)]
        for i, (at, turn, length) in enumerate(walls):
            material = paint if s.chance(0.7) else materials.wall()
            n = windows.get(i, 0)
            holes = []
            if n:
                step = length / n
                ww, wh, z = min(s.uniform(0.7, 2.2), step * 0.6), s.uniform(0.28, 0.5) * h, s.uniform(0.3, 0.36) * h
                shift = s.uniform(-0.5, 0.5) * (step - ww - 0.4)
                holes = [
                    ((j + 0.5) * step - length / 2 + shift + np.array((-ww / 2, ww / 2))).tolist() + [z, min(z + wh, h - 0.15)] for j in range(n)
                ]
            items = self.wall(s, material, length, h, holes)
            if skirting and s.chance(0.8):
                items.append(s.box((length, 0.015, s.uniform(0.06, 0.14)), skirting, (0, -0.008, 0.05)))
            s.place(items, at, turn)
            if holes:
                group, frame = s.group("window"), materials.paint(materials.gray(0.3, 0.85)) if s.chance(0.8) else materials.wood()
                for hole in holes:
                    self.window(s, materials, things, at, turn, hole, group, frame)
        self.walls = walls

    @staticmethod
    def wall(s, material, length, height, holes):
        parts, x = [], -length / 2
        for x0, x1, z0, z1 in holes:
            parts += [(x, x0, 0, height), (x0, x1, 0, z0), (x0, x1, z1, height)]
            x = x1
        parts.append((x, length / 2, 0, height))
        return [s.mesh([(x0, 0, z0), (x1, 0, z0), (x1, 0, z1), (x0, 0, z1)], [(0, 1, 2, 3)], material) for x0, x1, z0, z1 in parts]

    def window(self, s, materials, things, at, turn, hole, group, frame):
        x0, x1, z0, z1 = hole
        x, z, w, h = (x0 + x1) / 2, (z0 + z1) / 2, x1 - x0, z1 - z0
        items = [s.box((w + 0.1, 0.2, 0.04), frame, (x, 0.05, z0 - 0.02)), s.box((w + 0.1, 0.2, 0.04), frame, (x, 0.1, z1 + 0.02))]
        items += [s.box((0.05, 0.2, h), frame, (q, 0.1, z)) for q in (x0, x1)]
        for i in range(int(s.rng.integers(0, 4))):
            items.append(s.box((0.035, 0.04, h), frame, (x0 + w * (i + 1) / 4, 0.1, z)))
        if s.chance(0.5):
            items.append(s.box((w, 0.04, 0.035), frame, (x, 0.1, z0 + h * s.uniform(0.3, 0.7))))
        if s.chance(0.25):
            items += s.place(things.blinds(w, h), (x, 0.03, z0))
        if s.chance(0.4):
            material = materials.fabric()
            for side in (-1, 1):
                items += s.place(things.curtain(s.uniform(0.3, 0.7), z1 + 0.1, material), (x + side * (w / 2 + 0.1), -0.1, 0))
        items.append(s.glow([(x0 - 1, 0.6, z0 - 1), (x1 + 1, 0.6, z0 - 1), (x1 + 1, 0.6, z1 + 1), (x0 - 1, 0.6, z1 + 1)], s.uniform(2, 10), group))
        s.place(items, at, turn)
        light = s.area((x, 0.24, z), (x, -1, z - 0.15), (w, h), 60 * w * h, group)
        s.place([light], at, turn)
        inward = (math.sin(turn), -math.cos(turn))
        center = (at[0] + x * math.cos(turn), at[1] + x * math.sin(turn), z)
        self.windows.append({"center": center, "inward": inward, "group": group, "turn": turn})


def sun_through(s, shell):
    """Sun through the first window, onto the floor or the wall across."""
    window = shell.windows[0]
    azimuth = math.degrees(math.atan2(-window["inward"][1], -window["inward"][0])) + s.uniform(-50, 50)
    s.sun(s.uniform(18, 50), azimuth, s.uniform(2, 5), s.group("sun"))


def ceiling_light(s, m, shell):
    w, d, h = shell.size
    x, y = s.uniform(-0.2, 0.2) * w, s.uniform(-0.2, 0.2) * d
    group = s.group("lamp")
    if s.chance(0.5):
        s.area((x, y, h - 0.03), (x, y, 0), (s.uniform(0.2, 1.2), s.uniform(0.2, 0.6)), 60, group)
    else:
        drop = s.uniform(0.3, 0.9)
        s.tube([(x, y, h), (x, y, h - drop)], 0.006, m.paint((0.03,) * 3))
        s.lathe([(0.18, h - drop - 0.12), (0.06, h - drop + 0.05)], m.paint(), (x, y, 0), closed=False)
        s.bulb((x, y, h - drop - 0.04), 0.05, 60, group)


def on_wall(s, shell, i, items, along, height):
    """Puts things whose backs are at y = 0 and fronts at -y to the inside of a wall."""
    at, turn, _ = shell.walls[i]
    s.place(items, (along, -0.004, height))
    return s.place(items, at, turn)


def furnish(s, m, t, shell, table=True):
    """Furniture along the walls and something in the middle; returns places to look at."""
    w, d, h = shell.size
    looks = []
    for i, (at, turn, length) in enumerate(shell.walls):
        x = -length / 2 + s.uniform(0.1, 0.7)
        while x < length / 2 - 0.8:
            kind = s.pick(["sofa", "shelf", "cabinet", "chair", "boxes", "plant", "bed", "pictures", "gap"], [2, 3, 2, 2, 1.5, 1.5, 0.7, 2.5, 1.5])
            blocked = any(abs(v["turn"] - turn) < 1e-6 for v in shell.windows)
            if kind in ("gap", "pictures"):
                if kind == "pictures" and not blocked:
                    on_wall(s, shell, i, t.picture(), x + 0.45, s.uniform(1.3, 1.7))
                x += s.uniform(0.6, 1.2)
                continue
            if kind == "sofa":
                items = t.sofa()
            elif kind == "shelf":
                items = (t.model("shelf") if s.chance(0.35) else []) or t.shelf(s.uniform(0.6, 1.4), s.uniform(0.8, 2.1))
            elif kind == "cabinet":
                items = t.model("cabinet") or [s.box((s.uniform(0.5, 1.2), 0.45, s.uniform(0.6, 1.8)), m.wood(), (0, 0, 0.6), soft=0.005)]
            elif kind == "chair":
                items = t.chair()
            elif kind == "bed":
                items = t.model("bed") or t.sofa()
            elif kind == "boxes":
                items, z = [], 0.0
                for _ in range(int(s.rng.integers(1, 4))):
                    size = (s.uniform(0.3, 0.6), s.uniform(0.3, 0.5), s.uniform(0.2, 0.4))
                    items += s.place(t.carton(size), (0, 0, z), s.uniform(-0.2, 0.2))
                    z += size[2] + 0.002
            else:
                items = t.pot()
            low, high = t.extent(items)
            width, depth = high[0] - low[0], high[1] - low[1]
            if x + width > length / 2 - 0.1 or depth > 0.45 * min(w, d) or high[2] > h - 0.1 or (blocked and high[2] > 0.9):
                t.remove(items)
                x += 0.4
                continue
            s.place(items, (x - low[0], -high[1] - 0.03, 0))
            s.place(items, at, turn)
            look = (x + width / 2, -depth / 2)
            looks.append(
                (
                    at[0] + look[0] * math.cos(turn) - look[1] * math.sin(turn),
                    at[1] + look[0] * math.sin(turn) + look[1] * math.cos(turn),
                    min(0.9, high[2] * 0.6),
                )
            )
            x += width + s.uniform(0.05, 0.6)
    if s.chance(0.6):
        rug = s.card(s.uniform(1.2, 2.6), s.uniform(0.9, 1.8), m.image(t.p.rug()) if s.chance(0.7) else m.fabric(), (0, 0, 0.006))
        s.place([rug], (s.uniform(-0.5, 0.5), s.uniform(-0.5, 0.5), 0), s.uniform(0, 3))
    if table and s.chance(0.8):
        tw, td, th = s.uniform(0.8, 1.7), s.uniform(0.6, 0.95), s.pick([0.42, 0.74])
        x, y, turn = s.uniform(-0.15, 0.15) * w, s.uniform(-0.15, 0.15) * d, s.uniform(0, 3)
        items = t.table(tw, td, th) + clutter(s, t, tw, td, th, int(s.rng.integers(3, 9)))
        for _ in range(int(s.rng.integers(0, 4)) if th > 0.6 else 0):
            a = s.uniform(0, 6.28)
            items += s.place(t.chair(), (math.cos(a) * (tw / 2 + 0.2), math.sin(a) * (td / 2 + 0.2), 0), a - math.pi / 2 + s.uniform(-0.4, 0.4))
        s.place(items, (x, y, 0), turn)
        looks += [(x, y, th)] * 3
    return looks


def clutter(s, t, width, depth, z, count, kinds=None):
    """Things that do not overlap on a rectangle around 0."""
    items, taken = [], []
    for _ in range(count):
        new = getattr(t, s.pick(kinds))() if kinds else (t.papers() if s.chance(0.2) else t.small())
        s.place(new, turn=s.uniform(0, 6.28))
        low, high = t.extent(new)
        r = 0.5 * math.hypot(*(high - low)[:2]) * 0.8
        for _ in range(12):
            x, y = s.uniform(-0.5, 0.5) * max(width - r, 0.05), s.uniform(-0.5, 0.5) * max(depth - r, 0.05)
            if all(math.hypot(x - a, y - b) > r + c for a, b, c in taken):
                taken.append((x, y, r))
                items += s.place(new, (x - (low[0] + high[0]) / 2, y - (low[1] + high[1]) / 2, z + 0.0004))
                break
        else:
            t.remove(new)
    return items


def room(s, m, t):
    w, d, h = s.uniform(2.8, 6), s.uniform(2.8, 7), s.uniform(2.3, 3.1)
    shell = Shell(s, m, t, (w, d, h), {int(i): s.pick([1, 1, 2]) for i in s.rng.choice(4, s.pick([1, 1, 2]), replace=False)})
    looks = furnish(s, m, t, shell)
    if s.chance(0.6):
        sun_through(s, shell)
    if s.chance(0.75) and len(s.groups) < 4:
        ceiling_light(s, m, shell)
    if s.chance(0.6) and len(s.groups) < 4:
        lamp = t.floor_lamp(s.group("lamp"))
        s.place(lamp, (s.uniform(-0.4, 0.4) * w, s.uniform(-0.4, 0.4) * d, 0))
    if s.chance(0.15):
        s.place(t.person(), (s.uniform(-0.3, 0.3) * w, s.uniform(-0.3, 0.3) * d, 0), s.uniform(0, 6))

    def camera():
        eye = (s.uniform(-0.45, 0.45) * w, s.uniform(-0.45, 0.45) * d, s.uniform(0.9, 1.8))
        target = s.pick(looks) if looks and s.chance(0.75) else (s.uniform(-0.5, 0.5) * w, s.uniform(-0.5, 0.5) * d, s.uniform(0.2, 1.4))
        return eye, target, s.uniform(20, 50)

    return camera


def hall(s, m, t):
    """A corridor, a staircase, a gallery: columns, steps, pictures, benches; windows in a row."""
    w, d, h = s.uniform(3, 7), s.uniform(6, 13), s.uniform(2.8, 4.6)
    shell = Shell(s, m, t, (w, d, h), {s.pick([1, 3]): int(s.rng.integers(2, 5))} if s.chance(0.8) else {s.pick([0, 2]): s.pick([1, 2])}, m.wall())
    looks = []
    stone = s.pick([m.paint, lambda: m.mottled(m.gray(0.3, 0.75), 0.15), lambda: m.photo("concrete") or m.mottled(), m.wood])()
    side = s.pick([-1, 1])
    if s.chance(0.55):  # stairs along a wall
        width, rise, tread, n = s.uniform(0.9, 1.6), 0.17, 0.28, int(s.rng.integers(5, 14))
        n = min(n, int((h - 0.4) / rise))
        y0 = s.uniform(-0.3, 0.1) * d
        for i in range(n):
            s.box((width, tread, rise * (i + 1)), stone, (side * (w / 2 - width / 2), y0 + tread * i, rise * (i + 1) / 2))
        s.box(
            (width, max(d / 2 - y0 - tread * n, 0.1) + 0.3, rise * n), stone, (side * (w / 2 - width / 2), (y0 + tread * n + d / 2) / 2, rise * n / 2)
        )
        rail, x = m.paint(m.gray(0.02, 0.6)) if s.chance(0.6) else m.wood(), side * (w / 2 - width + 0.04)
        s.tube([(x, y0, 0.9 + rise), (x, y0 + tread * (n - 1), 0.9 + rise * n)], 0.025, rail)
        for i in range(n):
            s.cylinder(0.012, 0.9, rail, (x, y0 + tread * i, rise * (i + 1)))
        looks.append((side * (w / 2 - width / 2), y0 + tread * n / 2, rise * n / 2))
    if s.chance(0.45):  # columns
        r, gap, x = s.uniform(0.12, 0.3), s.uniform(1.6, 3), -side * s.uniform(0.1, 0.35) * w
        for i in range(int(d / gap)):
            y = -d / 2 + gap * (i + 0.5)
            s.lathe([(r * 1.3, 0), (r * 1.3, 0.1), (r, 0.2), (r * 0.85, h - 0.25), (r * 1.2, h - 0.1), (r * 1.2, h)], stone, (x, y, 0))
            looks.append((x, y, s.uniform(0.5, 1.5)))
    for i, (at, turn, length) in enumerate(shell.walls):
        if any(abs(v["turn"] - turn) < 1e-6 for v in shell.windows):
            continue
        x = -length / 2 + 0.6
        while x < length / 2 - 0.7:
            kind = s.pick(["picture", "door", "sign", "cabinet", "gap"], [4, 1.5, 1, 1, 2])
            if kind == "picture":
                on_wall(s, shell, i, t.picture(), x + 0.4, s.uniform(1.4, 1.7))
            elif kind == "door":
                paint, frame = m.wood() if s.chance(0.5) else m.paint(), m.paint(m.gray(0.3, 0.85))
                on_wall(
                    s,
                    shell,
                    i,
                    [s.box((1.02, 0.05, 2.1), frame, (0, -0.025, 1.05)), s.box((0.88, 0.06, 2.02), paint, (0, -0.04, 1.01), soft=0.01)],
                    x + 0.5,
                    0,
                )
            elif kind == "sign":
                on_wall(
                    s,
                    shell,
                    i,
                    [s.box((0.42, 0.02, 0.28), m.paint(), (0, -0.01, 0)), s.card(0.4, 0.26, m.image(t.p.sign()), (0, -0.022, 0), upright=True)],
                    x + 0.3,
                    s.uniform(1.4, 1.9),
                )
            elif kind == "cabinet":
                on_wall(s, shell, i, (t.model("cabinet") if s.chance(0.5) else []) or t.shelf(0.8, s.uniform(0.8, 1.8)), x + 0.4, 0)
            x += s.uniform(0.9, 1.8)
    for _ in range(int(s.rng.integers(1, 7))):
        kind = s.pick(["bench", "pot", "pedestal", "person", "chair", "carton", "rug"], [1.5, 2, 2, 1.5, 1.5, 1, 1])
        x, y = s.uniform(-0.4, 0.4) * w, s.uniform(-0.45, 0.45) * d
        if kind == "pedestal":
            z = s.uniform(0.7, 1.1)
            items = [s.box((0.35, 0.35, z), m.paint(m.gray(0.4, 0.85)), (0, 0, z / 2), soft=0.004)] + s.place(t.small(), (0, 0, z))
        elif kind == "rug":
            items = [s.card(s.uniform(1, 1.6), s.uniform(2, 4), m.image(t.p.rug()), (0, 0, 0.008))]
        else:
            items = getattr(t, kind)()
        s.place(items, (x, y, 0), s.uniform(0, 6.28))
        looks.append((x, y, s.uniform(0.2, 1)))
    if s.chance(0.8):
        ceiling_light(s, m, shell)
    if s.chance(0.5):
        sun_through(s, shell)

    def camera():
        end = s.pick([-1, 1])
        eye = (s.uniform(-0.4, 0.4) * w, end * s.uniform(0.15, 0.46) * d, s.uniform(0.9, 2.0))
        target = s.pick(looks) if s.chance(0.6) else (s.uniform(-0.5, 0.5) * w, -end * s.uniform(0, 0.5) * d, s.uniform(0.3, 1.6))
        return eye, target, s.uniform(20, 45)

    return camera


def desk(s, m, t):
    """A desk from near: print, keys, mugs, a lamp beside a window, and often a hand's or a head's shadow."""
    shell = Shell(s, m, t, (3.6, 3.4, 2.6), {s.pick([0, 1, 3]): 1}, m.wall())
    tw, td, th = s.uniform(1.1, 1.8), s.uniform(0.6, 0.85), 0.74
    back = 1.7 - td / 2 - 0.02
    top = s.pick([m.wood, lambda: m.paint(m.gray(0.5, 0.85)), m.paint, lambda: m.mottled(strength=0.15), m.fabric], [5, 2, 2, 1, 1])()
    items = t.table(tw, td, th, top)
    document = s.chance(0.45)
    if document:  # sheets, and what lies beside them
        for i in range(s.pick([1, 1, 2, 3])):
            scale = s.uniform(1.0, 2.0)
            sheet = s.card(0.21 * scale, 0.297 * scale, m.image(t.p.flat() if s.chance(0.4) else t.p.page()))
            if s.chance(0.3):  # an open book or a sheet that does not lie flat
                t.remove([sheet])
                k = s.uniform(4, 9)
                sheet = s.cloth(0.21 * scale, 0.297 * scale, m.image(t.p.page()), lambda x, y: 0.012 * (1 + np.sin(k * x / scale * 3)) * scale, 24)
            items += s.place([sheet], (s.uniform(-0.1, 0.1) + 0.24 * i, s.uniform(-0.12, 0.02), th + 0.0005 + 0.0004 * i), s.uniform(-0.4, 0.4))
        items += clutter(s, t, tw * 0.9, td * 0.9, th, int(s.rng.integers(0, 5)), ["pen", "mug", "cube", "tag", "book", "pen"])
    else:
        if s.chance(0.7):
            items += s.place(t.monitor(), (s.uniform(-0.3, 0.3), td / 2 - 0.2, th), s.uniform(-0.3, 0.3))
        if s.chance(0.7):
            items += s.place(t.keyboard(), (s.uniform(-0.2, 0.2), -0.1, th + 0.001), s.uniform(-0.2, 0.2))
            items += s.place(t.mouse(), (s.uniform(0.3, 0.4), -0.1, th + 0.001), s.uniform(-0.4, 0.4))
        items += clutter(s, t, tw * 0.95, td * 0.95, th, int(s.rng.integers(5, 13)))
    lamp_x = s.uniform(0.3, 0.5) * tw * s.pick([-1, 1])
    if s.chance(0.8):
        items += s.place(t.desk_lamp(s.group("lamp")), (lamp_x, td / 2 - 0.12, th), -math.copysign(s.uniform(0.2, 0.9), lamp_x))
    else:
        items.append(s.bulb((s.uniform(-1, 1), s.uniform(-0.8, 0.2), th + s.uniform(0.7, 1.4)), s.uniform(0.02, 0.12), 30, s.group("lamp")))
    if s.chance(0.65 if document else 0.35):  # something over the paper between it and the light
        kind = s.pick(["hand", "phone", "head"], [5, 2, 2])
        at = (s.uniform(-0.25, 0.25), s.uniform(-0.3, 0.05), th + s.uniform(0.03, 0.25))
        if kind == "hand":
            items += s.place(t.hand(), at, s.uniform(-0.8, 0.8), (s.uniform(-0.3, 0.2), 0))
        elif kind == "phone":
            items.append(s.place([s.box((0.075, 0.15, 0.009), m.paint(m.gray(0.02, 0.1)), soft=0.003)], at, s.uniform(0, 3))[0])
        else:
            head = s.ball(0.11, m.paint((0.3, 0.18, 0.12)), (at[0], -0.55, th + s.uniform(0.35, 0.6)), (0.9, 1.1, 1.2))
            head.visible_camera = False  # whoever takes the picture
            items.append(head)
    if s.chance(0.5):
        items += s.place(t.shelf(s.uniform(0.6, 1.2), s.uniform(0.3, 0.7), 0.22), (s.uniform(-0.3, 0.3), td / 2 - 0.11, th + s.uniform(0.45, 0.6)))
    s.place(items, (0, back, 0))
    if s.chance(0.6):
        on_wall(s, shell, 0, t.picture(s.uniform(0.2, 0.5)), s.uniform(-0.8, 0.8), s.uniform(1.2, 1.6))
    s.place(t.chair(), (s.uniform(-0.5, 0.5), back - td / 2 - 0.5, 0), math.pi + s.uniform(-0.5, 0.5))
    if s.chance(0.3) and len(s.groups) < 4:
        sun_through(s, shell)
    if s.chance(0.55) and len(s.groups) < 4:
        ceiling_light(s, m, shell)

    def camera():
        if document:
            distance, a, e = s.uniform(0.28, 0.6), s.uniform(-0.6, 0.6), s.uniform(0.55, 1.45)
            target = (s.uniform(-0.1, 0.12), back - s.uniform(-0.02, 0.15), th)
        else:
            distance, a, e = s.uniform(0.5, 1.4), s.uniform(-0.8, 0.8), s.uniform(0.2, 1.1)
            target = (s.uniform(-0.35, 0.35) * tw, back + s.uniform(-0.25, 0.3) * td, th + s.uniform(0, 0.2))
        eye = (target[0] + distance * math.sin(a) * math.cos(e), target[1] - distance * math.cos(a) * math.cos(e), target[2] + distance * math.sin(e))
        return eye, target, s.uniform(26, 50)

    return camera


def shelves(s, m, t):
    """Shelves, kitchen boards, a garage wall: things side by side, from near."""
    shell = Shell(s, m, t, (3.6, s.uniform(3, 4.5), 2.6), {s.pick([1, 3]): 1}, m.wall())
    d = shell.size[1]
    x, tall = -1.7, s.chance(0.6)
    while x < 1.4:
        w = s.uniform(0.6, 1.5)
        w = min(w, 1.75 - x)
        if w < 0.4:
            break
        depth = s.uniform(0.22, 0.4)
        if s.chance(0.85):
            items = t.shelf(w, s.uniform(1.6, 2.3) if tall else s.uniform(0.7, 1.4), depth, full=0.97)
            s.place(items, (x + w / 2, d / 2 - depth / 2 - 0.01, 0))
            if not tall and s.chance(0.7):
                s.place(t.shelf(w, s.uniform(0.4, 0.6), 0.25, 1, 1), (x + w / 2, d / 2 - 0.14, s.uniform(1.5, 1.8)))
        else:
            on_wall(s, shell, 0, t.picture(), x + w / 2, 1.4)
        x += w + (0 if s.chance(0.5) else s.uniform(0.02, 0.4))
    for _ in range(int(s.rng.integers(0, 4))):
        size = (s.uniform(0.25, 0.5), s.uniform(0.25, 0.5), s.uniform(0.2, 0.5))
        s.place(t.carton(size), (s.uniform(-1.2, 1.2), d / 2 - s.uniform(0.6, 0.9), 0), s.uniform(-0.4, 0.4))
    if s.chance(0.6):
        ceiling_light(s, m, shell)
    else:
        s.place(t.floor_lamp(s.group("lamp")), (s.uniform(-1, 1), d / 2 - 1.2, 0))
    if s.chance(0.35):
        sun_through(s, shell)
    if s.chance(0.25) and len(s.groups) < 4:
        s.bulb((s.uniform(-1, 1), d / 2 - s.uniform(0.5, 1.5), s.uniform(0.6, 2.2)), s.uniform(0.02, 0.1), 30, s.group("lamp"))
    if s.chance(0.3):  # the shadow of whoever takes the picture
        for item in s.place(t.person(), (s.uniform(-0.8, 0.8), d / 2 - s.uniform(1, 1.9), 0), s.uniform(0, 6)):
            item.visible_camera = False

    def camera():
        target = (s.uniform(-1.2, 1.2), d / 2 - 0.25, s.uniform(0.2, 1.7))
        distance, a = s.uniform(0.6, 2.2), s.uniform(-0.7, 0.7)
        eye = (target[0] + distance * math.sin(a), target[1] - distance * math.cos(a), np.clip(target[2] + s.uniform(-0.3, 0.5), 0.2, 2.2))
        return eye, target, s.uniform(24, 50)

    return camera
