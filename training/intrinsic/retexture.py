# SPDX-License-Identifier: LGPL-2.1-or-later
"""A path-traced sample with other paint: its surfaces are cut at edges of its geometry, and get patterns, prints, photographed textures or plain
paint, laid on in world coordinates, under the light that was rendered. Bounces keep the colors of the old paint."""
import cv2
import numpy as np

import flat

STEP_N, STEP_Z = 0.25, 0.02  # between neighbors of one surface: of normals, of depth relative to depth
SMALLEST = 12  # pixels of a surface that is painted


def positions(sample):
    """World coordinates of every pixel, height × width × 3."""
    z, meta = np.minimum(sample["Z"], 1e3), sample["meta"]
    h, w = z.shape
    focal = meta["lens_mm"] / 36 * max(h, w)
    y, x = np.mgrid[:h, :w] + 0.5
    rays = np.stack([(x - w / 2) / focal, (h / 2 - y) / focal, -np.ones_like(x)], -1)
    camera = np.array(meta["camera"])
    return (rays * z[..., None]) @ camera[:3, :3].T + camera[:3, 3]


def surfaces(sample):
    """A number for each pixel: 0 at edges of geometry and where there is no surface, otherwise its surface's."""
    n, z = sample["N"], np.maximum(sample["Z"], 1e-3)
    even = sample["mask"] > 0
    for axis in (0, 1):
        step = (np.abs(np.diff(n, axis=axis)).sum(-1) > STEP_N) | (np.abs(np.diff(np.log(z), axis=axis)) > STEP_Z)
        first, second = ((slice(None, -1), slice(1, None)) if axis == 0 else ((slice(None), slice(None, -1)), (slice(None), slice(1, None))))
        even[first] &= ~step
        even[second] &= ~step
    return cv2.connectedComponents(even.astype(np.uint8), connectivity=4)[1]


def lay(draw, paint, points, normal):
    """Colors of the paint at points (… × 3) of a surface, repeated."""
    axis = int(np.argmax(np.abs(normal)))
    u, v = (points[..., k] for k in range(3) if k != axis)
    reach = max(float(np.ptp(np.percentile(u, [2, 98]))), float(np.ptp(np.percentile(v, [2, 98]))), 1e-3)
    times, turn = draw.pick([0.5, 1, 2, 4]) * draw.uniform(0.7, 1.4), draw.pick([0, 0, draw.uniform(0, 3.14)])
    u, v = (u * np.cos(turn) + v * np.sin(turn)) / reach, (v * np.cos(turn) - u * np.sin(turn)) / reach
    h, w = paint.shape[:2]
    scale = times * np.array([w / max(h, w), h / max(h, w)])  # keeps the picture's proportions
    i = ((v + draw.rng.random()) * times / scale[1] % 1 * h).astype(np.float32)
    j = ((u + draw.rng.random()) * times / scale[0] % 1 * w).astype(np.float32)
    return cv2.remap(np.ascontiguousarray(paint, np.float32), j, i, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)


def retexture(sample, rng, assets=None, share=0.6):
    """share: of surfaces that get other paint."""
    maker = flat.Flat(int(rng.integers(2**31)), assets, 8, 8)
    label, where = surfaces(sample), positions(sample)
    paint = sample["R"].copy()
    fresh = np.zeros(label.shape, bool)
    for k in np.argsort(-np.bincount(label.ravel())[1:])[:40] + 1:
        region = label == k
        if region.sum() < SMALLEST or not maker.draw.chance(share):
            continue
        rows, columns = np.flatnonzero(region.any(1)), np.flatnonzero(region.any(0))
        box = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
        picture = maker.paint()
        if min(picture.shape[:2]) > 16:
            shrink = max(picture.shape[:2]) / max(32, 2 * max(len(rows), len(columns)))  # or it would be sampled without its means
            if shrink > 1:
                picture = cv2.resize(picture, None, fx=1 / shrink, fy=1 / shrink, interpolation=cv2.INTER_AREA)
        laid = lay(maker.draw, picture, where[box], sample["N"][region].mean(0))
        inside = region[box]
        paint[box][inside] = laid[inside]
        fresh |= region
    # Edges of geometry lie between surfaces: they take the paint of the nearest pixel that has new one, or keep their own.
    rim = (label == 0) & (sample["mask"] > 0)
    if fresh.any() and rim.any():
        _, nearest = cv2.distanceTransformWithLabels((label == 0).astype(np.uint8), cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL)
        source = np.zeros((nearest.max() + 1, 2), int)
        y, x = np.nonzero(label != 0)
        source[nearest[y, x]] = np.stack([y, x], -1)
        at = source[nearest[rim]]
        take = fresh[at[:, 0], at[:, 1]]
        colors = paint[rim]
        colors[take] = paint[at[take, 0], at[take, 1]]
        paint[rim] = colors
    paint = np.where(sample["mask"][..., None] > 0, np.clip(paint, 0.015, 0.92), 1).astype(np.float32)
    return {**sample, "R": paint}
