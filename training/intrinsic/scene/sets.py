# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sets from near, where paint and shadow look alike: tables, walls with pictures, floors, clothes, shops. Each function builds a scene and
returns a function that draws a camera: eye, target, focal length in mm."""
import math

import numpy as np
from mathutils import Vector

from . import cloth, shadows
from .outdoors import daylight


def light(s, m, t, at, reach, facing=None, outdoors=False):
    """Sun and sky, or one or two lamps and the light of windows around; something unseen before the first. `facing`: direction of light to
    a wall's front, in degrees."""
    elevation, azimuth = s.uniform(22, 75), s.uniform(0, 360) if facing is None else facing + s.uniform(-65, 65)
    if outdoors:
        toward, distance = daylight(s, m, azimuth), reach * math.exp(s.uniform(math.log(0.2), math.log(3)))
    else:
        s.sky(1.0, s.group("window"))
        e, a, away = math.radians(elevation), math.radians(azimuth), s.uniform(1.5, 4) * max(reach, 0.5)
        toward = Vector((math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)))
        place = Vector(at) + away * toward
        if s.chance(0.75):
            s.bulb(place, math.exp(s.uniform(math.log(0.002), math.log(0.08))) * away, 60, s.group("lamp"))
        else:
            s.area(place, at, (0.4 * away, s.uniform(0.1, 0.4) * away), 60, s.group("window"))
        distance = away * s.uniform(0.08, 0.5)
        if s.chance(0.4):
            other = Vector(at) + away * Vector((math.cos(a + s.uniform(1, 5)), math.sin(a + s.uniform(1, 5)), s.uniform(0.3, 1)))
            s.bulb(other, 0.1 * away, 60, s.group("lamp"))
    if s.chance(0.9):
        shadows.unseen(s, m, t, at, toward, distance, reach)


def textile(s, m, t):
    """Material of a cloth that has texture coordinates."""
    return m.image(t.p.textile(), 1) if s.chance(0.6) else m.fabric()


def upright(s, items, x, z, turn=0.0):
    """Puts flat things with their fronts up onto the wall y = 0."""
    s.place(items, turn=turn)
    return s.place(items, (x, -0.004, z), tilt=(math.pi / 2, 0))


def package(s, m, picture, size):
    """A box with one picture on each side, standing on z = 0."""
    x, y, z = size[0] / 2, size[1] / 2, size[2]
    vertices = [(i * x, j * y, k * z) for k in (0, 1) for j in (-1, 1) for i in (-1, 1)]
    faces = [(0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6), (4, 5, 7, 6), (2, 3, 1, 0)]
    return [s.mesh(vertices, faces, m.image(picture), uv=[(0, 0), (1, 0), (1, 1), (0, 1)] * 6)]


def goods(s, m, t):
    """A product with a printed label."""
    kind = s.pick(["package", "bottle", "can", "carton", "bag", "book"], [5, 2, 2, 1, 1, 1])
    if kind == "package":
        picture = t.p.label() if s.chance(0.6) else t.p.photograph() if s.chance(0.6) else t.p.cover()
        return package(s, m, picture, (s.uniform(0.06, 0.22), s.uniform(0.04, 0.14), s.uniform(0.08, 0.3)))
    if kind == "bag":
        items = cloth.cushion(s, m.image(t.p.label() if s.chance(0.5) else t.p.photograph()), 0.2)
        return s.place(items, (0, 0, 0.1), tilt=(math.pi / 2, 0))
    return t.book(lying=False) if kind == "book" else getattr(t, kind)()


def chessmen(s, m, side, z=0.0):
    """Men of two colors on a board whose squares have this side."""
    dark, pale = m.paint(m.gray(0.02, 0.06)), m.paint(m.gray(0.5, 0.85))
    items, r = [], 0.36 * side
    for i in range(8):
        for j in range(8):
            if s.chance(0.28):
                h = s.uniform(1.2, 2.6) * side
                profile = [(r, 0), (r, 0.1 * h), (0.5 * r, 0.3 * h), (0.4 * r, 0.6 * h), (0.7 * r, 0.7 * h), (0.5 * r, 0.95 * h), (0.01, h)]
                items.append(s.lathe(profile, dark if s.chance(0.5) else pale, ((i - 3.5) * side, (j - 3.5) * side, z), 16))
    return items


def subject(s, m, t):
    """A thing or group some 30 cm wide, standing on z = 0."""
    kind = s.pick(["board", "game", "goods", "sheet", "drape", "dark", "folded", "cushion", "tape", "cards"], [3, 2, 4, 3, 2, 2.5, 1, 1, 1.5, 1])
    if kind in ("board", "tape"):
        picture = t.p.board() if kind == "board" else t.p.tape()
        w = s.uniform(0.15, 0.4)
        h = w * picture.size[1] / picture.size[0]
        items = [s.box((w * 1.02, h * 1.02, 0.006), m.paint(m.gray(0.05, 0.8)), (0, 0, 0.003)), s.card(w, h, m.image(picture), (0, 0, 0.0065))]
        return s.place(items, (0, 0, 0.5 * h if s.chance(0.6) else 0.0), 0, (s.uniform(0.9, 1.5), 0)) if s.chance(0.55) else items
    if kind == "game":
        side = s.uniform(0.025, 0.05)
        board = s.box((10.2 * side, 10.2 * side, 0.01), m.wood(), (0, 0, 0.005))
        return [board, s.card(10 * side, 10 * side, m.image(t.p.game()), (0, 0, 0.0105)), *chessmen(s, m, side, 0.0108)]
    if kind == "goods":
        rows = [s.place(goods(s, m, t), ((i - 1) * 0.16, s.uniform(-0.05, 0.05), 0), s.uniform(-0.5, 0.5)) for i in range(s.pick([1, 2, 3]))]
        return sum(rows, [])
    if kind == "sheet":
        picture = t.p.flat() if s.chance(0.6) else t.p.photograph()
        w = s.uniform(0.15, 0.35)
        return [cloth.crumpled(s, w, w * picture.size[1] / picture.size[0], m.image(picture))]
    if kind == "cards":
        picture = m.image(t.p.game())
        return [o for i in range(5) for o in s.place([s.card(0.063, 0.09, picture, (0, 0.06, 0.0004 * (i + 1)))], (0.02 * i, 0, 0), 0.25 * (2 - i))]
    if kind == "drape":
        u = s.uniform
        solids = [s.box((u(0.08, 0.2), u(0.08, 0.2), h), m.paint(), (u(-0.1, 0.1), 0, h / 2), u(0, 1)) for h in (0.05, 0.15)]
        solids.append(s.box((2, 2, 0.02), m.paint(), (0, 0, -0.011)))
        w = s.uniform(0.4, 0.6)
        item = cloth.drape(s, w, w * s.uniform(0.7, 1.2), textile(s, m, t), solids, (0, 0, 0.24), repeat=s.uniform(1.5, 5))
        t.remove([solids.pop()])
        return [item, *solids]
    if kind == "folded":
        return cloth.folded(s, m.fabric)
    if kind == "cushion":
        return s.place(cloth.cushion(s, textile(s, m, t), s.uniform(0.25, 0.4)), (0, 0, 0.06))
    w, h = s.uniform(0.06, 0.25), s.uniform(0.01, 0.16)  # a camera, a telephone, a loudspeaker
    black = [m.paint(m.gray(0.02, 0.05)) for _ in range(2)]
    items = [s.box((w, w * s.uniform(0.4, 1.5), h), black[0], (0, 0, h / 2), soft=min(0.01, 0.3 * h))]
    if s.chance(0.6):
        items += s.place([s.cylinder(0.25 * w, 0.3 * w, black[1], sides=24)], (0, -0.2 * w, 0.5 * h), tilt=(math.pi / 2 if h > 0.06 else 0, 0))
    if s.chance(0.5):
        items.append(s.card(0.7 * w, 0.3 * w, m.image(t.p.label()), (0, 0, h + 0.001)))
    return items


def backdrop(s, m, t, y, width=7.0, height=3.2):
    """A wall at y; its front to -y."""
    wall = m.image(t.p.textile(), 1) if s.chance(0.12) else m.wall()
    k = s.uniform(8, 25)
    corners = [(-1, -0.5), (1, -0.5), (1, height), (-1, height)]
    uv = [(k * x, 2 * k * z / width) for x, z in corners]
    s.mesh([(x * width / 2, y, z) for x, z in corners], [(0, 1, 2, 3)], wall, uv=uv)


def table(s, m, t):
    """Things on a table before a wall or a sheet of paper."""
    depth = s.uniform(0.4, 0.8)
    top = s.pick([m.wood, m.paint, lambda: m.paint(m.gray(0.45, 0.88)), m.fabric, lambda: m.photo("tiles") or m.cells()], [3, 1, 3, 2, 1])()
    if s.chance(0.3):  # a paper that bends up behind
        bend = np.array([(-1.5, 0)] + [(depth - 0.3 + 0.3 * math.sin(a), 0.3 - 0.3 * math.cos(a)) for a in np.linspace(0, 1.57, 9)] + [(depth, 2)])
        n = len(bend)
        vertices = [(x, y, z) for x in (-2, 2) for y, z in bend]
        s.mesh(vertices, [(i, n + i, n + i + 1, i + 1) for i in range(n - 1)], top, True)
    else:
        s.quad([(-2, -1.5, 0), (2, -1.5, 0), (2, depth + 0.1, 0), (-2, depth + 0.1, 0)], top)
        backdrop(s, m, t, depth + s.uniform(0, 0.6))
    if s.chance(0.25):
        s.place([cloth.crumpled(s, 1.2, 0.7, textile(s, m, t), depth=0.004)], (0, 0, 0.0005), s.uniform(-0.3, 0.3))
    places = [(x + s.uniform(-0.08, 0.08), y + s.uniform(-0.08, 0.08)) for x, y in ((0, 0), (-0.42, 0.05), (0.42, 0.05), (-0.2, -0.34), (0.2, 0.33))]
    for x, y in places[: s.pick([2, 3, 4, 5])]:
        items = subject(s, m, t)
        s.place(items, (x, min(y, depth - 0.25), 0.001), s.uniform(-0.6, 0.6))
    for _ in range(int(s.rng.integers(0, 5))):
        s.place(t.small(), (s.uniform(-0.7, 0.7), s.uniform(-0.6, depth - 0.2), 0.001), s.uniform(0, 6))
    light(s, m, t, (0, 0, 0.05), 0.4, 270, s.chance(0.2))

    def camera():
        target = (s.uniform(-0.25, 0.25), s.uniform(-0.15, 0.15), s.uniform(0, 0.12))
        distance, a, e = s.uniform(0.5, 1.3), s.uniform(-0.9, 0.9), s.uniform(0.2, 1.3)
        eye = (target[0] + distance * math.sin(a) * math.cos(e), target[1] - distance * math.cos(a) * math.cos(e), target[2] + distance * math.sin(e))
        return eye, target, s.uniform(28, 50)

    return camera


def wall(s, m, t):
    """A wall with posters, photographs, notes and signs, and what stands before it."""
    floor = m.floor()
    s.quad([(-4, -5, 0), (4, -5, 0), (4, 0.1, 0), (-4, 0.1, 0)], floor)
    backdrop(s, m, t, 0.0, 8.0, 3.4)
    if s.chance(0.5):
        s.box((8, 0.02, s.uniform(0.06, 0.9)), m.paint(m.gray(0.03, 0.85)), (0, -0.01, 0.05))
    x = -2.2
    while x < 2:
        kind = s.pick(["poster", "frame", "notes", "sign", "board", "cloth", "gap"], [5, 2, 2, 1, 1, 1, 1])
        w = s.uniform(0.3, 1.0)
        z = s.uniform(1.1, 1.8)
        if kind == "poster":
            picture = t.p.poster()
            h = w * picture.size[1] / picture.size[0]
            sheet = s.card(w, h, m.image(picture)) if s.chance(0.5) else cloth.crumpled(s, w, h, m.image(picture), depth=s.uniform(0.003, 0.02))
            upright(s, [sheet], x + w / 2, z, s.uniform(-0.05, 0.05))
        elif kind == "frame":
            s.place(t.picture(w * 0.8), (x + w / 2, -0.003, z))
        elif kind == "notes":
            board = s.box((w, 0.75 * w, 0.01), m.paint(), (0, 0, 0.005))
            notes = []
            for i in range(int(s.rng.integers(3, 12))):
                v = s.uniform(0.08, 0.3) * w
                at = (s.uniform(-0.4, 0.4) * w, s.uniform(-0.25, 0.25) * w, 0.011 + 0.0005 * i)
                notes += s.place([s.card(v, 1.3 * v, m.image(t.p.flat()))], at, s.uniform(-0.3, 0.3))
            upright(s, [board, *notes], x + w / 2, z)
        elif kind in ("sign", "board"):
            picture = t.p.sign() if kind == "sign" else t.p.board()
            upright(s, [s.card(0.6 * w, 0.6 * w * picture.size[1] / picture.size[0], m.image(picture))], x + w / 2, z)
        elif kind == "cloth":
            sheet = cloth.hang(s, w * 1.3, s.uniform(0.6, 1.4), textile(s, m, t), s.pick([2, 3, 5]), repeat=s.uniform(1.5, 5))
            s.place([sheet], (x + w / 2, -0.06, z + 0.6))
        x += w + s.uniform(0.02, 0.4)
    for _ in range(int(s.rng.integers(0, 4))):
        kind = s.pick(["sofa", "cabinet", "chair", "person", "bench", "pot", "carton"], [2, 2, 2, 2, 1, 1, 1])
        items = (t.model("cabinet") or t.shelf(0.8, 1.0)) if kind == "cabinet" else getattr(t, kind)()
        low, high = t.extent(items)
        back = -0.05 - high[1] if kind != "person" else -s.uniform(0.4, 1)
        s.place(items, (s.uniform(-1.8, 1.8), back, 0), s.uniform(-0.2, 0.2) if kind == "person" else 0)
    light(s, m, t, (s.uniform(-0.8, 0.8), 0, s.uniform(0.9, 1.6)), s.uniform(0.7, 1.3), 270, s.chance(0.45))

    def camera():
        target = (s.uniform(-1.3, 1.3), 0, s.uniform(0.7, 1.7))
        distance, a = s.uniform(1.2, 3.2), s.uniform(-0.9, 0.9)
        eye = (target[0] + distance * math.sin(a), -distance * math.cos(a), target[2] + s.uniform(-0.4, 0.6))
        return eye, target, s.uniform(24, 50)

    return camera


def patch(s, material, radius, z):
    """A spot or patch of other paint on the ground."""
    n = s.pick([4, 4, 24])
    a = np.arange(n) * 2 * math.pi / n + 0.785
    r = radius * (1 + (0.0 if n == 4 else 0.25) * np.sin(3 * a + s.uniform(0, 6)) + s.rng.normal(0, 0.04, n))
    stretch = s.uniform(0.3, 1)
    return s.mesh(np.stack([r * np.cos(a), stretch * r * np.sin(a), np.full(n, z)], 1), [tuple(range(n))], material)


def ground(s, m, t):
    """Floors, pavement, courts and roads from near, with paint on them and shadows of what is not seen."""
    outdoors = s.chance(0.7)
    kinds = {
        "checker": lambda: m.checker(m.two_tones(), s.uniform(0.15, 0.5)),
        "tiles": lambda: m.photo("tiles"),
        "asphalt": lambda: m.photo("asphalt"),
        "paving": lambda: m.photo("paving"),
        "plain": lambda: m.mottled(m.gray(0.05, 0.7), s.uniform(0.03, 0.25), s.uniform(5, 60), bump=0.002),
        "concrete": lambda: m.photo("concrete"),
        "planks": lambda: m.photo("planks"),
        "carpet": lambda: m.photo("carpet"),
    }
    share = [2, 1.5, 3, 3, 2, 2, 1, 0.2] if outdoors else [3, 3, 0.3, 0.5, 1, 1, 3, 2]
    base = kinds[s.pick(kinds, share)]() or m.mottled(m.gray(0.05, 0.6), 0.2, 20)
    s.quad([(-12, -12, 0), (12, -12, 0), (12, 12, 0), (-12, 12, 0)], base)
    if s.chance(0.3):  # two floors meet
        other = kinds[s.pick(kinds)]() or m.mottled()
        s.quad([(-12, 0, 0.0005), (12, s.uniform(-1, 1), 0.0005), (12, 12, 0.0005), (-12, 12, 0.0005)], other)
    paint = m.mottled(m.gray(0.4, 0.85) if s.chance(0.7) else m.color(), s.uniform(0.02, 0.25), 30)
    z = 0.0005  # paint has hardly any height: a dark line along its edge would tell what it is
    for _ in range(int(s.rng.integers(1, 6))):
        kind = s.pick(["patch", "line", "crossing", "court", "print", "rug", "motif"], [3, 2, 1.5, 0.7, 1, 0.2 if outdoors else 1.5, 0.7])
        at, turn = (s.uniform(-1.5, 1.5), s.uniform(-1.5, 1.5), 0), s.uniform(0, 6.28)
        z += 0.0004
        if kind == "patch":
            dark = m.mottled(m.gray(0.02, 0.1), 0.2, 40) if s.chance(0.7) else m.mottled()
            items = [patch(s, dark, s.uniform(0.15, 1.2), z)]
        elif kind == "line":
            items = [s.card(20, s.uniform(0.05, 0.2), paint, (0, 0, z))]
        elif kind == "crossing":
            gap = s.uniform(0.3, 0.6)
            items = [s.card(s.uniform(2.2, 2.4), gap, paint, (0, 2 * gap * i, z)) for i in range(-5, 6)]
        elif kind == "court":
            r = s.uniform(0.6, 2)
            a = np.linspace(0, 6.28, 49)
            ring = [(q * math.cos(v), q * math.sin(v), z) for v in a for q in (r, r + 0.08)]
            items = [s.mesh(ring, [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(48)], paint)]
        elif kind == "rug":
            items = [s.card(s.uniform(1, 2), s.uniform(0.7, 1.4), m.image(t.p.rug() if s.chance(0.5) else t.p.textile()), (0, 0, z))]
        else:
            picture = t.p.flat() if kind == "print" else t.p.sign()
            w = s.uniform(0.2, 0.9)
            items = [s.card(w, w * picture.size[1] / picture.size[0], m.image(picture), (0, 0, z))]
        s.place(items, at, turn)
    for _ in range(int(s.rng.integers(0, 5))):
        kind = s.pick(["ball", "carton", "person", "bench", "pot", "chair", "post", "traffic", "bicycle"], [2, 2, 1.5, 0.7, 1, 1, 1.5, 1, 0.5])
        if kind == "post":
            items = [s.cylinder(s.uniform(0.04, 0.12), s.uniform(0.4, 1.2), m.paint())]
        else:
            items = t.model(kind) if kind in ("traffic", "bicycle") else getattr(t, kind)()
        s.place(items, (s.uniform(-2, 2), s.uniform(-1, 2.5), 0), s.uniform(0, 6))
    light(s, m, t, (s.uniform(-0.5, 0.5), s.uniform(-0.5, 0.5), 0), s.uniform(0.7, 1.6), None, outdoors)

    def camera():
        target = (s.uniform(-0.7, 0.7), s.uniform(-0.7, 0.7), 0)
        distance, a, e = s.uniform(1.4, 4), s.uniform(0, 6.28), s.uniform(0.35, 1.35)
        eye = (target[0] + distance * math.cos(a) * math.cos(e), target[1] + distance * math.sin(a) * math.cos(e), distance * math.sin(e))
        return eye, target, s.uniform(26, 50)

    return camera


def clothes(s, m, t):
    """People, clothes on a rail, cloth over a chair, cushions, curtains."""
    s.quad([(-4, -5, 0), (4, -5, 0), (4, 0.6, 0), (-4, 0.6, 0)], m.floor())
    backdrop(s, m, t, 0.6)
    if s.chance(0.5):
        h, y = s.uniform(1.4, 1.9), s.uniform(0, 0.4)
        s.tube([(-2, y, h), (2, y, h)], 0.012, m.paint(m.gray(0.02, 0.6)))
        x = -1.6
        for _ in range(int(s.rng.integers(2, 6))):
            w = s.uniform(0.35, 0.9)
            pins, gather, repeat = s.pick([2, 3, 4]), s.uniform(0.6, 0.9), s.uniform(1.5, 6)
            s.place([cloth.hang(s, w, s.uniform(0.5, 1.2), textile(s, m, t), pins, gather, repeat=repeat)], (x + w / 2, y, h))
            x += w * s.uniform(0.7, 1.2)
    elif s.chance(0.5):
        material = m.image(t.p.textile(), 1) if s.chance(0.5) else m.fabric()
        for x in (-1.1, 0.9)[: s.pick([1, 2])]:
            s.place([cloth.hang(s, 2.2, 2.2, material, s.pick([5, 7]), 0.6, 52, s.uniform(4, 12))], (x, 0.4, 2.3))
    if s.chance(0.6):
        solids = [s.box((0.45, 0.45, 0.45), m.wood(), (0, 0, 0.225)), s.box((0.45, 0.05, 0.9), m.wood(), (0, 0.22, 0.45))]
        s.place(solids, (s.uniform(-1, 1), -0.4, 0), s.uniform(-0.5, 0.5))
        at = solids[0].matrix_basis.translation
        cloth.drape(s, s.uniform(0.8, 1.3), s.uniform(0.8, 1.2), textile(s, m, t), solids, (at.x, at.y + 0.05, 0.98), repeat=s.uniform(2, 7))
    for _ in range(s.pick([0, 0, 1, 2, 3])):
        items = cloth.cushion(s, textile(s, m, t), s.uniform(0.35, 0.5))
        s.place(items, (s.uniform(-1, 1), s.uniform(-0.6, -0.2), 0.2), s.uniform(0, 6), (s.uniform(0.9, 1.4), 0))
    for x in np.linspace(-0.7, 0.7, 3)[s.rng.permutation(3)[: s.pick([0, 1, 1, 2, 3])]]:
        turn = s.uniform(-0.9, 0.9) + math.pi * s.chance(0.2)
        s.place(cloth.wrinkle(s, t.person(), 0.012, 0.12), (x + s.uniform(-0.15, 0.15), s.uniform(-0.8, 0.1), 0), turn)
    light(s, m, t, (0, 0, 1), s.uniform(0.6, 1.2), 270, s.chance(0.3))

    def camera():
        target = (s.uniform(-0.6, 0.6), s.uniform(-0.4, 0.2), s.uniform(0.4, 1.4))
        distance, a = s.uniform(0.9, 2.6), s.uniform(-0.8, 0.8)
        eye = (target[0] + distance * math.sin(a), target[1] - distance * math.cos(a), target[2] + s.uniform(-0.2, 0.5))
        return eye, target, s.uniform(26, 55)

    return camera


def shop(s, m, t):
    """Shelves of goods in rows, with price tags."""
    s.quad([(-4, -5, 0), (4, -5, 0), (4, 1, 0), (-4, 1, 0)], m.photo("tiles") or m.floor())
    backdrop(s, m, t, 0.35)
    board, back = m.paint(m.gray(0.02, 0.85)), m.paint(m.gray(0.05, 0.85)) if s.chance(0.7) else m.wood()
    width, step = s.uniform(1.4, 2.6), s.uniform(0.3, 0.42)
    s.box((width, 0.02, 5 * step), back, (0, 0.3, 2.5 * step))
    tag = m.image(t.p.label())
    for level in range(5):
        z = 0.12 + level * step
        s.box((width, 0.4, 0.025), board, (0, 0.1, z))
        x = -width / 2 + 0.02
        while x < width / 2 - 0.08:
            items = goods(s, m, t)
            low, high = t.extent(items)
            size = high - low
            if size[2] > step - 0.04 or x + size[0] > width / 2:
                t.remove(items)
                x += 0.2
                continue
            s.place(items, (x - low[0], -0.08 - low[1], z + 0.013 - low[2]))
            x += size[0] + 0.008
            for _ in range(int(s.rng.integers(0, 5))):
                if x + size[0] > width / 2:
                    break
                for item in items:
                    copy = item.copy()  # the same mesh
                    copy.matrix_basis = item.matrix_basis.copy()
                    s.scene.collection.objects.link(copy)
                    s.place([copy], (x - low[0] - item.matrix_basis.translation.x if len(items) == 1 else x, 0, 0))
                x += size[0] + 0.008
            if s.chance(0.6):
                s.card(0.06, 0.03, tag, (x - 0.06, -0.102, z), upright=True)
            x += s.uniform(0.0, 0.06)
    if s.chance(0.35):
        s.place(cloth.wrinkle(s, t.person(), 0.012, 0.12), (s.uniform(-0.8, 0.8), -s.uniform(0.6, 1), 0), s.uniform(0, 6))
    light(s, m, t, (0, 0, 1), s.uniform(0.6, 1.2), 270)

    def camera():
        target = (s.uniform(-0.5, 0.5) * width * 0.8, 0, s.uniform(0.3, 1.6))
        distance, a = s.uniform(0.7, 2.2), s.uniform(-0.8, 0.8)
        eye = (target[0] + distance * math.sin(a), -distance * math.cos(a), target[2] + s.uniform(-0.2, 0.4))
        return eye, target, s.uniform(24, 50)

    return camera
