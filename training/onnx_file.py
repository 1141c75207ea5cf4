# SPDX-License-Identifier: LGPL-2.1-or-later
"""Networks as ONNX files that the project's own engine runs."""
import contextlib
import copy
import pathlib
import shutil
import tempfile

import cv2
import numpy as np
import onnx
import torch
from torch import nn

import warm_start

OPERATORS = {"Conv", "Relu", "LeakyRelu", "Sigmoid", "MaxPool", "GlobalAveragePool", "Resize", "Concat", "Gemm", "Flatten", "Softmax", "Add", "Clip"}


def tidy(path):
    """Turns constant nodes (the scales of Resize) and copies of weights into initializers, which is where an importer looks for numbers."""
    model = onnx.load(str(path))
    graph = model.graph
    for node in [n for n in graph.node if n.op_type == "Constant"]:
        value = node.attribute[0].t
        value.name = node.output[0]
        graph.initializer.append(value)
        graph.node.remove(node)
    weights = {weight.name: weight for weight in graph.initializer}
    for node in [n for n in graph.node if n.op_type == "Identity" and n.input[0] in weights]:  # of weights that are equal
        same = copy.deepcopy(weights[node.input[0]])
        same.name = node.output[0]
        graph.initializer.append(same)
        graph.node.remove(node)
    onnx.checker.check_model(model)
    onnx.save(model, str(path))


def check(path, network, shape):
    model = onnx.load(str(path))
    unknown = {node.op_type for node in model.graph.node} - OPERATORS
    if unknown:
        raise ValueError(f"{path}: the engine does not run {unknown}")
    x = torch.rand(shape) * 2 - 0.5
    with torch.no_grad():
        expected = network(x).numpy()
    for dimension, size in zip(model.graph.input[0].type.tensor_type.shape.dim, shape):  # OpenCV takes open ones for 1
        dimension.dim_value = size
    other = cv2.dnn.readNetFromONNX(np.frombuffer(model.SerializeToString(), np.uint8))
    other.setInput(x.numpy())
    error = np.abs(other.forward() - expected).max() / max(1, np.abs(expected).max())
    if not error < 1e-3:  # nor where it is no number
        raise ValueError(f"{path}: OpenCV's dnn differs by {error}")
    return error


def write(network, shape, path, last=None, names=("input", "output"), free_size=False):
    """Writes a network, with `last` behind it where there is one, in evaluation mode. free_size: height and width stay open. The file is checked: only operators of
    the engine, and the same output from OpenCV's dnn; returns by how much that differs, relative where numbers exceed 1. Raises
    ValueError where that is too much."""
    network = warm_start.settle(copy.deepcopy(network))
    network = (nn.Sequential(network, last) if last else network).eval()
    axes = {name: {2: "height", 3: "width"} for name in names} if free_size else None
    torch.onnx.export(network, torch.zeros(shape), str(path), opset_version=11, input_names=names[:1], output_names=names[1:],
                      dynamic_axes=axes, do_constant_folding=True)
    tidy(path)
    return check(path, network, shape)


@contextlib.contextmanager
def together(folder):
    """A folder to write files to that belong together; all of them go to `folder` in the end, or, where something is amiss
    with one, none."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as draft:
        yield pathlib.Path(draft)
        for path in sorted(pathlib.Path(draft).iterdir()):
            shutil.copyfile(path, folder / path.name)
