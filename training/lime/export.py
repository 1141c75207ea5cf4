#!/usr/bin/env python3
"""Writes the networks of a checkpoint as ONNX files: export.py [--checkpoint …] [--models models/lime].

Batch normalization is folded into the convolutions, SegmentationNet ends in a sigmoid, AlbedoNet too, ExponentNet in a
soft-max. Every file is checked: only operators of the project's engine, and the same output from OpenCV's dnn.
"""
import argparse
import copy
import pathlib

import cv2
import numpy as np
import onnx
import torch
from torch import nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

from lime import corpus
from lime.networks import count_flops, load_checkpoint

OPERATORS = {"Conv", "Relu", "Sigmoid", "MaxPool", "Resize", "Concat", "Gemm", "Flatten", "Softmax"}
OUTPUTS = {"segmentation": nn.Sigmoid(), "specular": nn.ReLU(), "mirror": nn.ReLU(), "albedo": nn.Sigmoid(),
           "exponent": nn.Softmax(1)}


def fold(module):
    """Convolution + batch normalization → convolution with bias, throughout."""
    for name, child in module.named_children():
        if isinstance(child, nn.Sequential) and len(child) >= 2 and isinstance(child[1], nn.BatchNorm2d):
            setattr(module, name, nn.Sequential(fuse_conv_bn_eval(child[0], child[1]), *child[2:]))
        else:
            fold(child)
    return module


def tidy(path):
    """Turns constant nodes (the scales of Resize) into initializers, which is where an importer looks for numbers."""
    model = onnx.load(str(path))
    graph = model.graph
    for node in [n for n in graph.node if n.op_type == "Constant"]:
        value = node.attribute[0].t
        value.name = node.output[0]
        graph.initializer.append(value)
        graph.node.remove(node)
    onnx.checker.check_model(model)
    onnx.save(model, str(path))


def check(path, network, shape):
    graph = onnx.load(str(path)).graph
    unknown = {node.op_type for node in graph.node} - OPERATORS
    assert not unknown, f"{path}: the engine does not run {unknown}"
    x = torch.rand(shape)
    with torch.no_grad():
        expected = network(x).numpy()
    other = cv2.dnn.readNetFromONNX(str(path))
    other.setInput(x.numpy())
    error = np.abs(other.forward() - expected).max()
    assert error < 1e-3, f"{path}: OpenCV's dnn differs by {error}"
    return error


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--checkpoint", type=pathlib.Path, default=corpus.ROOT / "out/lime/checkpoint.pt")
    parser.add_argument("--models", type=pathlib.Path, default=corpus.ROOT / "models/lime")
    args = parser.parse_args()
    networks = load_checkpoint(args.checkpoint)
    args.models.mkdir(parents=True, exist_ok=True)
    for name, (part, shape) in networks.parts().items():
        last = nn.Identity() if name == "exponent" and networks.regress else OUTPUTS[name]
        network = nn.Sequential(fold(copy.deepcopy(part)), last).eval()
        path = args.models / f"{name}.onnx"
        torch.onnx.export(network, torch.zeros(shape), str(path), opset_version=11, input_names=["input"],
                          output_names=["output"], do_constant_folding=True)
        tidy(path)
        error = check(path, network, shape)
        print(f"{path}: {path.stat().st_size / 1e6:.2f} MB, {count_flops(part, shape) / 1e9:.3f} GFLOP, "
              f"OpenCV dnn within {error:.1e}")


main()
