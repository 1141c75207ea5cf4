# SPDX-License-Identifier: LGPL-2.1-or-later
"""Errors of predicted OLAT images, and predictions."""
import numpy as np
import torch
from torch.nn import functional

from . import corpus, encoding, samples

WEIGHTS = (0.0448, 0.2856, 0.3001, 0.2363)  # of the first four scales of Wang et al. (2003), made to add up to 1


def to_srgb(x):
    x = x.clamp(0, 1)
    return torch.where(x <= 0.0031308, 12.92 * x, 1.055 * x.clamp(min=1e-8) ** (1 / 2.4) - 0.055)


def window():
    x = torch.arange(11) - 5.0
    g = torch.exp(-x * x / (2 * 1.5 ** 2))
    return g / g.sum()


def blur(x):
    """Gaussian of σ 1.5, 11 × 11, borders repeated; n × 1 × h × w."""
    g = window()
    x = functional.conv2d(functional.pad(x, (5, 5, 0, 0), mode="replicate"), g.view(1, 1, 1, 11))
    return functional.conv2d(functional.pad(x, (0, 0, 5, 5), mode="replicate"), g.view(1, 1, 11, 1))


def ms_ssim(x, y, mask):
    """Multi-scale structural similarity of gray pictures in 0 … 1, n × h × w, averaged over the mask (h × w): n numbers."""
    x, y, mask = x[:, None], y[:, None], mask[None, None]
    total, product = sum(WEIGHTS), 1
    for scale, weight in enumerate(WEIGHTS):
        mx, my = blur(x), blur(y)
        vx, vy, c = blur(x * x) - mx * mx, blur(y * y) - my * my, blur(x * y) - mx * my
        contrast = (2 * c + 0.03 ** 2) / (vx + vy + 0.03 ** 2)
        if scale == len(WEIGHTS) - 1:
            contrast = contrast * (2 * mx * my + 0.01 ** 2) / (mx * mx + my * my + 0.01 ** 2)
        mean = (contrast * mask).sum((1, 2, 3)) / mask.sum()
        product = product * mean.clamp(min=0) ** (weight / total)
        x, y, mask = (functional.avg_pool2d(i, 2) for i in (x, y, mask))
    return product


@torch.no_grad()
def predict(net, item, lights=12):
    """P̂ of all lights of an item, n × 3 × h × w. net: a network on gradients, or on three OLATs ('olats')."""
    height, width = item.alpha.shape
    assert height % 32 == 0 and width % 32 == 0, "sides are multiples of 32"
    directions = torch.from_numpy(item.directions)
    if net == "cosine-lobe":
        return encoding.cosine_lobe(torch.from_numpy(item.a), torch.from_numpy(item.b), directions).numpy()
    inputs, net = net
    if inputs == "gradients":
        x = encoding.inputs_of(torch.from_numpy(item.a)[None], torch.from_numpy(item.b)[None])
    else:
        wide = corpus.wide_baseline(item.directions)
        x = samples.inputs_of_olats(torch.from_numpy(item.olats[wide])[None])
    if hasattr(net, "features"):
        features = net.features(x)
        parts = [net.relight(x, features, d[None]) for d in directions.split(lights)]
    else:
        parts = [net(x, d[None]) for d in directions.split(lights)]
    return encoding.decode(torch.cat(parts, 1)[0]).numpy()


def score(item, predicted):
    """l1: mean absolute error of what is shown, in linear light, clipped at white, in code values of 255; l1_srgb: the same of
    sRGB; ms_ssim: of sRGB luminance; relit: l1 of pictures under environments, in per cent of their mean. All over the subject
    and all lights."""
    gain, mask = item.gain, torch.from_numpy((item.alpha > 0.5).astype(np.float32))
    shown, truth = (torch.from_numpy(np.ascontiguousarray(p * gain)).clamp(0, 1) for p in (predicted, item.olats))
    inside = 3 * float(mask.sum())
    out = {"l1": 255 * float(((shown - truth).abs() * mask).sum((1, 2, 3)).mean()) / inside}
    shown, truth = to_srgb(shown), to_srgb(truth)
    out["l1_srgb"] = 255 * float(((shown - truth).abs() * mask).sum((1, 2, 3)).mean()) / inside
    luma = torch.tensor([0.2126, 0.7152, 0.0722]).view(1, 3, 1, 1)
    out["ms_ssim"] = float(ms_ssim((shown * luma).sum(1), (truth * luma).sum(1), mask).mean())
    weights = environments(item.directions)
    relit, true = (np.einsum("en,nchw->echw", weights, p) for p in (predicted, item.olats))
    inside = item.alpha > 0.5
    out["relit"] = 100 * float(np.mean([np.abs(r - t)[:, inside].mean() / t[:, inside].mean() for r, t in zip(relit, true)]))
    return out


def environments(directions, count=24, seed=5):
    """Weights of the lights under random environments: a sky and a few lamps each, of widths from 10° to 60°."""
    random = np.random.default_rng(seed)
    out = []
    for _ in range(count):
        w = np.full(len(directions), 0.15)
        for _ in range(int(random.integers(1, 5))):
            center = random.standard_normal(3)
            center /= np.linalg.norm(center)
            sharp = 1 / (1 - np.cos(np.radians(random.uniform(10, 60))))
            w += random.uniform(0.3, 1) * sharp * np.exp(sharp * (directions @ center - 1))
        out.append(w / w.sum())
    return np.stack(out)
