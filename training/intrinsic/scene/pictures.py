# SPDX-License-Identifier: LGPL-2.1-or-later
"""More flat pictures: photographs and paintings of the assets, boards for calibration, games, cloth prints, black print."""
import pathlib

import numpy as np
from PIL import Image, ImageDraw, ImageEnhance

from .prints import Prints, srgb


class Pictures(Prints):
    def __init__(self, stage, materials):
        super().__init__(stage, materials)
        root = pathlib.Path(stage.assets or "/nonexistent")
        self.photographs = sorted((root / "pictures").glob("*.jpg"))
        self.motifs = sorted((root / "clipart").glob("*.png"))

    def black(self):
        return srgb(self.materials.gray(0.02, 0.04))

    def white(self):
        return srgb(self.materials.gray(0.6, 0.88))

    def two(self):
        """Two inks, mostly black and white."""
        kind = self.stage.pick(["black", "gray", "color"], [5, 2, 3])
        if kind == "black":
            return self.black(), self.white()
        if kind == "gray":
            return tuple(srgb(self.materials.gray(0.03, 0.8)) for _ in range(2))
        return srgb(self.materials.color()), self.white() if self.stage.chance(0.5) else srgb(self.materials.color())

    def photograph(self, long=512):
        """A photograph or painting as it is printed; drawn if there are none."""
        if not self.photographs:
            return super().poster()
        path = self.stage.pick(self.photographs)
        self.stage.used.add(path.name)
        image = Image.open(path).convert("RGB")
        w, h = image.size
        k = self.stage.uniform(0.5, 1)
        x, y = self.stage.uniform(0, w * (1 - k)), self.stage.uniform(0, h * (1 - k))
        image = image.crop((int(x), int(y), int(x + w * k), int(y + h * k)))
        image.thumbnail((long, long))
        if self.stage.chance(0.3):
            image = image.convert("L").convert("RGB")
        image = ImageEnhance.Brightness(image).enhance(self.stage.uniform(0.8, 1.6))
        image = ImageEnhance.Contrast(image).enhance(self.stage.uniform(0.8, 1.5))
        return image.point(lambda v: int(v * 0.94))

    def motif(self, size):
        """Clip art with its alpha, or none."""
        if not self.motifs:
            return None
        path = self.stage.pick(self.motifs)
        self.stage.used.add(path.name)
        image = Image.open(path).convert("RGBA")
        image.thumbnail((int(size), int(size)))
        if self.stage.chance(0.25):  # as a black print
            ink = Image.new("RGBA", image.size, (*self.black(), 255))
            ink.putalpha(image.getchannel("A"))
            return ink
        return image

    def stamp(self, image, count, size):
        for _ in range(count):
            motif = self.motif(size * self.stage.uniform(0.6, 1))
            if motif:
                at = [int(self.stage.uniform(-0.1, 0.95) * (a - b * 0.5)) for a, b in zip(image.size, motif.size)]
                image.paste(motif, tuple(at), motif)
        return image

    def magazine(self):
        """A page with photographs in its text."""
        image, draw = self.sheet(600, 800)
        y, ink = 30, self.ink()
        while y < 700:
            h = self.stage.uniform(120, 380)
            if self.stage.chance(0.55):
                photo = self.photograph() if self.stage.chance(0.7) else self.motif(300)
                if photo:
                    photo.thumbnail((540, int(h)))
                    image.paste(photo, (30 if self.stage.chance(0.5) else 570 - photo.size[0], int(y)), photo if photo.mode == "RGBA" else None)
                    h = photo.size[1]
            else:
                for c in range(2):
                    self.paragraph(draw, (30 + 280 * c, y, 280 + 280 * c, min(y + h, 780)), self.stage.pick([13, 18, 26]), ink)
            y += h + 20
        return image

    def board(self):
        """A board for calibration: checkers, dots, a star, a gray wedge, bars, square markers."""
        kind = self.stage.pick(["checker", "dots", "star", "wedge", "bars", "markers"], [5, 1, 1, 1.5, 1, 1.5])
        a, b = (self.black(), self.white()) if self.stage.chance(0.8) else self.two()
        n, m = int(self.rng.integers(3, 11)), int(self.rng.integers(3, 9))
        step = 64
        image, draw = self.sheet((n + 2) * step, (m + 2) * step, b)
        w, h = image.size
        cells = [(i, j, (i + 1) * step, (j + 1) * step) for i in range(n) for j in range(m)]
        if kind == "checker":
            for i, j, x, y in cells:
                if (i + j) % 2 == 0:
                    draw.rectangle([x, y, x + step - 1, y + step - 1], fill=a)
        elif kind == "dots":
            r = step * self.stage.uniform(0.2, 0.4)
            for i, j, x, y in cells:
                draw.ellipse([x + 32 - r, y + 32 - r, x + 32 + r, y + 32 + r], fill=a)
        elif kind == "star":
            rays, r = int(self.rng.integers(8, 24)), 0.45 * min(w, h)
            for i in range(rays):
                draw.pieslice([w / 2 - r, h / 2 - r, w / 2 + r, h / 2 + r], 360 * i / rays, 360 * (i + 0.5) / rays, fill=a)
        elif kind == "wedge":
            for i in range(n):
                draw.rectangle([(i + 1) * step, step, (i + 2) * step - 1, h - step], fill=srgb((0.022 * 38 ** (i / (n - 1)),) * 3))
        elif kind == "bars":
            x = step
            while x < w - step:
                width = self.stage.pick([4, 8, 16, 32])
                draw.rectangle([x, step, x + width, h - step], fill=a)
                x += 2 * width
        else:
            for i, j, x, y in cells[:: self.stage.pick([1, 2])]:
                draw.rectangle([x + 6, y + 6, x + 58, y + 58], fill=a)
                for k, l in zip(*np.nonzero(self.rng.random((4, 4)) < 0.5)):
                    draw.rectangle([x + 14 + 9 * k, y + 14 + 9 * l, x + 22 + 9 * k, y + 22 + 9 * l], fill=b)
        return image

    def game(self):
        """A board or sheet of a game: chess, go, crossword, playing cards, piano keys."""
        kind = self.stage.pick(["chess", "go", "crossword", "cards", "piano"], [4, 1, 1.5, 1.5, 1])
        a, b = self.two()
        if kind == "chess":
            frame = srgb(self.materials.color())
            image, draw = self.sheet(640, 640, frame)
            for i in range(8):
                for j in range(8):
                    draw.rectangle([64 + 64 * i, 64 + 64 * j, 127 + 64 * i, 127 + 64 * j], fill=a if (i + j) % 2 else b)
        elif kind == "go":
            image, draw = self.sheet(600, 600, srgb(np.array([0.55, 0.36, 0.14]) * self.stage.uniform(0.6, 1.3)))
            for i in range(13):
                draw.line([(36 + 44 * i, 36), (36 + 44 * i, 564)], fill=self.black(), width=3)
                draw.line([(36, 36 + 44 * i), (564, 36 + 44 * i)], fill=self.black(), width=3)
            for i, j in self.rng.integers(0, 13, (40, 2)):
                draw.ellipse([16 + 44 * i, 16 + 44 * j, 56 + 44 * i, 56 + 44 * j], fill=self.stage.pick([self.black(), self.white()]))
        elif kind == "crossword":
            image, draw = self.sheet(600, 600, self.white())
            for i in range(14):
                for j in range(14):
                    fill = self.black() if self.stage.chance(0.2) else None
                    draw.rectangle([20 + 40 * i, 20 + 40 * j, 60 + 40 * i, 60 + 40 * j], outline=self.black(), fill=fill, width=2)
        elif kind == "cards":
            image, draw = self.sheet(420, 600, self.white())
            ink = self.black() if self.stage.chance(0.6) else srgb((0.45, 0.02, 0.02))
            draw.text((24, 14), self.stage.pick("23456789AJQK"), fill=ink, font=self.font(90))
            for i in range(int(self.rng.integers(1, 10))):
                x, y = 130 + 120 * (i % 2), 110 + 100 * (i // 2)
                draw.polygon([(x, y - 44), (x + 36, y), (x, y + 44), (x - 36, y)], fill=ink)
        else:
            image, draw = self.sheet(700, 240, self.white())
            for i in range(14):
                draw.line([(50 * i, 0), (50 * i, 240)], fill=self.black(), width=3)
                if i % 7 not in (0, 3):
                    draw.rectangle([50 * i - 15, 0, 50 * i + 15, 145], fill=self.black())
        return image

    def score(self):
        """Sheet music."""
        image, draw = self.sheet(600, 800)
        for y in range(60, 720, 110):
            for k in range(5):
                draw.line([(40, y + 12 * k), (560, y + 12 * k)], fill=self.black(), width=2)
            for x in range(60, 540, int(self.rng.integers(24, 60))):
                n = y + 6 * int(self.rng.integers(-1, 9))
                draw.ellipse([x, n, x + 16, n + 12], fill=self.black())
                draw.line([(x + 15, n + 6), (x + 15, n - 36)], fill=self.black(), width=3)
        return image

    def tape(self):
        """Black, white or colored patches, strips and blots on paper: nothing but value says that they are paint."""
        a, b = self.two()
        image, draw = self.sheet(600, 600, b if self.stage.chance(0.7) else self.paper())
        for _ in range(int(self.rng.integers(1, 7))):
            ink = a if self.stage.chance(0.6) else srgb(self.materials.gray(0.02, 0.5))
            x, y = self.rng.uniform(0, 560, 2)
            w, h = np.exp(self.rng.uniform(np.log(20), np.log(320), 2))
            shape = self.stage.pick(["box", "blot", "wedge", "stripe"])
            if shape == "box":
                draw.rectangle([x, y, x + w, y + h], fill=ink)
            elif shape == "blot":
                t = np.linspace(0, 6.28, 40, endpoint=False)
                r = 1 + sum(self.stage.uniform(0, 0.25) * np.sin(k * t + self.stage.uniform(0, 6)) for k in range(2, 7))
                draw.polygon(list(zip(x + w * 0.6 * r * np.cos(t), y + h * 0.6 * r * np.sin(t))), fill=ink)
            elif shape == "wedge":
                draw.polygon([tuple(p) for p in self.rng.uniform(-60, 660, (3, 2))], fill=ink)
            else:
                p, q = self.rng.uniform(-100, 700, (2, 2))
                draw.line([tuple(p), tuple(q)], fill=ink, width=int(self.stage.uniform(8, 90)))
        return image

    def textile(self):
        """One repeat of a woven or printed cloth: stripes, checks, plaid, dots, herringbone, flowers."""
        n = 256
        a, b = (np.array(srgb(c), float) for c in (self.materials.color(), self.materials.color()))
        if self.stage.chance(0.45):
            a, b = (np.array(c, float) for c in self.two())
        kind = self.stage.pick(["stripes", "gingham", "plaid", "dots", "herringbone", "motifs", "photo"], [4, 2, 3, 1.5, 1, 2, 1])
        if kind == "photo":
            return self.photograph(256)
        y, x = np.mgrid[0:n, 0:n]
        if kind == "stripes":
            edges = np.sort(self.rng.integers(0, n, 2 * int(self.rng.integers(1, 4))))
            on = (np.searchsorted(edges, x) % 2).astype(float)
        elif kind == "gingham":
            on = ((x < n // 2).astype(float) + (y < n // 2)) / 2
        elif kind == "plaid":
            edges = np.sort(self.rng.integers(0, n, 2 * int(self.rng.integers(2, 5))))
            on = ((np.searchsorted(edges, x) % 2).astype(float) + np.searchsorted(edges, y) % 2) / 2
        elif kind == "dots":
            k = self.stage.pick([1, 2, 3])
            u, v = (x * k % n) / n - 0.5, (y * k % n) / n - 0.5
            on = (u * u + v * v < self.stage.uniform(0.04, 0.16)).astype(float)
        elif kind == "herringbone":
            on = (((x + np.where(x < n // 2, y, n - 1 - y)) // 16) % 2).astype(float)
        else:
            on = np.zeros((n, n))
        image = Image.fromarray(np.uint8(a + (b - a) * on[..., None]))
        return self.stamp(image, int(self.rng.integers(3, 14)), 120) if kind == "motifs" else image

    # -- what things already ask for

    def poster(self):
        kind = self.stage.pick(["photo", "magazine", "motifs", "drawn", "board"], [5, 1.5, 1.5, 3, 0.6])
        if kind == "drawn":
            return super().poster()
        if kind == "motifs":
            return self.stamp(self.sheet(500, 680, srgb(self.materials.color()))[0], int(self.rng.integers(1, 6)), 420)
        return {"photo": self.photograph, "magazine": self.magazine, "board": self.board}[kind]()

    def cover(self, width=360, height=520):
        image = super().cover(width, height)
        return self.stamp(image, 1, 0.8 * width) if self.stage.chance(0.4) else image

    def label(self):
        image = super().label()
        return self.stamp(image, self.stage.pick([1, 2]), 220) if self.stage.chance(0.5) else image

    def sign(self):
        if self.stage.chance(0.3):
            return self.stamp(self.sheet(400, 400, self.white())[0], 1, 380)
        return super().sign()

    def flat(self):
        kind = self.stage.pick(["old", "board", "game", "score", "tape", "magazine", "photograph"], [4, 2, 1.5, 0.6, 1.5, 1.5, 1.5])
        return super().flat() if kind == "old" else getattr(self, kind)()
