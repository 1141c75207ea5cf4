#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A network that estimates reflectance directly, without a solve: the comparison, and the example of a network of one's own
(docs/reference/networks.md): direct.py --out RUN --samples FOLDER… [--minutes 15]. Writes RUN/direct.onnx: image (sRGB 0…1) → reflectance."""
import argparse
import json
import math
import pathlib
import sys
import time

import numpy as np
import torch
from torch import nn

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
import networks
import onnx_file
import pictures
import problem
import train

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "intrinsic"))
import mix  # noqa: E402  (of that folder)


CHANNELS = (16, 32, 48, 64, 16)  # at 1/2, 1/4, 1/8, 1/16 of the picture, and of the last layer at 1/2


def convolution(inputs, outputs, stride=1):
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, stride, 1), nn.LeakyReLU(0.1))


class Features(nn.Module):
    """A U-Net: image → 16 channels of half its size."""

    def __init__(self):
        super().__init__()
        *channels, last = CHANNELS
        self.down = nn.ModuleList()
        before = 3
        for c in channels:
            self.down.append(nn.Sequential(convolution(before, c, 2), convolution(c, c)))
            before = c
        self.bottom = convolution(before, before)
        self.up = nn.ModuleList()
        for c, out in zip(channels[-2::-1], [*channels[-2:0:-1], last]):
            self.up.append(convolution(before + c, out))
            before = out
        self.head = nn.Conv2d(last, 16, 1)
        for module in self.modules():
            if isinstance(module, nn.Conv2d):
                nn.init.kaiming_normal_(module.weight, 0.1)
                nn.init.zeros_(module.bias)

    def forward(self, image):
        skips, x = [], image
        for stage in self.down:
            x = stage(x)
            skips.append(x)
        x = self.bottom(x)
        for stage, skip in zip(self.up, skips[-2::-1]):
            x = nn.functional.interpolate(x, scale_factor=2, mode="bilinear", align_corners=False)
            x = stage(torch.cat([x, skip], 1))
        return self.head(x)


class Direct(nn.Module):
    """Features with one more stage up: image → reflectance of its size."""

    def __init__(self):
        super().__init__()
        self.body = Features()
        self.last = nn.Conv2d(16 + 3, 3, 3, 1, 1)

    def forward(self, image):
        x = nn.functional.leaky_relu(self.body(image), 0.1)
        x = nn.functional.interpolate(x, scale_factor=2, mode="bilinear", align_corners=False)
        return torch.sigmoid(self.last(torch.cat([x, image], 1)))


def loss_of(found, true, mask):
    """Mean distance of ln R less one factor of the picture, and of its steps between neighbors."""
    d = (found.clamp(min=1e-3).log() - true.clamp(min=1e-2).log()) * mask
    d = d - d.sum((1, 2, 3), keepdim=True) / (3 * mask.sum((1, 2, 3), keepdim=True)).clamp(min=1) * mask
    steps = [(d.diff(dim=k) * mask.diff(dim=k).eq(0)).abs().mean() for k in (2, 3)]
    return d.abs().mean() + sum(steps)


def planes(example):
    """Image (sRGB), reflectance and mask of an example at the size of the network's picture, as batches of one, padded. Kept."""
    if not hasattr(example, "tensors"):
        _, picture, reflectance, _, mask = example.planes()
        step, (h, w) = 1 << example.level, example.size

        def reduced(plane):
            plane = np.pad(plane, ((0, h * step - plane.shape[0]), (0, w * step - plane.shape[1]), (0, 0)), mode="edge")
            return plane.reshape(h, step, w, step, -1).mean((1, 3))

        pad = ((0, -h % 16), (0, -w % 16), (0, 0))
        image, reflectance = (np.pad(reduced(p), pad, mode="edge") for p in (picture, reflectance))
        mask = np.pad((reduced(mask[..., None]) > 0.99).astype(np.float32), pad)
        example.tensors = [torch.from_numpy(np.ascontiguousarray(np.moveaxis(p, -1, 0), np.float32)) for p in (mix.srgb(image), reflectance, mask)]
    return example.tensors


def evaluate(network, examples):
    """WHDR of its reflectance by kind, by the pairs of train.whdr."""
    rows = {}
    for example in examples:
        image, _, _ = planes(example)
        with torch.no_grad():
            found = network(image[None])[0].numpy()
        _, picture, *rest = example.planes()
        step, (h, w) = 1 << example.level, example.size
        found = found[:, :h, :w].mean(0).repeat(step, 0).repeat(step, 1)[: example.height, : example.width]
        s = np.log(np.maximum(picture.mean(-1), 1e-4)) - np.log(np.maximum(found, 1e-4))
        wrong = train.whdr(example, planes=(s, picture, *rest))
        if wrong is not None:
            rows.setdefault(example.kind if example.kind in ("procedural", "flat") else "traced", []).append(wrong)
    return {k: round(float(np.mean(v)), 4) for k, v in rows.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--samples", type=pathlib.Path, nargs="*", default=[])
    parser.add_argument("--assets", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=15)
    parser.add_argument("--pool", type=int, default=900)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    torch.manual_seed(args.seed)
    torch.set_num_threads(1)
    problem.LIBRARY = problem.load()
    pool = pictures.Pool(args.samples, args.assets, (0.3, 0.3), args.pool, args.seed)
    pool.fill()
    tests = pictures.held_out(args.samples, args.assets, 40)
    network = Direct().to(memory_format=torch.channels_last)
    optimizer = torch.optim.Adam(network.parameters(), lr=2e-3)
    start, step, sums = time.time(), 0, []
    while (spent := (time.time() - start) / 60 / args.minutes) < 1:
        step += 1
        for group in optimizer.param_groups:
            group["lr"] = 1e-3 * (1 + math.cos(math.pi * spent))
        batch = [torch.stack(x) for x in zip(*(planes(p) for p in pool.batch(8)))]
        loss = loss_of(network(batch[0].to(memory_format=torch.channels_last)), batch[1], batch[2])
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        sums.append(float(loss))
        if step % 200 == 0:
            print(json.dumps({"step": step, "loss": round(float(np.mean(sums)), 4), "minutes": round(spent * args.minutes, 1)}), flush=True)
            sums = []
    pool.stop()
    print(json.dumps({"steps": step, "held_out": evaluate(network.eval(), tests)}))
    error = onnx_file.write(network, (1, 3, 128, 160), args.out / "direct.onnx", names=("image", "reflectance"), free_size=True)
    print(f"{args.out / 'direct.onnx'}: {networks.parameters(network)} parameters, OpenCV's dnn within {error:.1e}")


if __name__ == "__main__":
    main()
