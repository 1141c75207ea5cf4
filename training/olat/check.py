#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sanity of the renderer, the networks and the exported files: check.py. Prints what it measured, and stops at what is off."""
import argparse
import pathlib

import numpy as np
import torch

import export
from olat import corpus, encoding, losses
from olat.networks import HARMONICS, HIDDEN, SECOND, Late, UNet, count_flops

FLOP_BUDGET, HEAD_BUDGET = 1.6e9, 1.5e3


def expect(ok, text):
    print(("ok    " if ok else "WRONG ") + text)
    if not ok:
        raise SystemExit(1)


def check_stages():
    g = corpus.geodesic()
    expect(len(g) == 331 and len(corpus.geodesic(left_out=0)) == 362, "the geodesic stage has 331 of 362 lights")
    nearest = np.degrees(np.arccos(np.clip(np.sort(g @ g.T, 1)[:, -2], -1, 1)))
    expect(nearest.min() > 8 and nearest.max() < 12.5, f"next lights are {nearest.min():.1f}° to {nearest.max():.1f}° apart")
    mean = np.linalg.norm(corpus.geodesic(left_out=0).mean(0))
    expect(mean < 1e-6, f"whole, it has no preferred direction ({mean:.1e})")


def check_superposition(library):
    """The gradient images are the weighted sums of the OLATs, to float rounding."""
    directions = corpus.fibonacci(40)
    for index, flags in ((0, 0), (1, corpus.BUST)):
        s = library.render(3, index, directions, flags=flags)
        for sign, got in zip((1, -1), s["gradients"]):
            weights = (1 + sign * directions.astype(float)) / 2 / len(directions)
            wanted = np.einsum("nc,nchw->chw", weights, s["olats"].astype(float))
            error = np.abs(got - wanted).max() / wanted.max()
            expect(error < 3e-6, f"superposition, subject {index}: within {error:.1e} of the brightest value")
        whole = library.render(3, index, directions, keep=np.arange(5), flags=flags)
        expect(np.array_equal(whole["olats"], s["olats"][:5]) and np.array_equal(whole["gradients"], s["gradients"]),
               "what is kept changes nothing")


def check_sphere(library):
    """A white Lambertian sphere: OLATs are cos/π, and the cosine lobe finds normals within a degree."""
    directions = corpus.fibonacci(1000)
    s = library.render(1, 0, directions, keep=np.arange(0, 1000, 50), flags=corpus.SPHERE, samples=4)
    inside = s["alpha"] > 0.99
    normals = s["normals"] / np.maximum(np.linalg.norm(s["normals"], axis=0), 1e-6)
    wanted = np.maximum(np.einsum("nk,khw->nhw", directions[::50], normals), 0) / np.pi
    error = np.abs(s["olats"][:, 0] - wanted)[:, inside]
    expect(error.mean() < 2e-3, f"Lambert's law: {error.mean():.1e} on the mean, 1/π is the brightest")
    full = s["gradients"].sum(0)
    away = np.abs(full[0][inside] * 4 * np.pi - 1).max()
    expect(away < 0.02, f"the full-on image is the mean over the sphere, 1/4π, within {away:.1%}")
    m = (s["gradients"][0] - s["gradients"][1]) / np.maximum(full, 1e-9)
    size = np.linalg.norm(m, axis=0)
    angle = np.degrees(np.arccos(np.clip((m / np.maximum(size, 1e-9) * normals).sum(0), -1, 1)))[inside]
    expect(angle.max() < 1, f"cosine lobe: direction within {angle.max():.2f}° (mean {angle.mean():.2f}°)")
    expect(np.abs(size[inside] - 2 / 3).max() < 0.02, f"and |m| = 2/3, p = 1, within {np.abs(size[inside] - 2 / 3).max():.3f}")
    lobe = encoding.cosine_lobe(*torch.from_numpy(s["gradients"]), torch.from_numpy(directions[::50])).numpy()
    error = np.abs(lobe - s["olats"])[:, :, inside].mean()
    expect(error < 5e-3, f"its OLATs: {error:.1e} on the mean")


def check_samples(library):
    g = corpus.geodesic()[::30]
    for flags in (0, corpus.TEST):
        a, b = library.render(7, 4, g, flags=flags), library.render(7, 4, g, flags=flags)
        expect(all(np.array_equal(a[k], b[k]) for k in a), "a sample is the same each time")
        expect(all(np.isfinite(v).all() for v in a.values()) and a["olats"].min() >= 0, "values are finite, none below zero")
        expect(np.abs(a["olats"] * (a["alpha"] == 0)).max() == 0, "nothing shines outside of the subject")
    few = g[:1]
    held = [[library.is_held_out(library.render(1, i, few, flags=f, samples=1)["trait"]) for i in range(20)]
            for f in (0, corpus.TEST)]
    expect(not any(held[0]) and all(held[1]), "training shapes are never held out, test shapes always")


def check_networks():
    flops = count_flops(UNet(6, 4 * HIDDEN), 1, 6, corpus.HEIGHT, corpus.WIDTH)
    expect(flops < FLOP_BUDGET, f"features: {flops / 1e9:.3f} GFLOP at {corpus.WIDTH} × {corpus.HEIGHT}")
    head = 7 * HIDDEN + 2 * HIDDEN * SECOND + 2 * SECOND + 2 * 4 * SECOND + 4 + 12
    expect(head < HEAD_BUDGET, f"head: {head} FLOP a pixel and light")
    net = Late().eval()
    x, directions = torch.rand(1, 6, 64, 64), torch.from_numpy(corpus.fibonacci(3))
    with torch.no_grad():
        features = net.features(x)
        got = net.relight(x, features, directions[None])[0]
        phi = encoding.harmonics(directions)
        for k, d in enumerate(directions):
            hidden = torch.einsum("ukhw,k->uhw", features[0].view(HIDDEN, 4, 64, 64), torch.cat([d, torch.ones(1)])).relu()
            y = net.light(torch.cat([hidden, phi[k].view(HARMONICS, 1, 1).expand(-1, 64, 64)])[None])[0]
            wanted = x[0, :3] * y[:3] + x[0, :3].mean(0) * y[3]
            expect((got[k] - wanted).abs().max() < 1e-5, "light by light as in the batch")


def check_losses():
    random = np.random.default_rng(0)
    truth = torch.rand(2, 3, 3, 48, 48)
    dy, dx = (torch.from_numpy(random.integers(-3, 4, (2, 3))) for _ in range(2))
    off = losses.shift(truth, dy, dx)
    back = losses.align(truth, off, 4)
    inner = (slice(None),) * 3 + (slice(8, 40),) * 2
    expect(bool((back[inner] == truth[inner]).all()), "the alignment loss finds shifts of up to its reach")


def check_models(folder):
    if not (folder / "features.onnx").exists():
        print(f"      {folder} holds no models yet")
        return
    d = corpus.fibonacci(7)
    sphere = np.mgrid[0:128, 0:128].astype(np.float32) / 64 - 1
    z = np.sqrt(np.maximum(1 - (sphere ** 2).sum(0), 0))
    normal = np.stack([sphere[1], -sphere[0], z])
    full = 0.6 * (z > 0).astype(np.float32)
    a, b = (full * (1 + s * 2 / 3 * normal) / 2 for s in (1, -1))
    got = export.relight(folder, a, b, d)
    truth = 4 * full * np.maximum(np.einsum("nk,khw->nhw", d, normal), 0)[:, None]
    error = np.abs(got - truth)[:, :, z > 0.1].mean() / truth[:, :, z > 0.1].mean()
    expect(error < 0.4, f"exported files on a Lambertian sphere: {error:.0%} of its mean off")
    expect(np.abs(got[:, :, z == 0]).max() == 0, "and black where there is nothing")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--heads", default=corpus.HEADS, help="folder of ICT FaceKit; '' for busts only")
    parser.add_argument("--models", type=pathlib.Path, default=corpus.ROOT / "models/olat")
    args = parser.parse_args()
    check_stages()
    library = corpus.Corpus(args.heads)
    check_superposition(library)
    check_sphere(library)
    check_samples(library)
    check_networks()
    check_losses()
    check_models(args.models)


if __name__ == "__main__":
    main()
