#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fits the estimator of the color slope of light (kernels/intrinsic/light_color) on mixtures of path-traced samples and on procedural scenes.

    fit_slope.py --samples DIR --scenes DIR --out weights.f16 [--mixtures 24] [--share 0.25] [--steps 4000] [--seed 1] [--start FILE]

The estimator sees counts of steps between neighboring points, not pictures. features() computes them for a 176 × 132 picture as points.comp,
levels.comp, steps.comp and scene.comp do from frames of that size. Every fifth seed of either source is held out. Prints errors on what
is held out, whole and by kind of scene: rmse, correlation, and rms of the error over the predicted deviation (1 if the estimator is as
sure as it may be). Needs PyTorch; features are cached in --cache."""
import argparse
import concurrent.futures
import hashlib
import pathlib
import sys

import numpy as np
import torch
from torch import nn
from torch.nn import functional

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
import mix
import sample as samples
import scene_file

LEVELS, TINTS, SIZES, SLOPES = 4, 3, 10, 43  # counts: by resolution, |step of g|, step of m, slope of steps b / m
CANDIDATES = torch.linspace(-1.4, 1.4, 29)
WIDTH, DENSE = 16, 12


def halve(x):
    """Means of 2 × 2 points; an odd last row or column counts twice."""
    x = np.pad(x, ((0, x.shape[0] % 2), (0, x.shape[1] % 2), (0, 0)), "edge")
    return samples.halve(x)


def add_split(counts, first, position, weight):
    """Adds weight at a fractional position after first, split between both neighbors."""
    low = np.floor(position).astype(int)
    for index, share in ((low, 1 - position + low), (low + 1, position - low)):
        counts += np.bincount((first + index).ravel(), (weight * share).ravel(), counts.size)


def step_counts(x):
    """Of planes m, b, g: thousandths of the steps to the right and below, LEVELS × TINTS × SIZES × SLOPES."""
    result = []
    for _ in range(LEVELS):
        near = np.concatenate([x[:, 1:].reshape(-1, 3), x[1:].reshape(-1, 3)])
        far = np.concatenate([x[:, :-1].reshape(-1, 3), x[:-1].reshape(-1, 3)])
        swap = near[:, :1] < far[:, :1]
        high, low = np.where(swap, far, near), np.where(swap, near, far)
        m, b, g = (high - low).T
        g = np.abs(g)
        size = np.clip(np.floor(np.log2(np.maximum(m, 1e-3) / 0.03) * 1.6), -1, SIZES - 2).astype(int) + 1
        tint = (g > 0.02 + 0.08 * m).astype(int) + (g > 0.06 + 0.3 * m)
        slope = np.clip(b / np.maximum(m, 0.01) / 0.1 + SLOPES // 2, 0, SLOPES - 1.001)
        counts = np.zeros(TINTS * SIZES * SLOPES)
        add_split(counts, (tint * SIZES + size) * SLOPES, slope, 1 / (1 + np.exp(-3 * (low[:, 0] + 4))))
        result.append(1000 * counts / (2 * x.shape[0] * x.shape[1]))
        x = halve(x)
    return np.stack(result)


def points_of(rgb):
    """Planes m, b, g of a linear picture."""
    f, c = np.log(rgb + 0.002), np.log(rgb + 0.01)
    return np.stack([f.mean(-1), c[..., 0] - c[..., 2], 0.5 * (c[..., 0] + c[..., 2]) - c[..., 1]], -1)


def bright(m):
    """The quantile .95 of m, in bins of 1/32."""
    above = np.cumsum(np.bincount(np.clip((m.ravel() + 6.4) * 32, 0, 255).astype(int), minlength=256)[::-1])
    return -6.4 + (255 - np.argmax(above > int(0.05 * m.size)) + 0.5) / 32


def cloud(rgb):
    """Of a linear picture: thousandths of its wide points, means of 4 × 4 pixels, by brightness below the top (8, steps of .4) and by b
    (20, steps of .1)."""
    m, b, _ = np.moveaxis(points_of(halve(halve(rgb))), -1, 0)
    dark = np.clip((bright(m) - m) / 0.4, 0, 7).astype(int)
    counts = np.zeros(160)
    add_split(counts, dark * 20, np.clip(b / 0.1 + 10, 0, 18.999), np.ones_like(b))
    return 1000 * counts / dark.size


def features(rgb):
    """Step counts and cloud of a linear picture."""
    return step_counts(points_of(rgb)), cloud(rgb)


def mixtures(path, count):
    """Features, slopes and rms of ln light of count photographs of one sample; two of three have other paint."""
    scene = samples.read(path)
    steps, points, slopes, spread = [], [], [], []
    for i in range(count):
        rng = np.random.default_rng([0, i, int(path.stem)])
        m = mix.mix(mix.repaint(scene, rng) if i % 3 else scene, i, 2, bend=0.65)
        a, b = features(m["I"].astype(np.float64))
        steps.append(a), points.append(b), slopes.append(m["k"]), spread.append(m["m_rms"])
    return [np.stack(v).astype(np.float32) for v in (steps, points, slopes, spread)]


def procedural(path, _count):
    """The same of one procedural scene."""
    picture, _, light, mask = scene_file.read(path)
    weight = (mask > 0.5) & (picture.max(-1) < 1) & (picture.max(-1) > 0.004)
    truth = mix.slope(light + 1e-6, weight.astype(np.float64)) if weight.any() else {"k": 0.0, "m_rms": 0.0}
    steps, points = features(picture)
    return [np.array([v], np.float32) for v in (steps, points, truth["k"], truth["m_rms"])]


def load(cache, paths, count, of_one):
    """[(path, arrays)] in the order of the seeds. What the cache has of the same files and code is not made again."""
    cache.mkdir(parents=True, exist_ok=True)
    paths = sorted(paths, key=lambda p: int(p.stem))

    code = hashlib.sha1(b"".join(pathlib.Path(of).read_bytes() for of in (__file__, mix.__file__, samples.__file__)))

    def one(path):
        key = code.copy()
        key.update(f"{path.resolve()} {path.stat().st_size} {path.stat().st_mtime_ns}".encode())
        return cache / f"{of_one.__name__}-{path.stem}-{count}-{key.hexdigest()[:12]}.npz"

    with concurrent.futures.ProcessPoolExecutor() as pool:
        missing = [p for p in paths if not one(p).exists()]
        for path, arrays in zip(missing, pool.map(of_one, missing, [count] * len(missing), chunksize=4)):
            np.savez(one(path), *[a.astype(np.float16 if a.ndim > 1 else np.float32) for a in arrays])
    result = []
    for path in paths:
        with np.load(one(path)) as f:
            result.append((path, [torch.tensor(f[n].astype(np.float32)) for n in f.files]))
    return result


def joined(parts):
    return [torch.cat(a) for a in zip(*parts)]


def split(loaded):
    """What is fitted, as arrays, and what is held out, as load() returns it."""
    held = [entry for entry in loaded if samples.held_out(entry[0])]
    return joined(arrays for path, arrays in loaded if not samples.held_out(path)), held


class Votes(nn.Module):
    """Log scores of the candidates: convolutions along the slopes, and a small dense part that sees the cloud, too."""

    def __init__(self):
        super().__init__()
        self.a = nn.Conv1d(LEVELS * TINTS * SIZES, WIDTH, 7, padding=3)
        self.b = nn.Conv1d(WIDTH, WIDTH, 7, padding=3)
        self.c = nn.Conv1d(WIDTH, 1, 1)
        self.d = nn.Linear(WIDTH * SLOPES, DENSE)
        self.cloud = nn.Linear(160, DENSE)
        self.e = nn.Linear(DENSE, len(CANDIDATES))
        self.drop = nn.Dropout(0.1)

    def forward(self, steps, points):
        x = self.drop(torch.log1p(2 * steps.reshape(len(steps), -1, SLOPES)))
        x = functional.leaky_relu(self.a(x), 0.1)
        y = self.c(functional.leaky_relu(self.b(x), 0.1))[:, 0, 7:36]
        q = self.d(x.flatten(1)) + self.cloud(torch.log1p(0.3 * points))
        return y + self.e(functional.leaky_relu(q, 0.1))


def estimate(model, data):
    """Mean and deviation of the slope."""
    with torch.no_grad():
        p = torch.cat([model(s, c).softmax(1) for s, c in zip(data[0].split(256), data[1].split(256))])
    mean = (p * CANDIDATES).sum(1)
    return mean, ((p * CANDIDATES**2).sum(1) - mean**2).clamp(min=1e-6).sqrt()


def score(model, data):
    """Weighted by the rms of ln light: where light is even, its slope does not matter."""
    k, w = data[2].clamp(-1.4, 1.4), (data[3] / 0.4).clamp(max=1)
    mean, sigma = estimate(model, data)

    def average(x):
        return ((w * x).sum() / w.sum()).item()

    a, b = k - average(k), mean - average(mean)
    used = mean * ((0.6 - sigma) / 0.2).clamp(0, 1)  # as move.comp does
    return (
        f"rms k {average(k**2) ** 0.5:.3f}, rmse {average((k - mean) ** 2) ** 0.5:.3f}, with confidence {average((k - used) ** 2) ** 0.5:.3f}, "
        f"correlation {average(a * b) / (average(a * a) * average(b * b)) ** 0.5:.3f}, gain {average(k * used) / average(k * k):.2f}, "
        f"z {average(((k - mean) / sigma) ** 2) ** 0.5:.2f}"
    )


ORDER = ("a", "b", "c", "d", "cloud", "e")  # as in light.glsl


def parameters(model):
    return [model.state_dict()[f"{n}.{part}"] for n in ORDER for part in ("weight", "bias")]


def load_weights(model, path):
    values = torch.tensor(np.fromfile(path, "<f2").astype(np.float32))
    for p, part in zip(parameters(model), values.split([p.numel() for p in parameters(model)])):
        p.copy_(part.view_as(p))


def show(title, model, held):
    print(title)
    for name, part in held.items():
        print(f"  held out, {name}: {score(model, part)}", flush=True)


def fit(sources, held, args):
    """`sources`: what is fitted, by name, traced first; `held`: what is held out."""
    torch.manual_seed(args.seed)
    data = [torch.cat(a) for a in zip(*sources.values())]
    first = len(sources["traced"][2])
    model = shown = Votes()
    if args.start:
        load_weights(model, args.start)
        show("start", model.eval(), held)
        model.train()
    optimizer = torch.optim.AdamW(model.parameters(), args.rate, weight_decay=args.decay)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, args.steps)
    average = {k: v.clone() for k, v in model.state_dict().items()}
    target = torch.softmax(-0.5 * ((CANDIDATES - data[2][:, None].clamp(-1.4, 1.4)) / 0.06) ** 2, 1)
    weight = (data[3] / 0.4).clamp(max=1)
    for step in range(1, args.steps + 1):
        j = torch.randint(first, (64,))
        if first < len(target):
            other = torch.rand(64) < args.share
            j[other] = torch.randint(first, len(target), (int(other.sum()),))
        loss = (weight[j] * -(target[j] * model(data[0][j], data[1][j]).log_softmax(1)).sum(1)).mean()
        optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
        schedule.step()
        for k, v in model.state_dict().items():
            average[k] += 0.02 * (v - average[k])
        if step % 500 == 0 or step == args.steps:
            shown = Votes()
            shown.load_state_dict(average)
            shown.eval()
            show(f"step {step}, fit: {score(shown, [d[:2000] for d in data])}", shown, held)
    return shown


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=pathlib.Path, required=True, help="folder of SEED.npz")
    parser.add_argument("--scenes", type=pathlib.Path, help="folder of procedural scenes, SEED.scene (training/edges/write_scenes)")
    parser.add_argument("--share", type=float, default=0.25, help="of procedural scenes in a batch")
    parser.add_argument("--cache", type=pathlib.Path, default=pathlib.Path("out/slope"))
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--mixtures", type=int, default=24, help="photographs of each sample")
    parser.add_argument("--steps", type=int, default=4000)
    parser.add_argument("--rate", type=float, default=2e-3)
    parser.add_argument("--decay", type=float, default=0.3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--start", type=pathlib.Path, help="weights to go on from; with --steps 0 their errors are printed")
    args = parser.parse_args()
    traced, unseen = split(load(args.cache, args.samples.glob("*.npz"), args.mixtures, mixtures))
    sources, held = {"traced": traced}, {"traced": joined(arrays for _, arrays in unseen)}
    kinds = [samples.kind(path) for path, _ in unseen]
    for kind in sorted(set(kinds)):
        held[f"traced, {kind}"] = joined(arrays for of, (_, arrays) in zip(kinds, unseen) if of == kind)
    if args.scenes:
        sources["procedural"], unseen = split(load(args.cache, args.scenes.glob("*.scene"), 1, procedural))
        held["procedural"] = joined(arrays for _, arrays in unseen)
        gray = held["procedural"][2].abs() < 0.05
        held["procedural, gray light"] = [a[gray] for a in held["procedural"]]
    for name, part in sources.items():
        print(f"{name}: {len(part[2])} photographs to fit, {len(held[name][2])} held out")
    model = fit(sources, held, args)
    args.out.write_bytes(torch.cat([p.flatten() for p in parameters(model)]).numpy().astype("<f2").tobytes())


if __name__ == "__main__":
    main()
