# SPDX-License-Identifier: LGPL-2.1-or-later
"""Samples without a renderer: prints, photographs of flat things, patterns and plain paint, laid over each other, bent, and lit by two
lights with drawn shadows. A hundred times as fast as Blender. Same form as sample.py; two lights."""
import functools
import math
import pathlib
import sys

import cv2
import numpy as np

import mix

sys.path.append(str(pathlib.Path(__file__).resolve().parent / "scene"))
import prints

CLIPART = 320  # longest side that is read


class Draw:
    """What prints.py asks of a stage and of materials: random choices, and paints (linear RGB)."""

    def __init__(self, rng):
        self.rng = rng

    def chance(self, p):
        return self.rng.random() < p

    def uniform(self, low, high):
        return float(self.rng.uniform(low, high))

    def pick(self, items, weights=None):
        p = None if weights is None else np.asarray(weights, float) / sum(weights)
        return items[int(self.rng.choice(len(items), p=p))]

    def gray(self, low=0.03, high=0.85):
        return (math.exp(self.uniform(math.log(low), math.log(high))),) * 3

    def color(self):
        """Blacks, whites and grays as often as colors."""
        kind = self.pick(["gray", "black", "white", "vivid", "pale", "dark", "earth"], [14, 14, 14, 13, 12, 10, 13])
        if kind in ("gray", "black", "white"):
            low, high = {"gray": (0.06, 0.6), "black": (0.02, 0.07), "white": (0.6, 0.88)}[kind]
            return tuple(np.array(self.gray(low, high)) * np.exp(self.rng.normal(0, 0.02, 3)))
        hue = self.uniform(0.03, 0.13) if kind == "earth" else self.rng.random()
        saturation, value = {
            "vivid": ((0.6, 0.95), (0.25, 0.85)),
            "pale": ((0.1, 0.4), (0.5, 0.85)),
            "dark": ((0.3, 0.8), (0.05, 0.16)),
            "earth": ((0.3, 0.7), (0.1, 0.5)),
        }[kind]
        s, v = self.uniform(*saturation), self.uniform(*value)
        ramp = np.abs((hue * 6 + np.array([0, 4, 2])) % 6 - 3) - 1
        return tuple(v * (1 - s * (1 - np.clip(ramp, 0, 1))))


@functools.lru_cache(maxsize=4096)
def picture(path):
    """8-bit BGR or BGRA."""
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    scale = min(1, CLIPART / max(image.shape[:2]))
    return cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) if scale < 1 else image


@functools.lru_cache(maxsize=1)
def files(assets):
    """Paths by kind."""
    folder = pathlib.Path(assets) if assets else pathlib.Path("/nonexistent")
    found = {kind: sorted(folder.glob(f"{kind}/*")) for kind in ("textures", "pictures", "clipart")}
    return found


def linear(image):
    """Of 8 bits."""
    return mix.linear(np.asarray(image, np.float32) / 255)


def noise(rng, shape, scale, octaves=3):
    """Smooth random field of standard deviation 1; `scale` pixels is its longest wave."""
    out = np.zeros(shape, np.float32)
    for k in range(octaves):
        cells = [max(2, int(math.ceil(n / scale * 2**k)) + 1) for n in shape]
        out += cv2.resize(rng.normal(size=cells).astype(np.float32), shape[::-1], interpolation=cv2.INTER_CUBIC) * 0.5**k
    return (out - out.mean()) / max(float(out.std()), 1e-6)


class Flat:
    def __init__(self, seed, assets, width, height):
        self.rng = np.random.default_rng([77, seed])
        self.draw = Draw(self.rng)
        self.prints = prints.Prints(self.draw, self.draw)
        self.files = files(assets)
        self.shape = (height, width)

    # --- paint

    def stretch(self, paint):
        """Some pictures gray, darker, or of less contrast."""
        if self.draw.chance(0.3):
            paint = np.repeat(paint.mean(-1, keepdims=True), 3, -1) * np.asarray(self.draw.color() if self.draw.chance(0.3) else (1, 1, 1), np.float32)
        middle = np.exp(np.log(np.maximum(paint, 0.01)).mean())
        paint = middle * (np.maximum(paint, 0.005) / middle) ** self.draw.uniform(0.5, 1.2) * math.exp(self.draw.uniform(-0.7, 0.4))
        return paint

    def texture(self):
        """Photographed surface, repeated."""
        tile = linear(picture(self.draw.pick(self.files["textures"]))[..., 2::-1])
        times = self.draw.uniform(1, 5)
        size = max(16, int(max(self.shape) / times))
        tile = cv2.resize(tile, (size, size), interpolation=cv2.INTER_AREA)
        n = int(math.ceil(times)) + 1
        return self.stretch(np.tile(tile, (n, n, 1)))

    def printed(self):
        return linear(np.asarray(self.prints.flat() if self.draw.chance(0.8) else getattr(self.prints, self.draw.pick(["keys", "rug", "spine"]))()))

    def art(self):
        return self.stretch(linear(picture(self.draw.pick(self.files["pictures"]))[..., 2::-1]))

    def pattern(self):
        """Checks, stripes, plaid, dots, tiles with joints, speckles."""
        n, kind = 192, self.draw.pick(["checks", "stripes", "plaid", "dots", "tiles", "speckles", "blocks"])
        y, x = np.mgrid[:n, :n].astype(np.float32)
        a, b, c = (np.asarray(self.draw.color(), np.float32) for _ in range(3))
        if self.draw.chance(0.35):  # as black and white, or two tones of gray
            a, b = (np.asarray(v, np.float32) for v in (self.draw.gray(0.02, 0.2), self.draw.gray(0.3, 0.88)))
        period = n / self.rng.integers(2, 12)
        u, v = (x % period) / period, (y % period) / period
        i, j = (x // period).astype(int), (y // period).astype(int)
        if kind == "checks":
            which = ((i + j) % 2).astype(np.float32)
        elif kind == "stripes":
            which = (u < self.draw.uniform(0.1, 0.6)).astype(np.float32)
        elif kind == "plaid":
            which = 0.5 * (u < self.draw.uniform(0.2, 0.6)) + 0.5 * (v < self.draw.uniform(0.2, 0.6))
        elif kind == "dots":
            which = ((u - 0.5) ** 2 + (v - 0.5) ** 2 < self.draw.uniform(0.1, 0.45) ** 2).astype(np.float32)
        elif kind == "tiles":
            joint = self.draw.uniform(0.02, 0.1)
            which = ((u < joint) | (v < joint)).astype(np.float32)
        elif kind == "speckles":
            which = (noise(self.rng, (n, n), self.draw.uniform(4, 40)) > self.draw.uniform(-0.5, 1.5)).astype(np.float32)
        else:  # every block of another tone
            tones = np.exp(self.rng.normal(0, self.draw.uniform(0.1, 0.8), (32, 32))).astype(np.float32)
            return np.clip(a * tones[j % 32, i % 32][..., None], 0.02, 0.9)
        out = a + (b - a) * which[..., None]
        if self.draw.chance(0.2):
            out = np.where((i % 3 == 0)[..., None], c, out)
        return out

    def paint(self):
        kinds = ["plain", "print", "pattern"] + ["texture", "art"] * bool(self.files["textures"] and self.files["pictures"])
        kind = self.draw.pick(kinds, [4, 3, 2.5, 3, 1.5][: len(kinds)])
        if kind == "plain":
            return np.ones((8, 8, 3), np.float32) * np.asarray(self.draw.color(), np.float32)
        return {"print": self.printed, "pattern": self.pattern, "texture": self.texture, "art": self.art}[kind]()

    # --- shapes

    def outline(self):
        """A piece's shape, 0…1, on a square of 160 pixels: sheets, disks, polygons, silhouettes."""
        n, kind = 160, self.draw.pick(["sheet", "disk", "polygon", "silhouette"], [6, 2, 2, 4 if self.files["clipart"] else 0])
        shape = np.zeros((n, n), np.float32)
        if kind == "sheet":
            shape[4:-4, 4:-4] = 1
        elif kind == "disk":
            cv2.circle(shape, (n // 2, n // 2), n // 2 - 4, 1, -1, cv2.LINE_AA)
        elif kind == "polygon":
            points = self.rng.uniform(4, n - 4, (int(self.rng.integers(3, 8)), 2)).astype(np.float32)
            cv2.fillConvexPoly(shape, cv2.convexHull(points).astype(np.int32), 1, cv2.LINE_AA)
        else:
            image = picture(self.draw.pick(self.files["clipart"]))
            alpha = image[..., 3] if image.ndim == 3 and image.shape[2] == 4 else np.full(image.shape[:2], 255, np.uint8)
            shape = cv2.resize(alpha.astype(np.float32) / 255, (n, n), interpolation=cv2.INTER_AREA)
        return shape

    def homography(self, size, target):
        """Maps a picture of `size` (height, width) to a quadrilateral around the points `target` (4 × 2), with a jitter."""
        h, w = size
        side = np.linalg.norm(target[0] - target[2])
        target = target + self.rng.normal(0, 0.06 * side, target.shape)
        return cv2.getPerspectiveTransform(np.array([[0, 0], [w, 0], [w, h], [0, h]], np.float32), target.astype(np.float32))

    def quad(self):
        h, w = self.shape
        center, turn = self.rng.uniform((0, 0), (w, h)), self.rng.normal(0, 0.5)
        a, b = math.exp(self.draw.uniform(math.log(25), math.log(150))), math.exp(self.draw.uniform(math.log(25), math.log(120)))
        corners = np.array([[-a, -b], [a, -b], [a, b], [-a, b]]) / 2 @ np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        return center + corners * self.draw.pick([1, 1, 1.6])

    def warp(self, image, matrix, fill=False):
        mode = cv2.BORDER_REFLECT_101 if fill else cv2.BORDER_CONSTANT
        return cv2.warpPerspective(np.ascontiguousarray(image, np.float32), matrix, self.shape[::-1], flags=cv2.INTER_AREA, borderMode=mode)

    # --- light

    def folds(self):
        """Height of folded or crumpled cloth and paper, in pixels."""
        height = np.zeros(self.shape, np.float32)
        y, x = np.mgrid[: self.shape[0], : self.shape[1]].astype(np.float32)
        for _ in range(int(self.rng.integers(1, 6))):
            turn, period = self.rng.uniform(0, math.pi), self.draw.uniform(20, 140)
            wave = x * math.cos(turn) + y * math.sin(turn) + noise(self.rng, self.shape, 120) * period * 0.2
            height += period * self.draw.uniform(0.01, 0.08) * np.sin(2 * math.pi * wave / period)
            if self.draw.chance(0.3):  # a crease
                height += np.abs(wave - self.rng.uniform(0, max(self.shape))) * self.draw.uniform(-0.4, 0.4)
        return height + noise(self.rng, self.shape, self.draw.uniform(20, 90)) * self.draw.uniform(0, 2.5)

    @staticmethod
    def normals(height):
        dy, dx = np.gradient(height)
        n = np.stack([-dx, -dy, np.ones_like(dx)], -1)
        return n / np.linalg.norm(n, axis=-1, keepdims=True)

    def shadow(self):
        """How much of a light gets past things outside the picture, 0…1."""
        y, x = np.mgrid[: self.shape[0], : self.shape[1]].astype(np.float32)
        size, kind = max(self.shape), self.draw.pick(["edge", "pieces", "leaves", "blinds", "window"], [3, 4, 2, 1.5, 1.5])
        turn, place = self.rng.uniform(0, 2 * math.pi), self.rng.uniform(0.2, 0.8, 2) * self.shape[::-1]
        u = (x - place[0]) * math.cos(turn) + (y - place[1]) * math.sin(turn)
        v = (y - place[1]) * math.cos(turn) - (x - place[0]) * math.sin(turn)
        if kind == "edge":
            lit = (u > 0).astype(np.float32)
        elif kind == "pieces":
            lit = np.ones(self.shape, np.float32)
            for _ in range(int(self.rng.integers(1, 5))):
                shape = self.outline()
                lit = np.minimum(lit, 1 - self.warp(shape, self.homography(shape.shape, self.quad() * 1.0)))
        elif kind == "leaves":
            lit = (noise(self.rng, self.shape, self.draw.uniform(15, 80), 4) > self.draw.uniform(-0.6, 0.8)).astype(np.float32)
        elif kind == "blinds":
            period = self.draw.uniform(10, 60)
            lit = ((u % period) < period * self.draw.uniform(0.3, 0.7)).astype(np.float32)
        else:
            a, b, bar = self.draw.uniform(0.2, 0.5) * size, self.draw.uniform(0.2, 0.6) * size, self.draw.uniform(3, 12)
            lit = ((abs(u) < a) & (abs(v) < b) & ((abs(u) > bar) | self.draw.chance(0.4))).astype(np.float32)
        blur = math.exp(self.draw.uniform(math.log(0.4), math.log(14)))
        if self.draw.chance(0.3):  # sharper where what casts it is nearer
            soft, sharp = cv2.GaussianBlur(lit, (0, 0), 3 * blur), cv2.GaussianBlur(lit, (0, 0), blur)
            share = np.clip(0.5 + u / size, 0, 1)
            return share * soft + (1 - share) * sharp
        return cv2.GaussianBlur(lit, (0, 0), blur)

    def make(self):
        draw, shape = self.draw, self.shape
        h, w = shape
        base = self.paint()
        frame = np.array([[0, 0], [w, 0], [w, h], [0, h]], np.float32)
        grow = draw.uniform(1.0, 1.6)
        paint = self.warp(base, self.homography(base.shape[:2], (frame - (w / 2, h / 2)) * grow + (w / 2, h / 2)), fill=True)
        normals = self.normals(self.folds() * draw.uniform(0.3, 1.5)) if draw.chance(0.5) else np.zeros((*shape, 3), np.float32) + (0, 0, 1)
        open_sky, contact = np.ones(shape, np.float32), np.ones(shape, np.float32)
        light = np.array([*self.rng.normal(0, 1, 2), draw.uniform(0.4, 1.6)])
        light /= np.linalg.norm(light)
        for _ in range(int(self.rng.integers(0, 9))):
            outline, piece, quad = self.outline(), self.paint(), self.quad()
            alpha = self.warp(outline, self.homography(outline.shape, quad))
            if draw.chance(0.7):  # a thing that stands out: its shadow, and less light around it
                lift = math.exp(draw.uniform(math.log(1), math.log(18)))
                away = np.float32([[1, 0, -light[0] / light[2] * lift], [0, 1, -light[1] / light[2] * lift]])
                cast = cv2.GaussianBlur(cv2.warpAffine(alpha, away, shape[::-1]), (0, 0), 0.4 + 0.25 * lift)
                contact *= 1 - cast * (1 - alpha)
                open_sky *= 1 - draw.uniform(0.1, 0.7) * cv2.GaussianBlur(alpha, (0, 0), 1 + 0.5 * lift) * (1 - alpha)
            contact, open_sky = contact * (1 - alpha) + alpha, open_sky * (1 - alpha) + alpha
            laid = self.warp(piece, self.homography(piece.shape[:2], quad), fill=True)
            paint = paint * (1 - alpha[..., None]) + laid * alpha[..., None]
            tilt = self.rng.normal(0, 0.25, 2)
            own = np.zeros((*shape, 3), np.float32) + (*tilt, 1)
            if draw.chance(0.5):  # round: height grows from the rim inward
                inside = cv2.distanceTransform((alpha > 0.5).astype(np.uint8), cv2.DIST_L2, 3)
                reach = max(float(inside.max()), 1.0)
                own = self.normals(np.sqrt(np.maximum(reach**2 - (reach - cv2.GaussianBlur(inside, (0, 0), 1.5)) ** 2, 0)) * draw.uniform(0.3, 1.2))
            elif draw.chance(0.3):
                own = self.normals(self.folds())
            own = own / np.linalg.norm(own, axis=-1, keepdims=True)
            normals = normals * (1 - alpha[..., None]) + own * alpha[..., None]
        if draw.chance(0.3):  # grain of paper, cloth, stone
            paint = paint * np.exp(draw.uniform(0.01, 0.12) * noise(self.rng, shape, draw.uniform(2, 8), 2))[..., None]
        paint = np.clip(paint * min(1.0, 0.9 / max(float(np.percentile(paint, 99.5)), 0.01)), 0.015, 0.92).astype(np.float32)

        y, x = np.mgrid[:h, :w].astype(np.float32)
        place, near = self.rng.uniform(-0.5, 1.5, 2) * (w, h), draw.uniform(0.4, 3) * w
        distance = ((x - place[0]) ** 2 + (y - place[1]) ** 2) / near**2
        direct = np.maximum(normals @ light, 0) * contact
        if draw.chance(0.6):
            direct = direct / (1 + distance) ** draw.pick([0.5, 1, 1.5])
        if draw.chance(0.65):
            direct = direct * (1 - draw.uniform(0.5, 1) * (1 - self.shadow()))
        around = np.array([*self.rng.normal(0, 0.6, 2), 1.0])
        fill = open_sky * np.maximum(0.6 + 0.4 * (normals @ (around / np.linalg.norm(around))), 0.05)
        fill = fill * np.exp(draw.uniform(0, 0.5) * noise(self.rng, shape, 1.2 * w, 1))
        shading = np.stack([s / max(float(s.mean()), 1e-4) for s in (direct, fill)])
        kinds = draw.pick([("sun", "sky"), ("lamp", "window"), ("lamp", "lamp"), ("window", "lamp")])
        return {
            "R": paint,
            "S": np.repeat(shading[..., None], 3, -1).astype(np.float32) + 1e-4,
            "N": normals,
            "Z": np.ones(shape, np.float32),
            "mask": np.ones(shape, np.uint8),
            "meta": {"seed": int(self.rng.integers(2**31)), "kind": "flat", "groups": [{"kind": k, "noise": 0.0} for k in kinds]},
        }


def sample(seed, assets=None, width=352, height=264):
    return Flat(seed, assets, width, height).make()
