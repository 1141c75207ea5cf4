#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the networks of a checkpoint as ONNX files: export.py [--checkpoint …] [--models models/lime].

Batch normalization is folded into the convolutions, SegmentationNet ends in a sigmoid, AlbedoNet too, ExponentNet in a
soft-max. Every file is checked: only operators of the project's engine, and the same output from OpenCV's dnn.
"""
import argparse
import pathlib

from torch import nn

from lime import corpus
from lime.networks import count_flops, load_checkpoint
import onnx_file

OUTPUTS = {"segmentation": nn.Sigmoid(), "specular": nn.ReLU(), "mirror": nn.ReLU(), "albedo": nn.Sigmoid(),
           "exponent": nn.Softmax(1)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--checkpoint", type=pathlib.Path, default=corpus.ROOT / "out/lime/checkpoint.pt")
    parser.add_argument("--models", type=pathlib.Path, default=corpus.ROOT / "models/lime")
    args = parser.parse_args()
    networks = load_checkpoint(args.checkpoint)
    with onnx_file.together(args.models) as draft:
        for name, (part, shape) in networks.parts().items():
            last = None if name == "exponent" and networks.regress else OUTPUTS[name]
            path = draft / f"{name}.onnx"
            error = onnx_file.write(part, shape, path, last)
            print(f"{path.name}: {path.stat().st_size / 1e6:.2f} MB, {count_flops(part, shape) / 1e9:.3f} GFLOP, "
                  f"OpenCV dnn within {error:.1e}")


main()
