# SPDX-License-Identifier: LGPL-2.1-or-later
"""Streets, yards and open country under sun and sky. Each function builds a scene and returns a function that draws a camera."""
import math

import numpy as np


def daylight(s, m, azimuth=None):
    """Sun and sky, each a group; the sun's azimuth in degrees. Sometimes dusk: sky and lamps alone."""
    s.sky(1.0, s.group("sky"))
    a = s.uniform(0, 360) if azimuth is None else azimuth
    e = s.uniform(14, 68)
    return s.sun(e, a, s.uniform(3, 6), s.group("sun"), s.pick([0.53, 1.5, 4], [8, 1, 1]))


def facade(s, m, t, length, height, material=None):
    """A front along x, its front to -y at y = 0: windows with frames and dark panes, doors, ledges, signs, awnings."""
    wall = (
        s.pick(
            [
                lambda: m.photo("brick") or m.bricks(),
                lambda: m.mottled(m.wall_color(), s.uniform(0.03, 0.2), bump=0.003),
                lambda: m.paint(m.wall_color()),
                lambda: m.photo("concrete") or m.mottled(),
                lambda: m.photo("planks") or m.grain(),
                lambda: m.photo("wall") or m.mottled(),
            ],
            [3, 4, 2, 2, 1, 1],
        )()
        if material is None
        else material
    )
    items = [s.box((length, 0.3, height), wall, (0, 0.15, height / 2))]
    frame, pane = m.paint(m.gray(0.3, 0.85)) if s.chance(0.75) else m.paint(), m.paint(m.gray(0.02, 0.08))
    ww, wh, storey = s.uniform(0.8, 1.5), s.uniform(1.1, 1.8), s.uniform(2.8, 3.4)
    step = ww + s.uniform(0.5, 1.6)
    shop = s.chance(0.4)
    for level in range(int(height // storey)):
        x = -length / 2 + step * 0.6
        while x + ww / 2 < length / 2 - 0.3:
            z = level * storey + 0.9
            if level == 0 and s.chance(0.25):  # a door
                paint = m.paint() if s.chance(0.7) else m.wood()
                items += [
                    s.box((1.1, 0.06, 2.3), frame, (x, -0.01, 1.15)),
                    s.box((0.95, 0.06, 2.15), paint, (x, -0.03, 1.08), soft=0.01),
                    s.box((1.4, 0.5, 0.12), m.mottled(m.gray(0.2, 0.5)), (x, -0.2, 0.06)),
                ]
            else:
                w, h = (ww * 1.4, wh * 1.2) if shop and level == 0 else (ww, wh)
                items += [
                    s.box((w + 0.14, 0.05, h + 0.14), frame, (x, -0.01, z + h / 2)),
                    s.box((w, 0.06, h), pane, (x, -0.012, z + h / 2)),
                    s.box((0.05, 0.07, h), frame, (x, -0.015, z + h / 2)),
                ]
                if s.chance(0.6):
                    items.append(s.box((w + 0.25, 0.16, 0.06), frame, (x, -0.06, z - 0.03)))
                if level and s.chance(0.15):
                    shutter = m.paint()
                    items += [s.box((w / 2, 0.04, h), shutter, (x + k * w * 0.78, -0.03, z + h / 2)) for k in (-1, 1)]
            x += step
        if level and s.chance(0.4):
            items.append(s.box((length, 0.25, 0.14), m.paint(m.gray(0.3, 0.8)), (0, -0.1, level * storey)))
    if shop:
        w = s.uniform(1.5, min(4, length * 0.6))
        x = s.uniform(-0.5, 0.5) * (length - w)
        items += [
            s.box((w, 0.08, 0.55), m.paint(), (x, -0.05, storey - 0.3)),
            s.card(w * 0.9, 0.45, m.image(t.p.sign()), (x, -0.095, storey - 0.3), upright=True),
        ]
        if s.chance(0.6):  # an awning
            striped = m.pattern(size=s.uniform(0.1, 0.25)) if s.chance(0.5) else m.paint()
            items.append(
                s.quad(
                    [
                        (x - w / 2, -1.2, storey - 0.9),
                        (x + w / 2, -1.2, storey - 0.9),
                        (x + w / 2, -0.02, storey - 0.55),
                        (x - w / 2, -0.02, storey - 0.55),
                    ],
                    striped,
                )
            )
    if s.chance(0.5):
        items.append(s.cylinder(0.05, height, m.paint(m.gray(0.1, 0.6)), (s.uniform(-0.45, 0.45) * length, -0.06, 0)))
    return items


def street(s, m, t):
    width, walk = s.uniform(5, 9), s.uniform(1.5, 3.5)
    road = m.photo("asphalt") if s.chance(0.75) else None
    road = road or m.mottled(m.gray(0.04, 0.2), s.uniform(0.1, 0.4), s.uniform(20, 80), bump=0.004)
    s.quad([(-40, -width / 2, 0), (40, -width / 2, 0), (40, width / 2, 0), (-40, width / 2, 0)], road)
    pave = (m.photo(s.pick(["paving", "concrete", "tiles"])) if s.chance(0.7) else None) or m.mottled(m.gray(0.2, 0.5), 0.15, 10)
    curb = m.mottled(m.gray(0.2, 0.6), 0.15)
    for side in (-1, 1):
        y = side * (width / 2 + walk / 2)
        s.box((80, walk, 0.12), pave, (0, y, 0.06))
        s.box((80, 0.15, 0.14), curb, (0, side * (width / 2 + 0.07), 0.07))
    markings(s, m, t, width)
    daylight(s, m)
    both = s.chance(0.55)
    for side in (-1, 1):
        x = -30.0
        while x < 30:
            length = s.uniform(5, 14)
            height = s.uniform(3, 9)
            if s.chance(0.85 if side == 1 or both else 0.25):
                items = facade(s, m, t, length, height)
            elif s.chance(0.5):
                items = t.fence(length, s.uniform(0.9, 1.8))
            else:
                items = []
                for _ in range(int(s.rng.integers(1, 3))):
                    items += s.place(t.tree(), (s.uniform(-0.4, 0.4) * length, s.uniform(0.5, 3), 0))
            s.place(items, turn=0 if side == 1 else math.pi)
            s.place(items, (x + length / 2, side * (width / 2 + walk), 0.1))
            x += length + s.pick([0, 0, 0.6, 2.5])
        s.quad(
            [(-60, side * (width / 2 + walk), 0.02), (60, side * (width / 2 + walk), 0.02), (60, side * 40, 0.02), (-60, side * 40, 0.02)][::side],
            m.photo("ground") or m.mottled((0.12, 0.12, 0.06), 0.3, 2),
        )
    placed = []

    def free(x, y, r):
        if any(math.hypot(x - a, y - b) < r + c for a, b, c in placed):
            return False
        placed.append((x, y, r))
        return True

    for side in (-1, 1):
        for _ in range(int(s.rng.integers(0, 4))):
            x, y = s.uniform(-12, 12), side * (width / 2 - s.uniform(0.95, 1.2))
            if free(x, y, 2.6):
                s.place(t.car(), (x, y, 0.0), math.pi / 2 * side + s.uniform(-0.04, 0.04))
        for _ in range(int(s.rng.integers(2, 9))):
            x, y = s.uniform(-10, 10), side * (width / 2 + s.uniform(0.3, 0.8))
            if not free(x, y, 0.6):
                continue
            kind = s.pick(
                ["sign", "tree", "light", "traffic", "bin", "post", "person", "bicycle", "box", "bench"], [3, 3, 1.5, 1, 1.5, 2, 2, 1, 1, 0.8]
            )
            if kind == "bin":
                items = [s.lathe([(0.22, 0), (0.28, 0.85), (0.3, 0.9)], m.paint())]
            elif kind == "post":
                items = [s.cylinder(s.uniform(0.05, 0.12), s.uniform(0.6, 4.5), m.paint() if s.chance(0.5) else m.paint(m.gray(0.03, 0.5)))]
            elif kind == "box":
                items = t.carton((s.uniform(0.4, 1.2), s.uniform(0.3, 0.6), s.uniform(0.6, 1.4)))
            elif kind in ("light", "traffic", "bicycle"):
                items = t.model(kind)
            else:
                items = getattr(t, kind)()
            s.place(items, (x, y, 0.12), s.uniform(-0.4, 0.4) + (0 if side == 1 else math.pi) + (s.pick([0, 1.57, -1.57])))
    for _ in range(int(s.rng.integers(0, 3))):  # people on the road
        s.place(t.person(), (s.uniform(-6, 6), s.uniform(-0.4, 0.4) * width, 0), s.uniform(0, 6))
    view = s.pick(["along", "road", "front"], [5, 3, 3])

    def camera():
        if view == "front":  # a facade across the road
            side, x = s.pick([-1, 1]), s.uniform(-10, 10)
            eye = (x, side * s.uniform(-0.6, 0.3) * width, s.uniform(1.2, 2.4))
            return eye, (x + s.uniform(-4, 4), side * (width / 2 + walk), s.uniform(0.6, 2.2)), s.uniform(24, 60)
        if view == "road":  # road, curb and what casts shadows on them
            target = (s.uniform(-6, 6), s.uniform(-0.6, 0.6) * width, s.uniform(0, 0.6))
            distance, a, e = s.uniform(2, 5), s.uniform(0, 6.28), s.uniform(0.25, 0.9)
            eye = (
                target[0] + distance * math.cos(a) * math.cos(e),
                target[1] + distance * math.sin(a) * math.cos(e),
                target[2] + distance * math.sin(e),
            )
            return eye, target, s.uniform(26, 50)
        eye = (s.uniform(-8, 8), s.uniform(-0.5, 0.5) * (width + walk), s.uniform(1.2, 3.2))
        a = s.uniform(0, 6.28)
        return eye, (eye[0] + 8 * math.cos(a), eye[1] + 5 * math.sin(a), s.uniform(0, 1.6)), s.uniform(22, 55)

    return camera


def markings(s, m, t, width):
    """White or yellow paint on the road, old or new."""
    paint = m.mottled(m.gray(0.45, 0.8) if s.chance(0.8) else (0.6, 0.4, 0.05), s.uniform(0.05, 0.3), 30)
    z = 0.004
    if s.chance(0.8):
        dash, gap = s.pick([(2, 2), (3, 4), (60, 0)])
        x = -25.0
        while x < 25:
            s.card(min(dash, 50), 0.12, paint, (x + dash / 2, 0, z))
            x += dash + gap
    if s.chance(0.5):
        for side in (-1, 1):
            s.card(60, 0.12, paint, (0, side * (width / 2 - 0.3), z))
    for _ in range(s.pick([0, 1, 1, 2])):  # a crossing
        x = s.uniform(-7, 7)
        for i in range(int(width / 0.9)):
            s.card(s.uniform(2.4, 2.6), 0.45, paint, (x, -width / 2 + 0.6 + 0.9 * i, z + 0.001))
    for _ in range(int(s.rng.integers(0, 4))):  # letters, arrows, patches, lids
        x, y = s.uniform(-7, 7), s.uniform(-0.35, 0.35) * width
        kind = s.pick(["patch", "lid", "arrow", "sheet"])
        if kind == "patch":
            s.card(s.uniform(0.6, 3), s.uniform(0.5, 1.5), m.mottled(m.gray(0.025, 0.12), 0.2, 40), (x, y, z - 0.002))
        elif kind == "lid":
            s.cylinder(0.33, 0.005, m.pattern((m.gray(0.03, 0.08), m.gray(0.1, 0.2)), 0.03), (x, y, 0))
        elif kind == "sheet":
            s.card(0.6, 0.4, m.image(t.p.flat()), (x, y, z), s.uniform(0, 6))
        else:
            s.place(
                [
                    s.mesh(
                        [(-0.7, -0.08, 0), (0.4, -0.08, 0), (0.4, -0.3, 0), (1, 0, 0), (0.4, 0.3, 0), (0.4, 0.08, 0), (-0.7, 0.08, 0)],
                        [(0, 1, 2, 3, 4, 5, 6)],
                        paint,
                    )
                ],
                (x, y, z + 0.001),
                s.pick([0, math.pi]),
            )


def grass(s, m, width, depth, at):
    """Blades on a patch: one mesh."""
    n = int(min(14000, 1400 * width * depth))
    rng = s.rng
    base = np.stack([rng.uniform(-width / 2, width / 2, n), rng.uniform(-depth / 2, depth / 2, n), np.zeros(n)], 1) + at
    a, h, w = rng.uniform(0, 6.28, n), rng.uniform(0.03, 0.1, n), rng.uniform(0.003, 0.008, n)
    side = np.stack([np.cos(a), np.sin(a), np.zeros(n)], 1) * w[:, None]
    lean = np.stack([rng.normal(0, 0.03, n), rng.normal(0, 0.03, n), h], 1)
    vertices = np.stack([base - side, base + side, base + lean], 1).reshape(-1, 3)
    green = m.mottled((s.uniform(0.05, 0.16), s.uniform(0.13, 0.3), s.uniform(0.02, 0.06)), 0.35, 1.5)
    return s.mesh(vertices, np.arange(3 * n).reshape(-1, 3), green)


def yard(s, m, t):
    size = 9.0
    kind = s.pick(["grass", "paving", "half", "gravel"], [3, 3, 3, 1])
    soil = m.mottled((s.uniform(0.06, 0.12), s.uniform(0.1, 0.2), s.uniform(0.02, 0.05)), 0.4, s.uniform(2, 20), bump=0.01)
    lawn = (m.photo("ground") if s.chance(0.4) else None) or soil
    stone = s.pick(
        [
            lambda: m.photo("paving"),
            lambda: m.photo("tiles"),
            lambda: m.photo("concrete"),
            lambda: m.cells([m.gray(0.15, 0.5) for _ in range(3)], s.uniform(3, 8)),
            lambda: m.photo("planks"),
        ]
    )() or m.mottled(m.gray(0.2, 0.5))
    s.quad([(-30, -30, -0.01), (30, -30, -0.01), (30, 30, -0.01), (-30, 30, -0.01)], lawn)
    if kind in ("paving", "half"):
        x0 = -size if kind == "paving" else s.uniform(-1, 1)
        s.box((size - x0, 2 * size, 0.06), stone, ((size + x0) / 2, 0, 0.0))
    if kind == "gravel":
        s.box((2 * size, 2 * size, 0.02), m.cells([m.gray(0.1, 0.6) for _ in range(3)], s.uniform(20, 50)), (0, 0, 0))
    if kind in ("grass", "half"):
        grass(s, m, 4, 4, (-1.5 if kind == "half" else 0, 1, 0))
    # walls and fences behind
    back = s.pick(["wall", "house", "fence", "shed"], [3, 3, 2, 1])
    y = s.uniform(2.5, 4.5)
    if back == "house":
        s.place(facade(s, m, t, 12, s.uniform(3, 6)), (s.uniform(-2, 2), y, 0))
    elif back == "wall":
        wall = (m.photo("brick") if s.chance(0.6) else None) or s.pick([m.bricks, lambda: m.mottled(m.wall_color(), 0.15, bump=0.004)])()
        h = s.uniform(1.4, 3)
        s.box((14, 0.25, h), wall, (0, y + 0.13, h / 2))
        s.box((14, 0.35, 0.08), m.mottled(m.gray(0.2, 0.5)), (0, y + 0.13, h + 0.04))
    elif back == "fence":
        s.place(t.fence(14), (0, y, 0))
    else:
        s.place(t.fence(6, s.uniform(2, 2.6), 0.003), (0, y, 0))
        s.place(t.fence(8), (7, y + 1, 0))
    if s.chance(0.5):  # a wall at the side: a corner with bounces
        side = s.pick([-1, 1])
        s.box((0.25, 12, s.uniform(1.5, 3)), (m.photo("brick") if s.chance(0.5) else None) or m.wall(), (side * s.uniform(2.5, 4.5), 0, 1))
    direction = daylight(s, m, s.uniform(180, 360) if s.chance(0.8) else None)
    # trees that stand between the sun and what is seen
    for _ in range(s.pick([0, 1, 1, 2, 3])):
        h = s.uniform(2.5, 6)
        reach = h * 0.75 / max(math.tan(math.asin(min(direction.z, 0.999))), 0.2)
        flat = math.hypot(direction.x, direction.y) + 1e-6
        at = (direction.x / flat * reach + s.uniform(-1.5, 1.5), direction.y / flat * reach + s.uniform(-1.5, 1.5) + 0.5, 0)
        if at[1] < y - 0.5 and math.hypot(at[0], at[1]) > 0.8:
            s.place(t.tree(h), at, s.uniform(0, 6))
    if s.chance(0.4):
        line(s, m, t)
    for _ in range(int(s.rng.integers(3, 12))):
        kind = s.pick(
            ["pot", "bush", "bench", "chair", "carton", "ball", "sign", "person", "table", "bin", "bicycle", "stone", "tiles", "boards", "hose"],
            [3, 2, 1, 2, 1.5, 1, 0.6, 1, 1, 1, 0.6, 2, 1.5, 0.5, 0.8],
        )
        x, z = s.uniform(-2.8, 2.8), s.uniform(-1.5, y - 0.6)
        if kind == "table":
            w, d = s.uniform(0.7, 1.4), s.uniform(0.6, 0.9)
            items = t.table(w, d, 0.73)
            from .indoors import clutter

            items += clutter(s, t, w, d, 0.73, int(s.rng.integers(1, 6)))
        elif kind == "bin":
            items = [s.lathe([(0.2, 0), (0.26, 0.6)], m.paint())]
        elif kind == "stone":
            r = s.uniform(0.08, 0.3)
            items = [s.ball(r, m.mottled(m.gray(0.1, 0.5), 0.3), (0, 0, r * 0.4), (1, s.uniform(0.6, 1.3), 0.6))]
        elif kind == "tiles":
            items = [s.box((0.4, 0.4, 0.04), m.mottled(strength=0.1), (0.42 * i, 0.42 * j, 0.04)) for i in range(3) for j in range(2)]
        elif kind == "boards":
            items = [
                s.place([s.box((0.2, 0.03, s.uniform(1, 2)), m.wood())], (0.3 * i, 0, 0.7), s.uniform(-0.2, 0.2), (-0.25, 0))[0] for i in range(3)
            ]
        elif kind == "hose":
            a = np.linspace(0, 14, 60)
            items = [s.tube([(0.25 * math.cos(q), 0.25 * math.sin(q), 0.06 + 0.004 * q) for q in a], 0.012, m.paint())]
        elif kind == "bicycle":
            items = t.model("bicycle")
        else:
            items = getattr(t, kind)()
        s.place(items, (x, z, 0.03), s.uniform(0, 6.28))
    close = s.chance(0.4)

    def camera():
        if close:
            target = (s.uniform(-2, 2), s.uniform(-0.5, y), s.uniform(0, 0.8))
            distance, a, e = s.uniform(1, 2.6), s.uniform(-1, 1), s.uniform(0.1, 1.0)
        else:
            target = (s.uniform(-2, 2), s.uniform(0.5, y), s.uniform(0.2, 1.2))
            distance, a, e = s.uniform(2.5, 6), s.uniform(-0.8, 0.8), s.uniform(0.05, 0.5)
        eye = (
            target[0] + distance * math.sin(a) * math.cos(e),
            target[1] - distance * math.cos(a) * math.cos(e),
            max(0.25, target[2] + distance * math.sin(e)),
        )
        return eye, target, s.uniform(24, 55)

    return camera


def country(s, m, t):
    """A meadow, field or beach with things on it; ridges behind, the last ones kilometers away; a low horizon of sky."""
    kind = s.pick(["meadow", "field", "sand", "rock"], [4, 2, 1, 2])
    near = {
        "meadow": lambda: (m.photo("ground") if s.chance(0.4) else None) or m.mottled((s.uniform(0.06, 0.2), s.uniform(0.12, 0.3), 0.04), 0.4, s.uniform(0.5, 8)),
        "field": lambda: m.mottled((s.uniform(0.2, 0.5), s.uniform(0.15, 0.4), s.uniform(0.04, 0.15)), 0.3, s.uniform(0.5, 8), bump=0.01),
        "sand": lambda: m.mottled(np.array([0.6, 0.5, 0.37]) * s.uniform(0.5, 1.2), 0.12, 3, bump=0.004),
        "rock": lambda: m.photo("ground") or m.mottled(m.gray(0.1, 0.5), 0.4, 3, bump=0.01),
    }[kind]()
    a, b, height = s.uniform(0.02, 0.08), s.uniform(0, 6), s.uniform(0.1, 1.2)

    def ground(x, y):
        return height * (np.sin(a * x + b) + np.sin(1.3 * a * y + 2 * b) + 0.3 * np.sin(4 * a * (x + y))) * np.clip((np.hypot(x, y) - 3) / 20, 0, 1)

    s.cloth(240, 240, near, ground, 96)
    if kind == "meadow":
        grass(s, m, 4, 4, (0, 0, 0))
    if s.chance(0.5):  # a path or a wall
        bend, width = s.uniform(-0.02, 0.02), s.uniform(0.8, 2.5)
        y = np.linspace(-20, 80, 60)
        x = s.uniform(-2, 2) + bend * y * y * 0.5 + s.uniform(-0.3, 0.3) * y
        sides = np.stack([np.stack([x + k * width / 2, y, ground(x, y) + 0.03], 1) for k in (-1, 1)], 1).reshape(-1, 3)
        faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(59)]
        s.mesh(sides, faces, m.photo("asphalt") or m.mottled(m.gray(0.15, 0.6), 0.2, 5))
    # ridges: forest, heather, rock, snow
    distance, rise = s.uniform(60, 140), s.uniform(4, 14)
    for _ in range(int(s.rng.integers(2, 6))):
        color = s.pick([(0.05, 0.1, 0.03), (0.1, 0.16, 0.05), (0.2, 0.13, 0.07), (0.22, 0.21, 0.2), (0.7, 0.7, 0.72), (0.25, 0.26, 0.1)], [4, 3, 2, 2, 0.7, 2])
        paint = m.mottled(np.array(color) * s.uniform(0.7, 1.5), s.uniform(0.2, 0.5), s.uniform(4, 20) / distance)
        waves = [(s.uniform(1, 12) / distance, s.uniform(0, 6), s.uniform(0.2, 1)) for _ in range(6)]
        x, v = np.meshgrid(np.linspace(-2.5, 2.5, 160) * distance, np.linspace(0, 1, 14))
        crest = rise * (0.7 + 0.3 * sum(c * np.sin(q * x + p) for q, p, c in waves) / 2)
        rough = 0.06 * rise * (np.sin(29 * x / distance + 7 * v) + np.sin(51 * x / distance - 13 * v)) * np.sin(math.pi * v)
        z = np.maximum(crest, 0.2 * rise) * np.sin(0.5 * math.pi * v) + rough - 1.5
        ridge = np.stack([x, distance + 0.5 * distance * v, z], -1).reshape(-1, 3)
        s.mesh(ridge, [(j * 160 + i, j * 160 + i + 1, (j + 1) * 160 + i + 1, (j + 1) * 160 + i) for j in range(13) for i in range(159)], paint, True)
        distance *= s.uniform(1.7, 3)
        rise *= s.uniform(1.3, 2.6)
    daylight(s, m)
    for _ in range(int(s.rng.integers(4, 14))):
        kind = s.pick(["tree", "bush", "stone", "fence", "person", "sign", "house", "bench", "car"], [4, 3, 3, 1, 1, 0.7, 0.8, 0.6, 0.4])
        y = s.uniform(3, 30) if kind not in ("tree", "house") else s.uniform(7, 60)
        x = s.uniform(-0.5, 0.5) * y
        if kind == "stone":
            r = s.uniform(0.2, 1.2)
            items = [s.ball(r, m.mottled(m.gray(0.1, 0.5), 0.3), (0, 0, r * 0.3), (1, s.uniform(0.6, 1.3), 0.6))]
        elif kind == "house":
            items = facade(s, m, t, s.uniform(6, 12), s.uniform(3, 6))
            items.append(s.box((s.uniform(6, 12), 5, 3), m.wall(), (0, 3, 1.5)))
        elif kind == "fence":
            items = t.fence(s.uniform(4, 14), s.uniform(0.9, 1.4))
        else:
            items = getattr(t, kind)()
        s.place(items, (x, y, float(ground(x, y))), s.uniform(-0.8, 0.8))

    def camera():
        eye = (s.uniform(-1, 1), s.uniform(-3, 0), s.uniform(1.2, 3))
        return eye, (eye[0] + s.uniform(-3, 3), 12, eye[2] + s.uniform(-3.2, 0.6)), s.uniform(24, 60)

    return camera


def line(s, m, t):
    """Towels and sheets on a line."""
    h, y, x = s.uniform(1.5, 2.0), s.uniform(0.5, 2), -1.8
    s.tube([(-2.2, y, h), (0, y, h - 0.04), (2.2, y, h)], 0.005, m.paint(m.gray(0.03, 0.6)))
    while x < 1.5:
        w, drop = s.uniform(0.35, 0.9), s.uniform(0.4, 1.2)
        a, b, c = s.uniform(5, 14), s.uniform(0, 6), s.uniform(0.008, 0.04)
        material = m.fabric() if s.chance(0.7) else m.image(t.p.rug())
        cloth = s.cloth(
            w, drop, material, lambda u, v: c * np.sin(a * u / w + b + 2 * v) * (0.5 - v / drop) + 0.5 * c * np.sin(2.3 * a * u / w - 3 * v), 40
        )
        s.place([cloth], (x + w / 2, y, h - drop / 2 - 0.02), tilt=(math.pi / 2, 0))
        x += w + s.uniform(0.03, 0.3)
