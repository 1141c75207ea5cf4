#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the late-fusion network of a checkpoint as ONNX files: export.py [--checkpoint …] [--models models/olat].

features.onnx is the U-Net, batch normalization folded into its convolutions; light.onnx the two layers that every light goes
through. Each file is checked: only operators of the project's engine, and the same output from OpenCV's dnn; and both together
against the network itself.
"""
import argparse
import pathlib

import cv2
import numpy as np
import torch

from olat import corpus, encoding
from olat.networks import HARMONICS, HIDDEN, Late, count_flops, load_checkpoint
import onnx_file

SHAPES = {"features": (1, 6, corpus.HEIGHT, corpus.WIDTH), "light": (1, HIDDEN + HARMONICS, 32, 32)}


def relight(models, a, b, directions):
    """P̂ for directions n × 3, from the two files alone, as README.md's equations say it; numpy and OpenCV, no PyTorch.
    a, b: 3 × h × w."""
    features, light = (cv2.dnn.readNetFromONNX(str(pathlib.Path(models) / f"{n}.onnx")) for n in ("features", "light"))
    full = np.maximum(a + b, 0)
    base = np.sqrt(full)
    features.setInput(np.concatenate([base, (a - b) / (full + encoding.FLOOR)])[None].astype(np.float32))
    f = features.forward()[0]
    out = []
    for d in np.asarray(directions, np.float32):
        hidden = np.maximum(np.tensordot(f.reshape(-1, 4, *f.shape[1:]), np.append(d, 1), (1, 0)), 0)
        x, y, z = d
        phi = np.array([x, y, z, x * y, y * z, z * x, x * x - y * y, 3 * z * z - 1], np.float32)
        light.setInput(np.concatenate([hidden, np.broadcast_to(phi[:, None, None], (8, *f.shape[1:]))])[None].astype(np.float32))
        y = light.forward()[0]
        out.append(np.maximum(base * y[:3] + base.mean(0) * y[3], 0) ** 2)
    return np.stack(out)


def write(net, folder):
    """Writes both files of a Late network on gradient images."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, shape in SHAPES.items():
        part, path = getattr(net, name), folder / f"{name}.onnx"
        error = onnx_file.write(part, shape, path)
        print(f"{path.name}: {path.stat().st_size / 1e6:.2f} MB, {count_flops(part, *shape) / 1e9:.3f} GFLOP for {shape}, "
              f"OpenCV dnn within {error:.1e}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--checkpoint", type=pathlib.Path, default=corpus.ROOT / "out/olat/checkpoint.pt")
    parser.add_argument("--models", type=pathlib.Path, default=corpus.ROOT / "models/olat")
    args = parser.parse_args()
    _, net = load_checkpoint(args.checkpoint)
    if not isinstance(net, Late) or net.features.down[0][0].in_channels != 6:
        raise SystemExit(f"{args.checkpoint} is not a late-fusion network on gradient images")
    random = np.random.default_rng(1)
    a, b = (random.random((3, corpus.HEIGHT, corpus.WIDTH), np.float32) * 0.5 for _ in range(2))
    directions = corpus.fibonacci(5)
    with torch.no_grad():
        x = encoding.inputs_of(torch.from_numpy(a)[None], torch.from_numpy(b)[None])
        expected = encoding.decode(net(x, torch.from_numpy(directions)[None])[0]).numpy()
    with onnx_file.together(args.models) as draft:
        write(net, draft)
        error = np.abs(relight(draft, a, b, directions) - expected).max() / expected.max()
        if not error < 1e-3:
            raise ValueError(f"the two files together differ from the network by {error}")
    print(f"both files together, in {args.models}: within {error:.1e} of the network")


if __name__ == "__main__":
    main()
