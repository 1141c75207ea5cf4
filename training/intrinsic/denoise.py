# SPDX-License-Identifier: LGPL-2.1-or-later
"""Non-local means over two independent renderings, which stops at edges of normal and depth and never looks at reflectance.
Weights for one half come from the other (Rousselle et al. 2012), so noise does not choose its own neighbors. Several scales, fine
to coarse: a window of a few pixels at each removes noise of that size."""
import cv2
import numpy as np


def geometry(normal, depth, radius):
    """What two pixels must share: normals (height × width × 3) and depth along planes (height × width). Returns a list of offsets dy and dx
    with the slices of `shifted` and the weights of these pairs."""
    z = np.log(np.clip(depth, 1e-2, 1e4)).astype(np.float32)
    slope = np.maximum(*[np.abs(np.gradient(z, axis=i)) for i in range(2)])
    slope = np.minimum(cv2.erode(slope, np.ones((3, 3))), 0.1)  # steps of depth are not slopes

    result = []
    for dy in range(-radius, radius + 1):
        for dx in range(-radius, radius + 1):
            here, there = shifted(z.shape, dy, dx)
            d = ((normal[here] - normal[there]) ** 2).sum(-1) / (2 * 0.2**2)
            allowed = 0.01 + 1.5 * np.float32(np.hypot(dy, dx)) * slope[here]
            result.append((here, there, np.exp(-np.maximum(d, ((z[here] - z[there]) / allowed) ** 2))))
    return result


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


def smooth(halves, pairs, strength):
    """Both halves (height × width × 3) with less noise, at one scale; `pairs` is of `geometry`."""
    shape = halves[0].shape[:2]
    gray = [x.mean(-1) for x in halves]
    variance = cv2.blur((gray[0] - gray[1]) ** 2 / 2, (5, 5))
    variance = np.minimum(variance, cv2.GaussianBlur(variance, (0, 0), 4) * 4)
    floor = (2e-3 * cv2.blur(gray[0] + gray[1], (5, 5))) ** 2 + 1e-10
    sums = [np.zeros_like(x) for x in halves]
    weights = [np.zeros(shape, np.float32) for _ in halves]
    for here, there, guide in pairs:
        v, u = variance[here], variance[there]
        both, scale = v + np.minimum(v, u), 1 / (floor[here] + strength**2 * (v + u))
        closeness = []
        for g in gray:
            d = ((g[here] - g[there]) ** 2 - both) * scale
            closeness.append(np.exp(-np.maximum(cv2.blur(d, (3, 3)), 0)))
        for k in range(2):
            w = np.minimum(guide, closeness[1 - k])
            weights[k][here] += w
            sums[k][here] += w[..., None] * halves[k][there]
    return [s / w[..., None] for s, w in zip(sums, weights)]


def half(x):
    return cv2.resize(x, (x.shape[1] // 2, x.shape[0] // 2), interpolation=cv2.INTER_AREA)


class Denoiser:
    """For the lights of one picture, which share normals and depth."""

    def __init__(self, normal, depth, scales=3, radius=4, strength=0.7):
        self.strength, self.pairs = strength, []
        normal, depth = np.ascontiguousarray(normal, np.float32), np.ascontiguousarray(depth, np.float32)
        for _ in range(scales):
            self.pairs.append(geometry(normal, depth, radius))
            normal, depth = half(normal), half(depth)

    def __call__(self, a, b):
        """Mean of two halves a and b (height × width × 3) with less noise."""
        return sum(despeckle(self.pyramid([np.ascontiguousarray(x, np.float32) for x in (a, b)], 0))) / 2

    def pyramid(self, halves, scale):
        fine = smooth(halves, self.pairs[scale], self.strength)
        if scale + 1 == len(self.pairs):
            return fine
        coarse = [half(x) for x in fine]
        better = self.pyramid(coarse, scale + 1)
        size = fine[0].shape[1::-1]
        return [np.maximum(x + cv2.resize(y - c, size, interpolation=cv2.INTER_LINEAR), 0.3 * x) for x, y, c in zip(fine, better, coarse)]


def denoise(a, b, normal, depth, **options):
    """Mean of two halves a and b (height × width × 3) with less noise."""
    return Denoiser(normal, depth, **options)(a, b)
