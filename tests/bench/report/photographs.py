#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A sheet of photographs (docs/report/photographs.md) with their reflectance and shading, as elements output them.

    ./dev shell -c 'tests/bench/report/photographs.py PICTURE|FOLDER … SHEET.jpg [--elements TITLE=ELEMENT …]'
"""
import argparse
import pathlib
import subprocess
import tempfile

import PIL.Image
import PIL.ImageDraw
import PIL.ImageFont

SIZE = 640  # of the longer side of what is decomposed
CELL, GAP, HEAD, SIDE = (236, 158), 4, 20, 20
LAYERS = ("reflectance", "shading")
SUFFIXES = {".png", ".jpg", ".jpeg"}
ELEMENTS = ("thesis=intrinsicdecompthesis", "fitted=intrinsicdecomp prior=fitted", "learned=intrinsicdecomp prior=learned")


def pictures(paths):
    for path in paths:
        yield from sorted(p for p in path.iterdir() if p.suffix.lower() in SUFFIXES) if path.is_dir() else [path]


def decomposed(path, folder, element):
    """Reflectance and shading of a PNG file."""
    subprocess.run(["gst-launch-1.0", "-q", "filesrc", f"location={path}", "!", "pngdec", "!", "videoconvert", "!", "video/x-raw,format=RGBA",
                    "!", *element.split(), "!", "intrinsicsplit", "name=s"] +
                   [word for name in LAYERS for word in
                    (f"s.{name}", "!", "queue", "!", "video/x-raw,format=RGB", "!", "pngenc", "!", "filesink", f"location={folder}/{name}.png")],
                   check=True)
    for name in LAYERS:
        yield PIL.Image.open(folder / f"{name}.png").convert("RGB")


def cells(path, elements):
    picture = PIL.Image.open(path).convert("RGB")
    scale = min(1, SIZE / max(picture.size))
    picture = picture.resize([round(n * scale) for n in picture.size], PIL.Image.BOX)
    yield picture
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        picture.save(folder / "picture.png")
        for element in elements:
            yield from decomposed(folder / "picture.png", folder, element)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", nargs="+", type=pathlib.Path, help="files, or folders of them")
    parser.add_argument("sheet", type=pathlib.Path)
    parser.add_argument("--elements", nargs="+", default=ELEMENTS, metavar="TITLE=ELEMENT", help="columns; by default %(default)s")
    args = parser.parse_args()
    elements = dict(element.split("=", 1) for element in args.elements)
    columns = ["photograph", *(f"{layer}, {title}" for title in elements for layer in LAYERS)]
    rows = [list(cells(path, elements.values())) for path in pictures(args.pictures)]
    width, height = (n + GAP for n in CELL)
    sheet = PIL.Image.new("RGB", (SIDE + width * len(columns), HEAD + height * len(rows)), "white")
    draw = PIL.ImageDraw.Draw(sheet)
    font = PIL.ImageFont.truetype("DejaVuSans.ttf", 13)
    for x, title in enumerate(columns):
        draw.text((SIDE + x * width + CELL[0] / 2, HEAD / 2), title, fill="black", font=font, anchor="mm")
    for y, row in enumerate(rows):
        draw.text((SIDE / 2, HEAD + y * height + CELL[1] / 2), str(y + 1), fill="black", font=font, anchor="mm")
        for x, cell in enumerate(row):
            cell.thumbnail(CELL, PIL.Image.LANCZOS)
            sheet.paste(cell, (SIDE + x * width + (CELL[0] - cell.width) // 2, HEAD + y * height + (CELL[1] - cell.height) // 2))
    sheet.save(args.sheet, quality=86, optimize=True)


main()
