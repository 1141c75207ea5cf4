#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A sheet of photographs (docs/report/photographs.md) with their reflectance and shading in gray and in colored light, as intrinsicdecomp outputs them.

    ./dev shell -c 'tests/bench/report/photographs.py PICTURE|FOLDER … SHEET.jpg'
"""
import pathlib
import subprocess
import sys
import tempfile

import PIL.Image
import PIL.ImageDraw
import PIL.ImageFont

SIZE = 640  # of the longer side of what is decomposed
CELL, GAP, HEAD, SIDE = (236, 158), 4, 20, 20
COLUMNS = ["photograph", "reflectance, gray light", "shading, gray light", "reflectance, colored light", "shading, colored light"]
SUFFIXES = {".png", ".jpg", ".jpeg"}


def pictures(paths):
    for path in map(pathlib.Path, paths):
        yield from sorted(p for p in path.iterdir() if p.suffix.lower() in SUFFIXES) if path.is_dir() else [path]


def decomposed(path, folder, slope):
    """Reflectance and shading of a PNG file."""
    subprocess.run(["gst-launch-1.0", "-q", "filesrc", f"location={path}", "!", "pngdec", "!", "videoconvert", "!", "video/x-raw,format=RGBA",
                    "!", "intrinsicdecomp", f"light-color-slope={slope}", "!", "intrinsicsplit", "name=s"] +
                   [word for name in ("reflectance", "shading") for word in
                    (f"s.{name}", "!", "queue", "!", "video/x-raw,format=RGB", "!", "pngenc", "!", "filesink", f"location={folder}/{name}.png")], check=True)
    for name in ("reflectance", "shading"):
        yield PIL.Image.open(folder / f"{name}.png").convert("RGB")


def cells(path):
    picture = PIL.Image.open(path).convert("RGB")
    scale = min(1, SIZE / max(picture.size))
    picture = picture.resize([round(n * scale) for n in picture.size], PIL.Image.BOX)
    yield picture
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        picture.save(folder / "picture.png")
        for slope in ("0", "auto"):
            yield from decomposed(folder / "picture.png", folder, slope)


def main(*arguments):
    *paths, out = arguments
    rows = [list(cells(path)) for path in pictures(paths)]
    width, height = (n + GAP for n in CELL)
    sheet = PIL.Image.new("RGB", (SIDE + width * len(COLUMNS), HEAD + height * len(rows)), "white")
    draw = PIL.ImageDraw.Draw(sheet)
    font = PIL.ImageFont.truetype("DejaVuSans.ttf", 13)
    for x, title in enumerate(COLUMNS):
        draw.text((SIDE + x * width + CELL[0] / 2, HEAD / 2), title, fill="black", font=font, anchor="mm")
    for y, row in enumerate(rows):
        draw.text((SIDE / 2, HEAD + y * height + CELL[1] / 2), str(y + 1), fill="black", font=font, anchor="mm")
        for x, cell in enumerate(row):
            cell.thumbnail(CELL, PIL.Image.LANCZOS)
            sheet.paste(cell, (SIDE + x * width + (CELL[0] - cell.width) // 2, HEAD + y * height + (CELL[1] - cell.height) // 2))
    sheet.save(out, quality=86, optimize=True)


main(*sys.argv[1:])
