# SPDX-License-Identifier: LGPL-2.1-or-later
"""Drawn pictures (PIL, sRGB): pages of text, charts, checkers, labels, signs, covers, posters, keys. Print has no shading of its own."""

import numpy as np
from PIL import Image, ImageDraw, ImageFont

FONTS = ["DejaVuSans", "DejaVuSans-Bold", "DejaVuSerif", "DejaVuSerif-Bold", "DejaVuSansMono"]
LETTERS = np.array(list("etaoinshrdlucmfwypvbgkjqxz"))
FREQUENT = np.array([12, 9, 8, 7.5, 7, 6.5, 6.3, 6, 6, 4.2, 4, 2.8, 2.8, 2.4, 2.2, 2.3, 2, 1.9, 1, 1.5, 2, 0.8, 0.2, 0.1, 0.2, 0.1])


def srgb(color):
    """Linear 0…1 to 8-bit sRGB."""
    c = np.clip(np.asarray(color, float), 0, 1)
    return tuple(int(v) for v in np.round(255 * np.where(c <= 0.0031308, 12.92 * c, 1.055 * np.maximum(c, 1e-8) ** (1 / 2.4) - 0.055)))


class Prints:
    def __init__(self, stage, materials):
        self.stage, self.rng, self.materials = stage, stage.rng, materials

    def font(self, size, name=None):
        name = self.stage.pick(FONTS) if name is None else name
        try:
            return ImageFont.truetype(f"{name}.ttf", max(6, int(size)))
        except OSError:  # without fonts: PIL's own, small
            return ImageFont.load_default()

    def word(self):
        n = int(np.clip(self.rng.normal(5, 2.4), 1, 12))
        return "".join(self.rng.choice(LETTERS, n, p=FREQUENT / FREQUENT.sum()))

    def words(self, count):
        return " ".join(self.word() for _ in range(count))

    def ink(self):
        return srgb(self.materials.gray(0.02, 0.05)) if self.stage.chance(0.75) else srgb(self.materials.color())

    def paper(self):
        base = np.array(self.materials.gray(0.6, 0.88))
        return srgb(base * [1, 1, self.stage.uniform(0.8, 1)]) if self.stage.chance(0.85) else srgb(self.materials.color())

    def sheet(self, width=724, height=1024, paper=None):
        image = Image.new("RGB", (width, height), self.paper() if paper is None else paper)
        return image, ImageDraw.Draw(image)

    def paragraph(self, draw, box, size, ink, name=None, align=True):
        """Lines of words into a box; returns the height that is used."""
        font, (x0, y0, x1, y1) = self.font(size, name), box
        y, step = y0, size * self.stage.uniform(1.15, 1.6)
        while y + size < y1:
            line, end = "", x1 if align or self.stage.chance(0.8) else x0 + (x1 - x0) * self.stage.uniform(0.4, 1)
            while True:
                more = f"{line} {self.word()}".strip()
                if draw.textlength(more, font=font) > end - x0:
                    break
                line = more
            draw.text((x0, y), line.capitalize(), fill=ink, font=font)
            y += step
            if self.stage.chance(0.12):
                y += step * 0.7
        return y

    def table(self, draw, box, ink):
        x0, y0, x1, y1 = box
        rows, columns = int(self.rng.integers(3, 9)), int(self.rng.integers(2, 6))
        for i in range(rows + 1):
            y = y0 + (y1 - y0) * i / rows
            draw.line([(x0, y), (x1, y)], fill=ink, width=2)
            for j in range(columns + 1):
                x = x0 + (x1 - x0) * j / columns
                draw.line([(x, y0), (x, y1)], fill=ink, width=2)
                if i < rows and j < columns:
                    text = str(int(self.rng.integers(1, 9999))) if j else self.word()
                    draw.text((x + 6, y + 4), text, fill=ink, font=self.font((y1 - y0) / rows * 0.55))
        if self.stage.chance(0.5):
            draw.rectangle([x0, y0, x1, y0 + (y1 - y0) / rows], outline=ink, fill=None if self.stage.chance(0.5) else ink)

    def chart(self, draw, box, ink):
        x0, y0, x1, y1 = box
        draw.line([(x0, y0), (x0, y1), (x1, y1)], fill=ink, width=3)
        n = int(self.rng.integers(4, 12))
        color = ink if self.stage.chance(0.4) else srgb(self.materials.color())
        heights = self.rng.random(n)
        if self.stage.chance(0.5):
            for i, h in enumerate(heights):
                x = x0 + (x1 - x0) * (i + 0.2) / n
                draw.rectangle([x, y1 - (y1 - y0) * h, x + (x1 - x0) * 0.6 / n, y1], fill=color)
        else:
            draw.line([(x0 + (x1 - x0) * i / (n - 1), y1 - (y1 - y0) * h) for i, h in enumerate(heights)], fill=color, width=4)

    def page(self):
        """A printed page: headings, columns, tables, charts."""
        image, draw = self.sheet()
        w, h = image.size
        ink, margin = self.ink(), self.stage.uniform(0.05, 0.12) * w
        y = margin
        if self.stage.chance(0.7):
            size = self.stage.uniform(28, 70)
            draw.text((margin, y), self.words(int(self.rng.integers(1, 4))).title(), fill=self.ink(), font=self.font(size))
            y += size * 1.6
        columns, size = self.stage.pick([1, 1, 2, 3]), self.stage.pick([11, 14, 18, 24, 34])
        name = self.stage.pick(FONTS[:4])
        while y < h - margin - 60:
            end = min(h - margin, y + self.stage.uniform(0.12, 0.45) * h)
            kind = self.stage.pick(["text", "table", "chart", "block"], [6, 1, 1, 0.6])
            box = (margin, y, w - margin, end)
            if kind == "text":
                step = (w - 2 * margin) / columns
                for c in range(columns):
                    self.paragraph(draw, (margin + c * step, y, margin + (c + 0.93) * step, end), size, ink, name)
            elif kind == "table":
                self.table(draw, box, ink)
            elif kind == "chart":
                self.chart(draw, box, ink)
            else:
                draw.rectangle(box, fill=srgb(self.materials.color()))
            y = end + 24
        return image

    def handwriting(self):
        """Curves like writing on ruled or squared paper."""
        image, draw = self.sheet()
        w, h = image.size
        step = int(self.rng.integers(28, 60))
        rule = srgb(np.array([0.5, 0.6, 0.75]) * self.stage.uniform(0.6, 1.1))
        for y in range(step * 2, h, step):
            draw.line([(0, y), (w, y)], fill=rule, width=2)
        if self.stage.chance(0.4):
            for x in range(0, w, step):
                draw.line([(x, 0), (x, h)], fill=rule, width=2)
        ink = self.stage.pick([srgb((0.02, 0.02, 0.02)), srgb((0.03, 0.05, 0.3)), srgb((0.03, 0.03, 0.08)), srgb((0.4, 0.03, 0.03))])
        width = int(self.rng.integers(2, 6))
        for y in range(step * 2, int(h * self.stage.uniform(0.4, 1)), step):
            x = self.stage.uniform(30, 90)
            while x < w - 80:
                n = int(self.rng.integers(12, 50))
                t = np.arange(n)
                xs = x + t * step * 0.09 + step * 0.1 * np.sin(t * 1.9 + self.rng.random() * 6)
                ys = y - step * 0.25 - step * 0.22 * np.sin(t * 1.3 + self.rng.random() * 6) * self.rng.uniform(0.5, 1.3, n)
                draw.line(list(zip(xs, ys)), fill=ink, width=width)
                x = xs[-1] + step * 0.5
        return image

    def checker(self):
        n = int(self.rng.integers(3, 10))
        a, b = (
            (srgb(self.materials.gray(0.02, 0.05)), srgb(self.materials.gray(0.6, 0.88)))
            if self.stage.chance(0.6)
            else (srgb(self.materials.color()), srgb(self.materials.color()))
        )
        image, draw = self.sheet(512, 512, b)
        step = 512 / n
        for i in range(n):
            for j in range(n):
                if (i + j) % 2:
                    draw.rectangle([i * step, j * step, (i + 1) * step, (j + 1) * step], fill=a)
        return image

    def swatches(self):
        """Patches of paint: a color chart, a gray scale."""
        image, draw = self.sheet(512, 360, srgb((0.03,) * 3))
        columns, rows = self.stage.pick([(6, 4), (8, 5), (4, 3), (10, 1)])
        for i in range(columns):
            for j in range(rows):
                color = (0.03 * 28 ** (i / (columns - 1)),) * 3 if rows == 1 or j == rows - 1 else self.materials.color()
                draw.rectangle(
                    [(i + 0.1) * 512 / columns, (j + 0.1) * 360 / rows, (i + 0.9) * 512 / columns, (j + 0.9) * 360 / rows], fill=srgb(color)
                )
        return image

    def code(self, draw, box, ink):
        """A bar code or a square code."""
        x0, y0, x1, y1 = box
        if self.stage.chance(0.5):
            x = x0
            while x < x1:
                bar = self.rng.integers(1, 4) * (x1 - x0) / 90
                draw.rectangle([x, y0, x + bar, y1], fill=ink)
                x += bar + self.rng.integers(1, 4) * (x1 - x0) / 90
        else:
            side, n = min(x1 - x0, y1 - y0), 21
            for i, j in zip(*np.nonzero(self.rng.random((n, n)) < 0.5)):
                draw.rectangle([x0 + side * i / n, y0 + side * j / n, x0 + side * (i + 1) / n - 1, y0 + side * (j + 1) / n - 1], fill=ink)

    def label(self):
        """A package's label."""
        image, draw = self.sheet(512, 360)
        ink = self.ink()
        if self.stage.chance(0.6):
            draw.rectangle([0, 0, 512, self.stage.uniform(60, 180)], fill=srgb(self.materials.color()))
        draw.text((30, self.stage.uniform(10, 60)), self.word().upper(), fill=self.ink(), font=self.font(self.stage.uniform(50, 110)))
        self.paragraph(draw, (30, 180, 300, 340), self.stage.uniform(14, 26), ink)
        self.code(draw, (330, 200, 490, 330), srgb((0.02,) * 3))
        return image

    def cover(self, width=360, height=520):
        """A book's cover."""
        image, draw = self.sheet(width, height, srgb(self.materials.color()))
        ink = srgb(self.materials.color())
        for _ in range(int(self.rng.integers(0, 5))):
            x, y = self.rng.random(2) * (width, height)
            a, b = self.rng.random(2) * (width, height) * 0.6
            shape = draw.rectangle if self.stage.chance(0.5) else draw.ellipse
            shape([x - a, y - b, x + a, y + b], fill=srgb(self.materials.color()))
        y = self.stage.uniform(0.05, 0.5) * height
        for _ in range(int(self.rng.integers(1, 4))):
            size = self.stage.uniform(24, 76)
            draw.text((width * self.stage.uniform(0.05, 0.2), y), self.word().title(), fill=ink, font=self.font(size))
            y += size * 1.2
        return image

    def spine(self):
        """A book's back, along its height."""
        image, draw = self.sheet(512, 64, srgb(self.materials.color()))
        ink = srgb(self.materials.color())
        if self.stage.chance(0.5):
            for x in (self.stage.uniform(10, 60), self.stage.uniform(440, 500)):
                draw.rectangle([x, 0, x + self.stage.uniform(4, 30), 64], fill=ink)
        draw.text(
            (self.stage.uniform(60, 160), self.stage.uniform(4, 18)), self.words(2).title(), fill=ink, font=self.font(self.stage.uniform(24, 44))
        )
        return image

    def poster(self):
        kind = self.stage.pick(["shapes", "cover", "scenery", "page"], [3, 3, 3, 1])
        if kind == "cover":
            return self.cover(600, 800)
        if kind == "page":
            return self.page()
        image, draw = self.sheet(600, 800, srgb(self.materials.color()))
        if kind == "shapes":
            for _ in range(int(self.rng.integers(4, 30))):
                points = self.rng.random((int(self.rng.integers(3, 6)), 2)) * 350 + self.rng.random(2) * (500, 700) - 100
                draw.polygon([tuple(p) for p in points], fill=srgb(self.materials.color()))
        else:  # a painted landscape: bands of sky, hills, field
            for i in range(int(self.rng.integers(3, 7))):
                y = 150 + i * 110
                x = np.arange(0, 620, 20)
                ridge = y + 60 * np.sin(x / self.stage.uniform(60, 200) + self.rng.random() * 6) + self.rng.normal(0, 6, len(x))
                draw.polygon([(0, 800), *zip(x, ridge), (600, 800)], fill=srgb(self.materials.color()))
        return image

    def sign(self):
        """A road's or a shop's sign."""
        back, ink = self.stage.pick(
            [
                ((0.75,) * 3, (0.02,) * 3),
                ((0.02, 0.05, 0.3), (0.8,) * 3),
                ((0.5, 0.02, 0.02), (0.8,) * 3),
                ((0.03, 0.2, 0.06), (0.8,) * 3),
                ((0.75, 0.55, 0.03), (0.02,) * 3),
                ((0.03,) * 3, (0.8,) * 3),
            ]
        )
        image, draw = self.sheet(512, 320, srgb(back))
        draw.rectangle([12, 12, 500, 308], outline=srgb(ink), width=8)
        kind = self.stage.pick(["words", "number", "arrow"])
        if kind == "words":
            for i in range(self.stage.pick([1, 2])):
                draw.text((40, 40 + 130 * i), self.word().upper()[:8], fill=srgb(ink), font=self.font(self.stage.uniform(70, 110), "DejaVuSans-Bold"))
        elif kind == "number":
            draw.text((130, 30), str(int(self.rng.integers(1, 12)) * 10), fill=srgb(ink), font=self.font(200, "DejaVuSans-Bold"))
        else:
            draw.polygon([(60, 130), (300, 130), (300, 60), (450, 160), (300, 260), (300, 190), (60, 190)], fill=srgb(ink))
        return image

    def keys(self):
        """Tops of a keyboard's keys."""
        dark = self.stage.chance(0.65)
        back, top = (0.022, 0.04) if dark else (0.35, 0.75)
        ink = srgb((0.7,) * 3 if dark else (0.03,) * 3)
        image, draw = self.sheet(960, 320, srgb((back,) * 3))
        font = self.font(22, "DejaVuSans")
        for row in range(5):
            x = 10 + row % 3 * 14
            while x < 900:
                width = 56 if self.stage.chance(0.9) else 110
                if row == 4 and 250 < x < 330:
                    width = 330
                width = min(width, 950 - x)
                draw.rounded_rectangle([x, 8 + row * 62, x + width - 6, 62 + row * 62], 8, fill=srgb((top,) * 3))
                draw.text((x + 14, 18 + row * 62), str(self.rng.choice(LETTERS)).upper(), fill=ink, font=font)
                x += width
        return image

    def rug(self):
        image, draw = self.sheet(600, 400, srgb(self.materials.color()))
        colors = [srgb(self.materials.color()) for _ in range(4)]
        for i in range(int(self.rng.integers(1, 5))):
            m = 18 + i * int(self.rng.integers(14, 34))
            draw.rectangle([m, m, 600 - m, 400 - m], outline=colors[i % 4], width=int(self.rng.integers(4, 20)))
        n = int(self.rng.integers(4, 14))
        for i in range(n):
            for j in range(int(n * 0.66)):
                if self.stage.chance(0.7):
                    x, y, r = 110 + 380 * i / n, 110 + 180 * j / (n * 0.66), 120 / n
                    draw.polygon([(x, y - r), (x + r, y), (x, y + r), (x - r, y)], fill=colors[(i + j) % 4])
        return image

    def flat(self):
        """Anything that lies on a desk or hangs on a wall."""
        return getattr(
            self, self.stage.pick(["page", "handwriting", "checker", "swatches", "label", "cover", "poster", "sign"], [6, 2, 1.5, 1, 2, 2, 1, 0.6])
        )()
