#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sanity of the corpus and the networks, in seconds: check.py. Prints what it measured, and stops at what is off."""
import argparse
import time

import numpy as np
import torch

from lime import corpus, encoding
from lime.networks import Networks, count_flops, warm_start
import descent

FLOP_BUDGET = 1.5e9  # of all five networks at 128 × 128


def sphere(count, seed=0):
    v = np.random.RandomState(seed).randn(count, 3)
    return (v / np.linalg.norm(v, axis=1, keepdims=True)).astype(np.float32)


def expect(ok, text):
    print(("ok    " if ok else "WRONG ") + text)
    if not ok:
        raise SystemExit(1)


def check_constant_light(samples):
    """Under constant radiance E, D = π E for every normal, and S has a closed form where the view is along the normal."""
    env = np.full((48, 96, 3), 0.7, np.float32)
    n = sphere(200)
    d, _ = samples.shade(env, n, n, 10)
    error = np.abs(d / (0.7 * np.pi) - 1).max()
    expect(error < 5e-3, f"D under constant light: off by {error:.1e} of π E")
    for s in (2, 30, 300):
        # w·n > 0 is then h·n > √½: ∫ cos^s θ · 4 cos θ sin θ dθ dφ over θ < 45°
        closed = 8 * np.pi / (s + 2) * (1 - 0.5 ** ((s + 2) / 2))
        _, got = samples.shade(env, n, n, s)
        error = np.abs(got / (0.7 * closed) - 1).max()
        expect(error < 2e-2, f"S under constant light, s = {s}: off by {error:.1e} of the closed form")


def check_integration(samples):
    """Against Eq. 6.3 summed in double precision; and what leaving tiles out costs."""
    rng = np.random.RandomState(3)
    rows = 24
    env = np.exp(1.5 * rng.randn(rows, 2 * rows, 3)).astype(np.float32)
    theta = (np.arange(rows) + 0.5) / rows * np.pi
    phi = ((np.arange(2 * rows) + 0.5) / (2 * rows) - 0.5) * 2 * np.pi
    t, p = np.meshgrid(theta, phi, indexing="ij")
    w = np.stack([np.sin(t) * np.sin(p), np.cos(t), np.sin(t) * np.cos(p)], -1).reshape(-1, 3)
    e = (env * (np.sin(t) * (np.pi / rows) ** 2)[..., None]).reshape(-1, 3).astype(float)
    n, o = sphere(100, 1), sphere(100, 2)
    o = np.where((n * o).sum(1, keepdims=True) < 0, -o, o)
    wn = n.astype(float) @ w.T
    h = w[None] + o[:, None].astype(float)
    hn = np.clip((h * n[:, None]).sum(2) / np.maximum(np.linalg.norm(h, axis=2), 1e-9), 1e-6, 1)
    for s in (2.5, 40., 900.):
        true_d, true_s = np.maximum(wn, 0) @ e, (hn ** s * (wn > 0)) @ e
        d, got = samples.shade(env, n, o, s, every=True)
        _, culled = samples.shade(env, n, o, s)
        error_d, error_s = np.abs(d / true_d - 1).max(), np.abs(got - true_s).max() / true_s.max()
        error_c = np.abs(culled - true_s).max() / true_s.max()
        expect(max(error_d, error_s) < 1e-3, f"s = {s}: D within {error_d:.1e}, S within {error_s:.1e} of a sum in double")
        expect(error_c < 5e-3, f"s = {s}: with tiles left out S within {error_c:.1e}")


def check_samples(samples):
    count = 48
    started = time.monotonic()
    flags = corpus.CLEAN | corpus.TAUGHT
    a = samples.render(7, 100, count, flags=flags, threads=2)
    seconds = time.monotonic() - started
    print(f"      {count / seconds:.0f} samples/s on two threads")
    b = samples.render(7, 100 + count - 8, 8, flags=flags, threads=1)
    expect(all(np.array_equal(a[k][-8:], b[k]) for k in a), "sample i of seed k is the same in any batch, on any threads")
    p = dict(zip(corpus.FIELDS, a["parameters"].T[:, :, None, None, None]))
    md = np.concatenate([p["diffuse_" + c] for c in "rgb"], 1)
    rendered = p["ambient"] + md * a["diffuse"] + p["specular"] * a["specular"]
    inside = (a["coverage"] == 255) & np.ones((1, 3, 1, 1), bool)
    shown = encoding.to_srgb(torch.from_numpy(rendered)).numpy() * 255
    error = np.abs(shown - a["image"])[inside].max()
    expect(error < 1.1, f"I = ma + md D + ms S inside the mask, within {error:.2f} of 255")
    outside = a["coverage"] == 0
    expect(all(np.abs(a[k] * outside).max() == 0 for k in ("diffuse", "specular", "mirror")), "D, S and M are zero outside")
    expect(all(np.isfinite(v).all() for v in a.values()), "all values are finite")
    share = (a["coverage"] >= 128).mean((1, 2, 3))
    expect(share.min() > 0.003, f"objects cover {share.min():.1%} … {share.max():.1%} of the picture")
    s, bins = p["shininess"].ravel(), p["bin"].ravel()
    expect(np.array_equal(encoding.bin_of(torch.from_numpy(s)).numpy(), bins), "bins fit their shininess")


def check_splits(samples):
    train, test = (samples.render(1, 0, 64, 16, flag) for flag in (0, corpus.TEST))
    held = [[samples.is_held_out_shape(*row[-4:-2]) for row in a["parameters"]] for a in (train, test)]
    expect(not any(held[0]) and all(held[1]), "training shapes are never held out, test shapes always")
    names = [set(samples.maps(h)) for h in (False, True)]
    expect(not names[0] & names[1], f"{len(names[0])} maps for training, {len(names[1])} for tests, none in both")
    used = [set(a["parameters"][:, corpus.FIELDS.index("map")].astype(int)) - {-1} for a in (train, test)]
    expect(not used[0] & used[1], "no map was used in both")


def check_networks():
    networks = Networks()
    total = 0
    for name, (network, shape) in networks.parts().items():
        flops, weights = count_flops(network, shape), sum(p.numel() for p in network.parameters())
        total += flops
        print(f"      {name:13} {flops / 1e9:6.3f} GFLOP  {weights / 1e3:7.0f} k weights")
    expect(total <= FLOP_BUDGET, f"five networks: {total / 1e9:.3f} GFLOP at 128 × 128")
    picture, network = torch.rand(4, 4, 128, 128), networks.specular
    for _ in range(3):  # normalization measures something
        network(picture)
    expected = network.eval()(picture)
    error = (warm_start.settle(network)(picture) - expected).abs().max() / expected.abs().max()
    expect(error < 1e-4, f"settled networks give the same, within {error:.1e}")
    for shape in ((24, 108), (80, 40)):
        values = torch.linalg.svdvals(descent.Muon.orthogonal(torch.randn(shape)))
        expect(0.5 < values.min() and values.max() < 1.5, f"Muon goes {values.min():.2f} … {values.max():.2f} far in all directions")
    x = torch.rand(50) * 30
    error = (encoding.decode(encoding.encode(x)) - x).abs().max()
    expect(error < 1e-4, "codes decode to what was encoded")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hdri", default=None, help="folder of environment maps; '' for rooms only")
    samples = corpus.Corpus(parser.parse_args().hdri)
    check_constant_light(samples)
    check_integration(samples)
    check_samples(samples)
    check_splits(samples)
    check_networks()


main()
