#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Error of SpecularNet by its width: widths.py [--samples 20000] [--build build --bench network-bench].

Networks of several widths, anew and side by side on the very same samples in the same order, at 64 × 64 with the true mask.
Error: mean absolute difference of codes inside the mask, held-out samples. With --build, the build folder of the project
(for inverse-onnx-import), and --bench, times of the project's own engine at 128 × 128. Prints Markdown.
"""
import argparse
import os
import pathlib
import subprocess
import tempfile

os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import torch  # noqa: E402
from torch import nn  # noqa: E402

from lime import corpus, datasets, losses  # noqa: E402
from lime.networks import SIZES, UNet, count_flops  # noqa: E402
from sizes import milliseconds  # noqa: E402
import descent  # noqa: E402
import onnx_file  # noqa: E402

FACTORS = (0.33, 0.5, 0.75, 1, 1.5)
PIXELS, BATCH, RATE = 64, 32, 2e-3


def widths(factor):
    return tuple(max(4, 4 * round(factor * w / 4)) for w in SIZES["standard"]["specular"])


def error_of(network, batch):
    code = network(torch.cat([batch.image * batch.mask, batch.mask], 1)) * batch.mask
    return losses.code_loss(code, batch.layer_code, batch.mask)


def time_of(network, build, bench):
    with tempfile.TemporaryDirectory() as folder:
        onnx, flat = pathlib.Path(folder) / "specular.onnx", pathlib.Path(folder) / "specular.net"
        onnx_file.write(network, (1, 4, 128, 128), onnx, nn.ReLU())
        subprocess.run([build / "tools/onnx/inverse-onnx-import", onnx, flat], check=True, capture_output=True)
        return milliseconds(bench, str(flat), 128)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hdri", default=None)
    parser.add_argument("--samples", type=int, default=20000)
    parser.add_argument("--count", type=int, default=500, help="held-out samples")
    parser.add_argument("--seed", type=int, default=4)
    parser.add_argument("--build", type=pathlib.Path)
    parser.add_argument("--bench", help="the program network-bench")
    args = parser.parse_args()
    torch.manual_seed(args.seed)
    torch.set_num_threads(2)
    networks = [UNet(4, 1, widths(f)).train().to(memory_format=torch.channels_last) for f in FACTORS]
    optimizers = [torch.optim.Adam(n.parameters(), lr=RATE) for n in networks]
    samples = corpus.Corpus(args.hdri)
    stream = corpus.Stream(samples, args.seed, 0, BATCH, PIXELS, corpus.TAUGHT)
    steps = args.samples // BATCH
    for step in range(steps):
        batch = next(stream)
        for network, optimizer in zip(networks, optimizers):
            descent.step(optimizer, error_of(network, batch), descent.rate_of(RATE, step / steps, step))
        if step % 100 == 0:
            print(f"{step * BATCH} samples", flush=True)
    stream.close()
    sums = [0.0] * len(FACTORS)
    for network in networks:
        network.eval()
    with torch.no_grad():
        for first in range(0, args.count, 50):
            n = min(50, args.count - first)
            batch = corpus.Batch(samples.render(datasets.CHOICES, first, n, PIXELS, corpus.TEST))
            for i, network in enumerate(networks):
                sums[i] += float(error_of(network, batch)) * n / args.count
    print("| widths | GFLOP at 128 × 128 | MAE of code |" + (" ms |" if args.bench else ""))
    print("|---|---|---|" + ("---|" if args.bench else ""))
    for factor, network, error in zip(FACTORS, networks, sums):
        row = [", ".join(map(str, widths(factor))), f"{count_flops(network, (1, 4, 128, 128)) / 1e9:.3f}", f"{error:.4f}"]
        if args.bench:
            row.append(f"{time_of(network, args.build, args.bench):.1f}")
        print("| " + " | ".join(row) + " |", flush=True)


main()
