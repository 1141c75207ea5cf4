# SPDX-License-Identifier: LGPL-2.1-or-later
"""Light and paint to add to a photograph: ln ratios of linear light (height x width x 3, RGB). `flat`: a flat.Flat of the picture's size, which draws
shapes, prints and shadows."""
import math

import cv2
import numpy as np

import flat
import mix

LOWEST, HIGHEST = 0.03, 8.0  # factors of paint
COLORED = 1.6  # largest by least channel
WHITE = 0.92  # largest of what is painted
BRIGHTER = 0.5  # share of paint that is made as bright as the picture's exposure allows; the rest is mostly darker than what is under it
LIKE = (14, 8, 8)  # CIELab distances of a region of one color


def shadow(sheet):
    """What gets past things outside of the picture, falling on a fill of another color; most edges are harder than those of the drawings."""
    draw = sheet.draw
    lit = np.minimum(sheet.shadow(), sheet.shadow()) if draw.chance(0.2) else sheet.shadow()
    if draw.chance(0.75):
        gain = math.exp(draw.uniform(0, math.log(30)))
        lit = cv2.GaussianBlur(np.clip((lit - 0.5) * gain + 0.5, 0, 1).astype(np.float32), (0, 0), 0.6)
    fill = math.exp(draw.uniform(math.log(0.1), math.log(0.6)))
    slope = draw.uniform(-0.15, 0.6) if draw.chance(0.8) else draw.uniform(-1, 0.6)
    return np.log(fill + (1 - fill) * lit), slope


def fall_off(sheet):
    """A near lamp's."""
    draw, (height, width) = sheet.draw, sheet.shape
    y, x = np.mgrid[:height, :width].astype(np.float32)
    place, near = sheet.rng.uniform(-0.3, 1.3, 2) * (width, height), draw.uniform(0.2, 1.2) * width
    distance = ((x - place[0]) ** 2 + (y - place[1]) ** 2) / near**2
    return np.log(draw.uniform(0.05, 0.5) + 1 / (1 + distance)), draw.uniform(-0.6, 0.3)


def form(sheet):
    """Shading of folds, as of cloth and paper."""
    draw = sheet.draw
    normals = sheet.normals(sheet.folds() * draw.uniform(0.3, 1.5))
    light = np.array([*sheet.rng.normal(0, 1, 2), draw.uniform(0.4, 1.6)])
    ambient = draw.uniform(0.1, 0.5)
    return np.log(ambient + (1 - ambient) * np.maximum(normals @ (light / np.linalg.norm(light)), 0)), draw.uniform(0, 0.4)


def light(sheet):
    """Of one or two of the above; their color follows their brightness by a slope (mix.py)."""
    made = sheet.draw.pick([(shadow,), (fall_off,), (form,), (shadow, fall_off)], [6, 1.5, 2, 1.5])
    ratio = sum(logs[..., None] * (1 + slope * mix.AXIS) for logs, slope in (make(sheet) for make in made))
    return (ratio - np.percentile(ratio.mean(-1), 98)).astype(np.float32)


def brightest(picture):
    return max(float(np.percentile(picture.max(-1), 97)), 0.02)


def recolored(sheet, picture):
    """The region of like color around a point in another paint, or None if it is too small or too large."""
    lab = cv2.GaussianBlur(cv2.cvtColor(mix.srgb(picture).astype(np.float32), cv2.COLOR_RGB2Lab), (0, 0), 1)
    y, x = (int(sheet.rng.integers(n)) for n in sheet.shape)
    _, parts = cv2.connectedComponents((np.abs(lab - lab[y, x]) < LIKE).all(-1).astype(np.uint8))
    inside = (parts == parts[y, x]).astype(np.float32)
    if not 0.01 < inside.mean() < 0.6:
        return None
    color = np.asarray(sheet.draw.color(), np.float32)
    if sheet.draw.chance(BRIGHTER):
        if color.max() < COLORED * color.min():
            return None  # brighter, of the same color: a lit thing
        before = brightest(picture[inside > 0])
        color = color / color.max() * sheet.draw.uniform(0.5, 1) * min(WHITE / before, HIGHEST)
    else:
        color = color / 0.5
    step = np.log(np.clip(color, LOWEST, HIGHEST))
    return cv2.GaussianBlur(inside, (0, 0), 0.7)[..., None] * step


def detail(picture, size):
    """ln of what a picture has that is smaller than some pixels."""
    logs = np.log(np.maximum(picture, 0.004)).astype(np.float32)
    return logs - cv2.GaussianBlur(logs, (0, 0), size)


def piece(sheet, picture):
    """A print, a pattern, plain paint, a texture, a picture, or the dark of a print alone; None if it is outside of the picture.
    Some of it hides the detail under it. Plain paint hides it or has a color: gray that multiplies looks like a shadow to anyone."""
    draw, outline, quad = sheet.draw, sheet.outline(), sheet.quad()
    alpha = sheet.warp(outline, sheet.homography(outline.shape, quad))
    kind = draw.pick(["print", "pattern", "plain", "texture", "art", "ink"], [3, 3, 2, 1.5, 1, 3])
    covers = draw.chance(0.4)
    if kind == "ink":
        paint = sheet.printed()
        paint = paint / max(float(np.percentile(paint, 95)), 0.05)
    elif kind == "plain":
        color = np.asarray(draw.color(), np.float32)
        covers = covers or color.max() < COLORED * color.min()
        paint = np.ones((8, 8, 3), np.float32) * color / 0.6
    else:
        paint = {"print": sheet.printed, "pattern": sheet.pattern, "texture": sheet.texture, "art": sheet.art}[kind]() / draw.uniform(0.5, 0.9)
    laid = sheet.warp(paint, sheet.homography(paint.shape[:2], quad), fill=True)
    inside = alpha > 0.5
    if not inside.any():
        return None
    after = brightest((picture * laid)[inside])
    laid = laid * (WHITE * draw.uniform(0.5, 1) / after if draw.chance(BRIGHTER) else 1 / max(1, after / WHITE))
    ratio = np.log(np.clip(laid, LOWEST, HIGHEST))
    return alpha[..., None] * (ratio - detail(picture, draw.uniform(3, 20)) if covers else ratio)


def paint(sheet, picture):
    """One to four pieces of paint on a linear picture."""
    ratio = np.zeros((*sheet.shape, 3), np.float32)
    for _ in range(int(sheet.rng.integers(1, 5))):
        more = (recolored if sheet.draw.chance(0.25) else piece)(sheet, picture)
        if more is not None:
            ratio = ratio + more
    return cv2.GaussianBlur(ratio.astype(np.float32), (0, 0), sheet.draw.uniform(0.3, 1.0))


def sheet(seed, assets, width, height):
    return flat.Flat(seed, assets, width, height)
