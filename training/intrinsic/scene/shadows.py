# SPDX-License-Identifier: LGPL-2.1-or-later
"""Things that are not seen and cast shadows: leaves, blinds, bars, edges, people. They stand between a place and its light."""
import math

from mathutils import Matrix, Vector

KINDS = {"leaves": 4, "blinds": 2, "bars": 2, "edge": 2, "pole": 1.5, "person": 2, "hand": 1, "holes": 1, "net": 1, "railing": 2, "wires": 1}
THIN = {"leaves": 4, "blinds": 1, "bars": 1.5, "edge": 1.2, "pole": 2, "person": 0.7, "hand": 0.5, "holes": 1, "net": 1.5, "railing": 3, "wires": 2}


def before(s, m, t, cast, camera, count):
    """Some of them before what a camera sees of the sun's light and of small lamps', so near to it that their shadows have hard edges.
    `cast(from, direction, reach)` is the place and the normal that a ray meets, or none."""
    lights = [o for o in s.scene.objects if o.type == "LIGHT" and o.data.type in ("SUN", "POINT", "SPOT")]
    if not lights:
        return
    x, y = s.scene.render.resolution_x, s.scene.render.resolution_y
    matrix, f = camera.matrix_basis, camera.data.lens / 36 * max(x, y)
    eye = matrix.translation
    for _ in range(4 * count):
        across, up = s.rng.uniform(-0.42, 0.42, 2)
        light, size, away = s.pick(lights), s.uniform(0.08, 0.32), math.exp(s.uniform(math.log(0.1), math.log(2)))
        hit = cast(eye, (matrix.to_3x3() @ Vector((across * x / f, up * y / f, -1))).normalized(), 100)
        if hit is None:
            continue
        at, normal = hit
        seen = (at - eye).length
        axis = (light.matrix_world.to_3x3() @ Vector((0, 0, 1))).normalized()
        toward, far = (axis, 100) if light.data.type == "SUN" else ((light.matrix_world.translation - at).normalized(), (light.matrix_world.translation - at).length)
        if normal.dot(eye - at) < 0:
            normal = -normal
        if toward.dot(normal) < 0.12 or light.data.type == "SPOT" and toward.dot(axis) < math.cos(0.45 * light.data.spot_size):
            continue
        if cast(at + 2e-3 * seen * normal, toward, far - 0.1) is not None:
            continue  # in shadow
        r = size * seen * max(x, y) / f
        unseen(s, m, t, at, toward, min(r * away, 0.4 * far), r, s.pick(THIN, list(THIN.values())))
        count -= 1
        if not count:
            return


def unseen(s, m, t, at, toward, distance, reach, kind=None):
    """Puts something at `distance` from `at` in the direction `toward`; `reach` is the radius of what it shades, in meters."""
    kind = s.pick(KINDS, list(KINDS.values())) if kind is None else kind
    paint, r = m.paint(m.gray(0.05, 0.5)), reach * s.uniform(0.7, 1.3)
    d = Vector(toward).normalized()
    turn = s.uniform(0, 6.28)
    if kind == "leaves":
        branches = [s.tube([(x, -2 * r, 0), (0.4 * x, 0, 0), (x + s.uniform(-r, r), 2 * r, 0)], 0.01 * r, paint) for x in s.rng.uniform(-r, r, 2)]
        items = [t.leaves(paint, r, (0, 0, 0), int(s.rng.integers(30, 260)), r * s.uniform(0.08, 0.35), 0.3)] + branches
    elif kind == "blinds":
        n, fill = int(s.rng.integers(4, 22)), s.uniform(0.3, 0.8)
        items = [s.box((4 * r, 2.4 * r / n * fill, 0.002 * r), paint, (0, 2.4 * r * ((i + 0.5) / n - 0.5), 0)) for i in range(n)]
    elif kind in ("bars", "net"):
        n, width = (int(s.rng.integers(1, 5)), s.uniform(0.04, 0.12) * r) if kind == "bars" else (int(s.rng.integers(6, 14)), 0.015 * r)
        places = [2.4 * r * ((i + 0.5) / n - 0.5) for i in range(n)]
        items = [s.box((width, 3 * r, 0.02 * r), paint, (x, 0, 0)) for x in places]
        items += [s.box((3 * r, width, 0.02 * r), paint, (0, y, 0)) for y in places]
    elif kind == "railing":
        n = int(s.rng.integers(5, 22))
        width = 3 * r / n * s.uniform(0.12, 0.5)
        items = [s.box((width, 2.2 * r, width), paint, (3 * r * ((i + 0.5) / n - 0.5), 0, 0)) for i in range(n)]
        items += [s.box((3.2 * r, s.uniform(0.03, 0.1) * r, width), paint, (0, y * r, 0)) for y in (-1, 1)]
    elif kind == "wires":
        items = [s.box((s.uniform(0.01, 0.04) * r, 9 * r, 0.01 * r), paint, (x, 0, 0), s.uniform(-0.15, 0.15)) for x in s.rng.uniform(-r, r, s.pick([2, 4, 8]))]
    elif kind == "edge":  # of a wall or a roof
        corner = s.chance(0.4)
        items = [s.box((9 * r, 9 * r, 0.02 * r), paint, (4.5 * r + s.uniform(-0.4, 0.5) * r, 4.5 * r * corner, 0))]
    elif kind == "pole":
        items = [s.box((s.uniform(0.05, 0.3) * r, 9 * r, 0.05 * r), paint, (x, 0, 0)) for x in s.rng.uniform(-r, r, s.pick([1, 1, 2, 3]))]
    elif kind == "holes":
        n, hole = int(s.rng.integers(2, 5)), s.uniform(0.25, 0.7)
        step = 3 * r / n
        items = [s.box((9 * r, step * (1 - hole), 0.01 * r), paint, (0, step * (i - n / 2), 0)) for i in range(n + 1)]
        items += [s.box((step * (1 - hole), 9 * r, 0.01 * r), paint, (step * (i - n / 2), 0, 0.001)) for i in range(n + 1)]
    elif kind == "person":
        items = s.place(t.person(), (0, -1.2, 0))
        for item in items:  # stands in the plane across the light
            item.matrix_basis = Matrix.Scale(r / s.uniform(0.9, 1.6), 4) @ Matrix.Rotation(-math.pi / 2, 4, "X") @ item.matrix_basis
    else:
        items = t.hand()
        for item in items:
            item.matrix_basis = Matrix.Scale(r * s.uniform(3, 7), 4) @ item.matrix_basis
    move = Matrix.Translation(Vector(at) + d * distance) @ d.to_track_quat("Z", "Y").to_matrix().to_4x4() @ Matrix.Rotation(turn, 4, "Z")
    aside = Matrix.Translation((*(s.rng.uniform(-0.5, 0.5, 2) * r), 0))
    for item in items:
        item.matrix_basis = move @ aside @ item.matrix_basis
        item.visible_camera, item.hide_viewport = False, True  # the second for rays that judge cameras
    return items
