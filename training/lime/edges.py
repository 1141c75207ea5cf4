#!/usr/bin/env python3
"""What the lines of the specular layer (kernels/material/guided_*.comp) are worth: edges.py [--checkpoint models/lime]. Prints
Markdown.

The layer that SpecularNet finds at 128 × 128 points, in pictures of 512 × 512, against the true one: between points by
bilinear codes, and by lines of the pixel's least channel. Linear light, clipped at white, inside the true mask; edges are
where the true layer's second differences exceed 0.02 of white, and two pixels around. `true`: of the true layer's means.
"""
import argparse
import pathlib

import cv2
import numpy as np
import torch
from torch.nn import functional

from lime import corpus, encoding
from lime.networks import SIZES, load_checkpoint

TIMES = 4                # pixels along a point
REACH, NOISE = 2, 1e-3   # of guided_lines.comp
EDGE = 0.02


def larger(plane):
    return cv2.resize(plane, None, fx=TIMES, fy=TIMES, interpolation=cv2.INTER_LINEAR)


def lines(guide, layer, mask):
    """Slope and offset around each point, as guided_lines.comp and guided_mean.comp find them."""
    def mean(plane):
        def around(x):
            return cv2.boxFilter(x, -1, (2 * REACH + 1,) * 2, normalize=False, borderType=cv2.BORDER_CONSTANT)

        return around(plane * mask) / np.maximum(around(mask), 1)

    layer = np.minimum(layer, guide)
    mean_guide, mean_layer = mean(guide), mean(layer)
    variance = mean(guide * guide) - mean_guide ** 2
    slope = np.clip((mean(guide * layer) - mean_guide * mean_layer) / (variance.clip(0) + NOISE), 0, 1)
    return mean(slope), mean(mean_layer - slope * mean_guide)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--checkpoint", type=pathlib.Path, default=corpus.ROOT / "models/lime")
    parser.add_argument("--hdri", default=None)
    parser.add_argument("--count", type=int, default=64, help="held-out samples")
    args = parser.parse_args()
    networks, samples = load_checkpoint(args.checkpoint), corpus.Corpus(args.hdri)
    errors = {}
    for first in range(0, args.count, 8):
        batch = corpus.Batch(samples.render(1, first, 8, TIMES * SIZES["standard"]["input"], corpus.TEST))
        small = functional.avg_pool2d(batch.image, TIMES)
        masks = (functional.avg_pool2d(batch.mask, TIMES) > 0.5).float()
        with torch.no_grad():
            codes = networks.find_specular(small, masks)
        least = encoding.to_linear(batch.image).amin(1).numpy()
        guides = encoding.to_linear(small).amin(1).numpy() * masks[:, 0].numpy()
        for n in range(8):
            inside, truth = batch.mask[n, 0].numpy() > 0.5, batch.layer[n, 0].clamp(max=1).numpy()
            edge = cv2.dilate((np.abs(cv2.Laplacian(truth, cv2.CV_32F)) > EDGE).astype(np.uint8), np.ones((5, 5))) > 0
            means = functional.avg_pool2d(torch.from_numpy(truth)[None], TIMES)[0].numpy()
            for source, code in (("networks", codes[n, 0]), ("true", encoding.encode(torch.from_numpy(means)))):
                slope, offset = lines(guides[n], encoding.decode(code).numpy(), masks[n, 0].numpy())
                for way, layer in (("bilinear", encoding.decode(torch.from_numpy(larger(code.numpy()))).numpy()),
                                   ("lines", larger(slope) * least[n] + larger(offset))):
                    square = (layer.clip(0, least[n]) - truth) ** 2
                    for where, of in (("all", inside), ("edges", inside & edge)):
                        if of.any():
                            errors.setdefault((source, way), {}).setdefault(where, []).append(square[of].mean())
    print(f"| MSE, {args.count} samples | all of the object | edges of highlights |\n|---|---|---|")
    for (source, way), found in errors.items():
        print(f"| {source}, {way} | {np.mean(found['all']):.5f} | {np.mean(found['edges']):.5f} |")


main()
