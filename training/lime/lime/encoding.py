# SPDX-License-Identifier: LGPL-2.1-or-later
"""What numbers the networks see, and back.

Colors go in as a camera gives them: sRGB, 8 bit, divided by 255. The specular layer and the mirror image are linear and of
high dynamic range (a lamp's reflection is 100 times as bright as white paper), so that networks read and write their code
ln(1 + 4 x) / 2: 0 for 0, 0.80 for white, 2.2 for 20.
"""
import math

import torch

BINS = 8
EDGES = [2 ** (1 + 9 * b / BINS) for b in range(BINS + 1)]  # of the shininess, 2 … 1024
CENTERS = [math.sqrt(a * b) for a, b in zip(EDGES, EDGES[1:])]


def encode(linear):
    """Code of linear values ≥ 0."""
    return torch.log1p(4 * linear) / 2


def decode(code):
    """Linear values of codes; negative codes count as 0, and those beyond any light (10) as 10, so that a loss stays finite."""
    return torch.expm1(2 * code.clamp(0, 10)) / 4


def to_linear(srgb):
    """Linear light of sRGB values in 0 … 1."""
    return torch.where(srgb <= 0.04045, srgb / 12.92, ((srgb.clamp(min=0) + 0.055) / 1.055) ** 2.4)


def to_srgb(linear):
    """sRGB in 0 … 1 of linear values, clipped."""
    x = linear.clamp(0, 1)
    return torch.where(x <= 0.0031308, 12.92 * x, 1.055 * x.clamp(min=1e-8) ** (1 / 2.4) - 0.055)


def bin_of(shininess):
    """Index of the bin of shininess values (a tensor), outliers in the outer bins."""
    return ((torch.log2(shininess) - 1) * BINS / 9).floor().clamp(0, BINS - 1).long()


def choose_bin(probabilities):
    """The bin to name, of n × 8 probabilities: largest expected score, where the right bin counts 1 and the next ones 1/5.

    A little of the neighbors' weight settles draws between bins that lie next to each other against a lone one."""
    wide = torch.nn.functional.pad(probabilities, (1, 1))
    return (probabilities + (wide[:, :-2] + wide[:, 2:]) / 5).argmax(1)


def lobe_gain(shininess):
    """m_s / alpha: keeps sharp lobes visible, (s + 8) / 16 for s > 8, else 1."""
    return torch.where(shininess > 8, (shininess + 8) / 16, torch.ones_like(shininess))
