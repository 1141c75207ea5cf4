#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What lines of the picture's light (kernels/material/layers/guided_*.comp) are worth to the layers: edges.py [--checkpoint models/lime].
Prints Markdown.

Mask and specular layer, found at 128 × 128 points, in pictures of 512 × 512 against the true ones: between points bilinearly,
and by lines of what the pixel shows. The mask: mean absolute difference of the object's share, over six pixels to both sides of
the outline. The specular layer, found with the true mask: mean square in linear light, clipped at white, inside that mask; edges
are where the true layer's second differences exceed 0.02 of white, and two pixels around. `true`: of the true layers' means.
--stops -3: of pictures that are darker by as much; errors are those of the layers brightened again.
"""
import argparse
import pathlib

import cv2
import numpy as np
import torch
from torch.nn import functional

from lime import corpus, datasets, encoding
from lime.networks import INPUT, load_checkpoint

TIMES = 4               # pixels along a point
REACH, NOISE, DARKEST = 2, 1e-3, 0.02  # of the guided_* kernels
HIGHLIGHT_EDGE, BAND = 0.02, 13


def larger(planes):
    """Between points: … × h × w."""
    flat = [cv2.resize(p, None, fx=TIMES, fy=TIMES, interpolation=cv2.INTER_LINEAR) for p in planes.reshape(-1, *planes.shape[-2:])]
    return np.stack(flat).reshape(*planes.shape[:-2], *flat[0].shape)


def fit(guide, value, counts, specular):
    """Slopes (as many as guide has planes) and offset around each point, as the guided_* kernels find them."""
    def mean(plane):
        def around(x):
            return cv2.boxFilter(x, -1, (2 * REACH + 1,) * 2, normalize=False, borderType=cv2.BORDER_CONSTANT)

        return around(plane * counts) / np.maximum(around(counts), 1)

    means, mean_value = np.stack([mean(g) for g in guide]), mean(value)
    along = np.stack([mean(g * value) - m * mean_value for g, m in zip(guide, means)], -1)
    spread = np.stack([np.stack([mean(a * b) - m * n for b, n in zip(guide, means)], -1) for a, m in zip(guide, means)], -1)
    noise = NOISE * (np.maximum(means[0], DARKEST) if specular else np.ones_like(value))
    slopes = np.linalg.solve(spread + noise[..., None, None] * np.eye(len(guide), dtype=np.float32), along[..., None])[..., 0]
    slopes = slopes.transpose(2, 0, 1)
    if specular:
        slopes = slopes.clip(0, 1)
    return np.stack([mean(s) for s in slopes]), mean(mean_value - (slopes * means).sum(0))


def along(small_guide, guide, value, counts, specular):
    slopes, offset = fit(small_guide, value, counts, specular)
    return (larger(slopes) * guide).sum(0) + larger(offset)


def share(probability):
    """The mask of layers.comp."""
    t = np.clip((probability - 0.25) / 0.5, 0, 1)
    return t * t * (3 - 2 * t)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--checkpoint", type=pathlib.Path, default=corpus.ROOT / "models/lime")
    parser.add_argument("--hdri", default=None)
    parser.add_argument("--count", type=int, default=64, help="held-out samples, by eights")
    parser.add_argument("--stops", type=float, default=0, help="exposure")
    args = parser.parse_args()
    networks, samples = load_checkpoint(args.checkpoint), corpus.Corpus(args.hdri)
    errors = {}

    def note(source, way, where, value):
        errors.setdefault((source, way), {}).setdefault(where, []).append(value)

    for first in range(0, args.count, 8):
        rendered = samples.render(datasets.CHOICES, first, 8, TIMES * INPUT, corpus.TEST)
        batch, exposure = corpus.Batch(rendered), 2 ** args.stops
        if args.stops:
            codes = encoding.to_srgb(encoding.to_linear(batch.image) * exposure)
            batch.image, batch.layer = (codes * 255).round() / 255, batch.layer.clamp(max=1) * exposure
        coverage = torch.from_numpy(rendered["coverage"]).float() / 255
        small = encoding.to_srgb(functional.avg_pool2d(encoding.to_linear(batch.image), TIMES))
        masks = (functional.avg_pool2d(batch.mask, TIMES) > 0.5).float()
        with torch.no_grad():
            found, codes = networks.find_mask(small), networks.find_specular(small, masks)
        light, points = encoding.to_linear(batch.image).numpy(), encoding.to_linear(small).numpy()
        for n in range(8):
            truth, inside = coverage[n, 0].numpy(), batch.mask[n, 0].numpy() > 0.5
            band = cv2.dilate(((truth > 0.02) & (truth < 0.98)).astype(np.uint8), np.ones((BAND, BAND))) > 0
            for source, mask in (("networks", found[n]), ("true", functional.avg_pool2d(coverage[n], TIMES))):
                mask = mask[0].numpy()
                guided = along(np.sqrt(points[n]), np.sqrt(light[n]), mask, np.ones_like(mask), False)
                for way, shown in (("bilinear", larger(mask)), ("lines", guided)):
                    note(source, way, "outline", np.abs(share(shown) - truth)[band].mean())
            truth, mask = batch.layer[n, 0].clamp(max=1).numpy(), masks[n, 0].numpy()
            edge = cv2.dilate((np.abs(cv2.Laplacian(truth, cv2.CV_32F)) > HIGHLIGHT_EDGE * exposure).astype(np.uint8), np.ones((5, 5))) > 0
            means = functional.avg_pool2d(torch.from_numpy(truth)[None], TIMES)
            least, guide = light[n].min(0), points[n].min(0) * mask
            for source, code in (("networks", codes[n, 0]), ("true", encoding.encode(means)[0])):
                layer = np.minimum(encoding.decode(code).numpy(), guide)
                between = encoding.decode(torch.from_numpy(larger(code.numpy()))).numpy()
                for way, shown in (("bilinear", between), ("lines", along(guide[None], least[None], layer, mask, True))):
                    square = ((shown.clip(0, least) - truth) / exposure) ** 2
                    for where, of in (("all", inside), ("edges", inside & edge)):
                        if of.any():
                            note(source, way, where, square[of].mean())
    print(f"| {args.count} samples | mask at its outline | specular layer | at edges of highlights |\n|---|---|---|---|")
    for (source, way), of in errors.items():
        print(f"| {source}, {way} | {np.mean(of['outline']):.4f} | {np.mean(of['all']):.5f} | {np.mean(of['edges']):.5f} |")


main()
