#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Photographs that differ by light or by paint alone (README.md): couples.py KIND OUT --first SEED --count N … writes OUT/SEED.npz."""
import argparse
import json
import math
import os
import pathlib
import sys
import time

TRAINING = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TRAINING / "intrinsic"), str(TRAINING / "intrinsic/scene"), str(TRAINING.parent / "tests/bench/real")]
import cv2
import numpy as np

import lamp
import mix
import ratios
import retexture
import sample

WIDTH, HEIGHT = 224, 160
DARK, CLIPPED = 3, 254  # codes of pixels that tell nothing
MIN_KNOWN = 0.3  # share of the pixels of a couple
RATIO = 12  # ln ratios are stored in 16 bits


class Pictures:
    """Photographs and environment maps as linear pictures of WIDTH x HEIGHT."""

    def __init__(self, photographs, maps):
        self.files = sorted(f for f in photographs.rglob("*") if f.suffix.lower() in (".jpg", ".jpeg", ".png"))
        self.maps = sorted(maps.glob("*.hdr")) if maps else []

    def draw(self, rng):
        if self.maps and rng.random() < 0.12:
            return self.view(cv2.imread(str(self.maps[int(rng.integers(len(self.maps)))]), -1)[..., ::-1], rng)
        while True:
            image = cv2.imread(str(self.files[int(rng.integers(len(self.files)))]))
            if image is not None:
                return part(image, rng)

    @staticmethod
    def view(environment, rng):
        """A camera's view of a latitude-longitude map."""
        field, yaw, pitch = rng.uniform(40, 80) * math.pi / 180, rng.uniform(0, 2 * math.pi), rng.normal(-0.1, 0.25)
        y, x = np.mgrid[:HEIGHT, :WIDTH].astype(np.float32)
        focal = WIDTH / 2 / math.tan(field / 2)
        right, up, away = (x - WIDTH / 2) / focal, -(y - HEIGHT / 2) / focal, np.ones_like(x)
        up, away = math.cos(pitch) * up + math.sin(pitch) * away, math.cos(pitch) * away - math.sin(pitch) * up
        longitude, latitude = np.arctan2(right, away) + yaw, np.arctan2(up, np.hypot(right, away))
        height, width = environment.shape[:2]
        u, v = (longitude / (2 * math.pi)) % 1 * width, (0.5 - latitude / math.pi) * height
        seen = cv2.remap(environment.astype(np.float32).clip(0, 200), u.astype(np.float32), v.astype(np.float32), cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
        return seen / max(np.percentile(seen.max(-1), rng.uniform(90, 99)), 1e-4) * 0.85


def placed(height, width, rng):
    """(scale, top, left) of a part of WIDTH x HEIGHT of a picture, of which it shows all to a half."""
    scale = max(WIDTH / width, HEIGHT / height)
    scale = min(1.0, scale * rng.uniform(1, 2.2)) if scale < 1 else scale
    size = max(HEIGHT, round(height * scale)), max(WIDTH, round(width * scale))
    return size, int(rng.integers(size[0] - HEIGHT + 1)), int(rng.integers(size[1] - WIDTH + 1))


def part(image, rng):
    """Of an 8-bit BGR picture, linear RGB."""
    size, top, left = placed(*image.shape[:2], rng)
    mode = cv2.INTER_AREA if size[0] < image.shape[0] else cv2.INTER_LINEAR
    image = cv2.resize(image, size[::-1], interpolation=mode)[top : top + HEIGHT, left : left + WIDTH, ::-1]
    if rng.random() < 0.5:
        image = image[:, ::-1]
    return mix.linear(np.ascontiguousarray(image) / 255)


def photographed(pictures, seed, camera):
    """8-bit pictures of linear ones, by one camera or as they are."""
    if not camera:
        return [np.round(255 * mix.srgb(picture)).astype(np.uint8) for picture in pictures]
    made = []
    for k, picture in enumerate(pictures):
        lens = mix.Camera(np.random.default_rng([seed, 9]), np.random.default_rng([seed, k]))
        lens.contrast, lens.bend, lens.black = 1.0, 0.0, 0.0  # or ratios would not hold
        made.append(lens.photograph(picture.clip(0, 4)))
    return made


def triple(seed, picture, light, known, sheet, rng):
    """A picture, the same with light, and one of the two with paint."""
    paint, on_lit = ratios.paint(sheet, picture), rng.random() < 0.5
    lit = picture * np.exp(light)
    images = photographed((picture, lit, (lit if on_lit else picture) * np.exp(paint)), seed, rng.random() < 0.6)
    return found(images, light, paint, known, on_lit)


def found(images, light, paint, known, on_lit):
    usable = np.stack([(i.max(-1) < CLIPPED) & (i.max(-1) > DARK) & (known > 0) for i in images])
    if usable.all(0).mean() < MIN_KNOWN:
        return None
    return {"pictures": np.stack(images), "light": light.clip(-RATIO, RATIO).astype(np.float16),
            "paint": paint.clip(-RATIO, RATIO).astype(np.float16), "usable": usable, "on_lit": on_lit}


def exposed(picture, rng):
    """Half of the pictures darker, so that there can be paint that is brighter than what is in them: else bright things look like light."""
    return picture * math.exp(rng.uniform(-0.3, 0.1) if rng.random() < 0.5 else rng.uniform(-1.8, -0.3))


def photograph(seed, args, rng):
    """Light and paint that are drawn."""
    picture = Pictures(args.photographs, args.maps).draw(rng)
    sheet = ratios.sheet(seed + 5_000_000, args.assets, WIDTH, HEIGHT)
    picture = exposed(picture, rng)
    if rng.random() < 0.35:  # pictures that have more light already
        picture = picture * np.exp(ratios.light(sheet))
    return triple(seed, picture, ratios.light(sheet), np.ones((HEIGHT, WIDTH)), sheet, rng)


def with_depth(seed, args, rng):
    """A lamp's light, by the photograph's depth (lamp.py)."""
    cameras = json.loads((args.depth.parent / "cameras.json").read_text())
    files = sorted(args.depth.glob("*.jpg"))
    file = files[int(rng.integers(len(files)))]
    image, depth = cv2.imread(str(file)), cv2.imread(str(file.with_suffix(".png")), -1).astype(np.float32) / 1000
    size, top, left = placed(*image.shape[:2], rng)
    scale = size[0] / image.shape[0]
    image, depth = cv2.resize(image, size[::-1], interpolation=cv2.INTER_AREA), cv2.resize(depth, size[::-1], interpolation=cv2.INTER_NEAREST)
    light, known = lamp.ratio(depth, [v * scale for v in cameras[f"{args.depth.parent.name}/{args.depth.name}/{file.stem}"]["K"]], rng, 3)
    seen = np.s_[top : top + HEIGHT, left : left + WIDTH]
    planes = [mix.linear(image[seen][..., ::-1] / 255), np.log(light[seen]), known[seen]]
    if rng.random() < 0.5:
        planes = [np.ascontiguousarray(p[:, ::-1]) for p in planes]
    picture, light, known = planes
    sheet = ratios.sheet(seed + 7_000_000, args.assets, WIDTH, HEIGHT)
    return triple(seed, exposed(picture, rng), light, known, sheet, rng)


def window(scene, rng):
    """A part of WIDTH x HEIGHT of a sample, of all of it or of its half size; a turned one if the sample is high."""
    if scene["mask"].shape[0] > scene["mask"].shape[1]:
        turned = {k: np.rot90(scene[k]).copy() for k in ("R", "N", "Z", "mask")}
        scene = {**scene, **turned, "S": np.rot90(scene["S"], 1, (1, 2)).copy()}
    height, width = scene["mask"].shape
    if height < HEIGHT or width < WIDTH:
        return None
    top, left = int(rng.integers(height - HEIGHT + 1)), int(rng.integers(width - WIDTH + 1))
    seen = np.s_[top : top + HEIGHT, left : left + WIDTH]
    return {**scene, **{k: scene[k][seen] for k in ("R", "N", "Z", "mask")}, "S": scene["S"][(slice(None), *seen)]}


def rendered(seed, args, rng):
    """Of a path-traced sample: its lights in other strengths and colors, and other paint in the first light."""
    files = [f for f in sorted(args.samples.glob("*.npz")) if not sample.held_out(f)]
    scene = window(sample.read(files[int(rng.integers(len(files)))]), rng)
    if scene is None:
        return None
    scene = mix.repaint(scene, rng) if rng.random() < 0.4 else scene
    other = retexture.retexture(scene, rng, args.assets) if rng.random() < 0.5 else mix.repaint(scene, rng)
    on_lit, seeds = bool(rng.random() < 0.5), (2 * seed, 2 * seed + 1)
    first, second = (mix.mix(scene, s) for s in seeds)
    third = mix.mix(other, seeds[on_lit])
    of = second if on_lit else first
    light = np.log(second["E"]) - np.log(first["E"])
    # Exposure follows the paint: it is light, and couples have no scale.
    paint = np.log(third["R"] * third["E"]) - np.log(of["R"] * of["E"])
    known = first["mask"] * second["mask"] * third["mask"]
    return found([m["image"] for m in (first, second, third)], light, paint, known, on_lit)


KINDS = {"photographs": photograph, "depth": with_depth, "rendered": rendered}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--count", type=int, default=4000)
    parser.add_argument("--photographs", type=pathlib.Path, help="folder of photographs; permissively licensed ones, for weights that ship")
    parser.add_argument("--maps", type=pathlib.Path, help="folder of environment maps (.hdr)")
    parser.add_argument("--depth", type=lambda p: pathlib.Path(p).resolve(), help="folder of NAME.jpg and NAME.png (depth in millimeters); cameras.json beside the folder")
    parser.add_argument("--samples", type=pathlib.Path, help="folder of samples of ../intrinsic")
    parser.add_argument("--assets", type=pathlib.Path, required=True, help="of ../intrinsic/README.md")
    args = parser.parse_args()
    needed = {"photographs": args.photographs, "depth": args.depth, "rendered": args.samples}[args.kind]
    if needed is None or not needed.is_dir():
        parser.error(f"{args.kind} needs a folder: --{'samples' if args.kind == 'rendered' else args.kind} FOLDER")
    args.out.mkdir(parents=True, exist_ok=True)
    cv2.setNumThreads(1)
    start, made = time.monotonic(), 0
    for seed in range(args.first, args.first + args.count):
        out = args.out / f"{seed:07d}.npz"
        if out.exists():
            continue
        made_one = KINDS[args.kind](seed, args, np.random.default_rng([11, seed]))
        if made_one is None:
            continue
        with open(out.with_suffix(".new"), "wb") as file:
            np.savez(file, **made_one)
        os.replace(out.with_suffix(".new"), out)
        made += 1
    print(f"{made} made, {(time.monotonic() - start) / max(made, 1):.2f} s each")


if __name__ == "__main__":
    main()
