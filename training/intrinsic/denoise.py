# SPDX-License-Identifier: LGPL-2.1-or-later
"""Non-local means over two independent renderings, which stops at edges of normal and depth and never looks at reflectance.
Weights for one half come from the other (Rousselle et al. 2012), so noise does not choose its own neighbors. Several scales, fine
to coarse: a window of a few pixels at each removes noise of that size."""
import cv2
import numpy as np


def geometry(normal, depth):
    """What two pixels must share: normals (height × width × 3) and depth along planes (height × width). Returns the function
    that weighs a pair of shifted views."""
    z = np.log(np.clip(depth, 1e-2, 1e4)).astype(np.float32)
    slope = np.maximum(*[np.abs(np.gradient(z, axis=i)) for i in range(2)])
    slope = np.minimum(cv2.erode(slope, np.ones((3, 3))), 0.1)  # steps of depth are not slopes

    def weight(here, there, distance):
        d = ((normal[here] - normal[there]) ** 2).sum(-1) / (2 * 0.2**2)
        allowed = 0.01 + 1.5 * distance * slope[here]
        return np.exp(-np.maximum(d, ((z[here] - z[there]) / allowed) ** 2))

    return weight


def shifted(shape, dy, dx):
    """Slices of the pixels that have a neighbor at this offset, and of these neighbors."""
    h, w = shape
    here = np.s_[max(0, -dy) : h - max(0, dy), max(0, -dx) : w - max(0, dx)]
    there = np.s_[max(0, dy) : h - max(0, -dy), max(0, dx) : w - max(0, -dx)]
    return here, there


def despeckle(halves):
    """Limits what is bright in one half alone. For halves with little noise: with much, it would darken them."""
    medians = [np.stack([cv2.medianBlur(np.ascontiguousarray(x[..., c]), 3) for c in range(3)], -1) for x in halves]
    return [np.minimum(x, np.maximum(1.3 * y, 1.6 * m)) for x, y, m in zip(halves, halves[::-1], medians[::-1])]


def smooth(halves, weigh, radius, strength):
    """Both halves (height × width × 3) with less noise, at one scale."""
    shape = halves[0].shape[:2]
    gray = [x.mean(-1) for x in halves]
    variance = cv2.blur((gray[0] - gray[1]) ** 2 / 2, (5, 5))
    variance = np.minimum(variance, cv2.GaussianBlur(variance, (0, 0), 4) * 4)
    floor = (2e-3 * cv2.blur(gray[0] + gray[1], (5, 5))) ** 2 + 1e-10
    sums = [np.zeros_like(x) for x in halves]
    weights = [np.zeros(shape, np.float32) for _ in halves]
    for dy in range(-radius, radius + 1):
        for dx in range(-radius, radius + 1):
            here, there = shifted(shape, dy, dx)
            guide = weigh(here, there, float(np.hypot(dy, dx)))
            v, u = variance[here], variance[there]
            closeness = []
            for g in gray:
                d = ((g[here] - g[there]) ** 2 - (v + np.minimum(v, u))) / (floor[here] + strength**2 * (v + u))
                closeness.append(np.exp(-np.maximum(cv2.blur(d, (3, 3)), 0)))
            for k in range(2):
                w = np.minimum(guide, closeness[1 - k])
                weights[k][here] += w
                sums[k][here] += w[..., None] * halves[k][there]
    return [s / w[..., None] for s, w in zip(sums, weights)]


def half(x):
    return cv2.resize(x, (x.shape[1] // 2, x.shape[0] // 2), interpolation=cv2.INTER_AREA)


def denoise(a, b, normal, depth, scales=3, radius=4, strength=0.7):
    """Mean of two halves a and b (height × width × 3) with less noise."""
    halves = [np.ascontiguousarray(x, np.float32) for x in (a, b)]
    normal, depth = np.ascontiguousarray(normal, np.float32), np.ascontiguousarray(depth, np.float32)
    return sum(despeckle(pyramid(halves, normal, depth, scales, radius, strength))) / 2


def pyramid(halves, normal, depth, scales, radius, strength):
    fine = smooth(halves, geometry(normal, depth), radius, strength)
    if scales <= 1:
        return fine
    coarse = [half(x) for x in fine]
    better = pyramid(coarse, half(normal), half(depth), scales - 1, radius, strength)
    size = fine[0].shape[1::-1]
    return [np.maximum(x + cv2.resize(y - c, size, interpolation=cv2.INTER_LINEAR), 0.3 * x) for x, y, c in zip(fine, better, coarse)]
