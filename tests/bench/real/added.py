# SPDX-License-Identifier: LGPL-2.1-or-later
"""Light and paint that are added to photographs. Whatever a photograph's own layers are, the difference of the two decompositions must be the
added ratio: in shading for light, in reflectance for paint. The same in every run. Pictures and ratios are BGR."""
import json
import pathlib
import typing

import cv2
import lamp
import numpy as np
from methods import linear, srgb

SIZE = 384  # of the longer side, at most
LETTERS = list("ABEHKMNRSTXZ23568")
SHEET = 256  # pixels of a drawn print
MIN_USABLE, MIN_SPREAD = 0.3, 0.08  # of pixels; standard deviation of the added ln ratio


class Case(typing.NamedTuple):
    """before, after: uint8 pictures; ratio: mean ln ratio of linear light that was added; usable: pixels that are neither dark nor clipped."""

    kind: str
    before: np.ndarray
    after: np.ndarray
    ratio: np.ndarray
    usable: np.ndarray


def log_uniform(rng, low, high):
    return np.exp(rng.uniform(np.log(low), np.log(high)))


def shape(rng, height, width):
    """0 to 1: a half plane, a polygon, a figure of ellipses, leaves, bars or a disc."""
    kind = rng.integers(6)
    mask = np.zeros((height, width), np.float32)
    y, x = np.mgrid[:height, :width].astype(np.float32)
    angle = rng.uniform(0, np.pi * 2)
    cx, cy = rng.uniform(0.25, 0.75) * width, rng.uniform(0.25, 0.75) * height
    u = (x - cx) * np.cos(angle) + (y - cy) * np.sin(angle)
    v = (y - cy) * np.cos(angle) - (x - cx) * np.sin(angle)
    size = min(height, width)
    if kind == 0:
        return (u > 0).astype(np.float32)
    if kind == 1:
        corners = np.stack([cx + size * rng.uniform(-0.4, 0.4, 6), cy + size * rng.uniform(-0.4, 0.4, 6)], 1)
        return cv2.fillPoly(mask, [np.int32(corners)], 1)
    if kind == 2:
        for _ in range(rng.integers(3, 8)):
            center = (int(cx + size * rng.normal(0, 0.12)), int(cy + size * rng.normal(0, 0.25)))
            axes = (int(size * rng.uniform(0.04, 0.15)), int(size * rng.uniform(0.06, 0.3)))
            cv2.ellipse(mask, center, axes, float(rng.uniform(0, 180)), 0, 360, 1, -1)
        return mask
    if kind == 3:
        octaves = [rng.normal(size=(int(4 * 2**o), int(5 * 2**o))).astype(np.float32) for o in range(4)]
        noise = sum(cv2.resize(n, (width, height), interpolation=cv2.INTER_CUBIC) * 0.6**o for o, n in enumerate(octaves))
        return (noise > 0.4 * noise.std()).astype(np.float32)
    if kind == 4:
        period = size * rng.uniform(0.06, 0.2)
        return ((u % period) < period * rng.uniform(0.3, 0.6)).astype(np.float32) * (abs(v) < size * 0.5)
    return (u * u + v * v < (size * rng.uniform(0.12, 0.35)) ** 2).astype(np.float32)


def light(rng, height, width):
    """Ratio of light: a cast shadow with a penumbra and a bluer fill, or light that falls off."""
    if rng.random() < 0.7:
        mask = shape(rng, height, width)
        mask = cv2.GaussianBlur(mask, (0, 0), log_uniform(rng, 0.6, 8))
        fill, tint = log_uniform(rng, 0.12, 0.5), rng.uniform(0, 0.25)
        fill = fill * np.array([1 + tint, 1, 1 - tint])
        return (fill + (1 - fill) * (1 - mask[..., None])).astype(np.float32)
    y, x = np.mgrid[:height, :width].astype(np.float32)
    far = np.hypot(x - rng.uniform(0, width), y - rng.uniform(0, height)) / max(height, width)
    gain = 0.25 + 1 / (1 + (far / rng.uniform(0.15, 0.5)) ** 2)
    gain, tint = gain / gain.max(), rng.uniform(0, 0.15)
    return np.stack([gain ** (1 + tint), gain, gain ** (1 - tint)], 2).astype(np.float32)


def pattern(rng):
    """0 to 1 on a sheet: print, checks, stripes, patches or a shape."""
    n, kind = SHEET, rng.integers(5)
    y, x = np.mgrid[:n, :n]
    if kind == 0:
        sheet = np.zeros((n, n), np.uint8)
        for row in range(rng.integers(2, 6)):
            text, font = "".join(rng.choice(LETTERS, 8)), int(rng.choice([0, 2, 3, 4]))
            cv2.putText(sheet, text, (4, 40 + 48 * row), font, rng.uniform(0.8, 1.8), 255, int(rng.integers(3, 9)), cv2.LINE_AA)
        return sheet / 255.0
    if kind == 1:
        step = n // rng.integers(3, 9)
        return ((x // step + y // step) % 2).astype(float)
    if kind == 2:
        step = n // rng.integers(3, 9)
        return (x % step < step * rng.uniform(0.3, 0.6)).astype(float)
    if kind == 3:
        sheet = np.zeros((n, n))
        for _ in range(2):
            cv2.rectangle(sheet, tuple(map(int, rng.integers(0, n, 2))), tuple(map(int, rng.integers(0, n, 2))), 1, -1)
        return sheet
    return shape(rng, n, n).astype(float)


def paint(rng, height, width):
    """Ratio of reflectance: a sheet with a dark pattern, gray or colored, in perspective."""
    n = SHEET
    color = log_uniform(rng, 0.06, 0.5) * np.exp(rng.normal(0, 0.35, 3) * (rng.random() < 0.4))
    color = np.clip(color, 0.04, 0.95).astype(np.float32)
    sheet = 1 + pattern(rng)[..., None].astype(np.float32) * (color - 1)
    size = min(height, width) * rng.uniform(0.3, 0.8)
    center = rng.uniform(0.3, 0.7) * width, rng.uniform(0.3, 0.7) * height
    angle = rng.uniform(-0.5, 0.5)
    corners = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * size * np.array([1, rng.uniform(0.5, 1)])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = corners @ turn.T + rng.normal(0, 0.06 * size, (4, 2)) + center
    view = cv2.getPerspectiveTransform(np.float32([[0, 0], [n, 0], [n, n], [0, n]]), np.float32(corners))
    laid = cv2.warpPerspective(np.float32(sheet), view, (width, height), flags=cv2.INTER_AREA, borderMode=cv2.BORDER_CONSTANT, borderValue=(1, 1, 1))
    return cv2.GaussianBlur(laid, (0, 0), rng.uniform(0.4, 1.0))


def reduced(picture, size=SIZE):
    """At most `size` pixels on its longer side."""
    scale = min(1, size / max(picture.shape[:2]))
    sides = [max(8, round(n * scale)) for n in picture.shape[1::-1]]
    return cv2.resize(picture, sides, interpolation=cv2.INTER_AREA) if scale < 1 else picture


def case(kind, picture, ratio, usable=True):
    """The Case of a ratio, or None if too few pixels are usable or hardly anything was added."""
    after = srgb(linear(picture) * ratio)
    usable = usable & (picture.max(2) < 250) & (picture.min(2) > 12) & (after.min(2) > 8) & (after.max(2) < 250)
    logs = np.log(ratio).mean(2)
    if usable.mean() <= MIN_USABLE or logs[usable].std() <= MIN_SPREAD:
        return None
    return Case(kind, picture, after, logs, usable)


def on_photographs(folder, count):
    """Cases of `light` and `paint` on `count` pictures, evenly from a folder's."""
    files = sorted(f for f in pathlib.Path(folder).rglob("*") if f.suffix.lower() in (".jpg", ".jpeg", ".png"))
    for n, file in enumerate(files[:: max(1, len(files) // count)][:count]):
        picture = cv2.imread(str(file))
        if picture is None:
            continue
        picture = reduced(picture)
        rng = np.random.default_rng([7, n])
        for kind, make in (("light", light), ("paint", paint)):
            found = case(kind, picture, make(rng, *picture.shape[:2]))
            if found:
                yield found


def with_depth(folder, lamps):
    """Cases of a lamp's light and of paint, `lamps` of each on every picture of a folder: NAME.jpg, NAME.png (depth in millimeters), and
    cameras.json there or above (K of each name: fx, fy, cx, cy in pixels)."""
    folder = pathlib.Path(folder)
    cameras = json.loads(next(p for p in (folder / "cameras.json", folder.parent / "cameras.json") if p.exists()).read_text())
    cameras = {name.split("/")[-1]: camera["K"] for name, camera in cameras.items()}
    for n, file in enumerate(sorted(folder.glob("*.jpg"))):
        whole = cv2.imread(str(file))
        picture = reduced(whole)
        height, width = picture.shape[:2]
        depth = cv2.imread(str(file.with_suffix(".png")), -1).astype(np.float32) / 1000
        depth = cv2.resize(depth, (width, height), interpolation=cv2.INTER_NEAREST)
        camera = [v * min(1, SIZE / max(whole.shape[:2])) for v in cameras[file.stem]]
        for k in range(lamps):
            rng = np.random.default_rng([19, n, k])
            ratio, known = lamp.ratio(depth, camera, rng)
            for found in (case("light", picture, ratio[..., ::-1], known), case("paint", picture, paint(rng, height, width))):
                if found:
                    yield found
