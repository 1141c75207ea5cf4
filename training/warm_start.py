# SPDX-License-Identifier: LGPL-2.1-or-later
"""Weights of exported networks (onnx_file.write) as the start of another training: batch normalization is folded into them,
and is put back."""
import contextlib

import onnx
import onnx.numpy_helper
import torch
from torch import nn
from torch.nn.utils.fusion import fuse_conv_bn_eval


def weights_of(path):
    """Tensors by name; without the name that an operator behind the network gives all of them (`0.`)."""
    stored = {i.name: torch.from_numpy(onnx.numpy_helper.to_array(i).copy()) for i in onnx.load(str(path)).graph.initializer}
    stored = {name: tensor for name, tensor in stored.items() if name.endswith((".weight", ".bias"))}
    whole = all(name.startswith("0.") for name in stored)
    return {name[2:] if whole else name: tensor for name, tensor in stored.items()}


def normalized(module):
    """The parts of a module that begin with a convolution and the batch normalization behind it."""
    return [child for child in module.modules()
            if isinstance(child, nn.Sequential) and len(child) >= 2 and isinstance(child[1], nn.BatchNorm2d)]


def settle(module):
    """Normalization becomes part of the convolutions before it, for good: what it has measured until now is what it does. The
    module gets a bias for each, under the names that exported networks have, and is in evaluation mode."""
    for part in normalized(module.eval()):
        part[0], part[1] = fuse_conv_bn_eval(part[0], part[1]), nn.Identity()
    return module


@contextlib.contextmanager
def inputs_measured(folded):
    """Normalization gets the mean and variance of what runs through it in the meantime, without changing what comes out."""
    seen = {}

    def note(module, given, _):
        x = given[0].transpose(0, 1).flatten(1).double()
        count, total, squares = seen.get(module, (0, 0, 0))
        seen[module] = (count + x.shape[1], total + x.sum(1), squares + (x * x).sum(1))

    hooks = [normalization.register_forward_hook(note) for _, normalization in folded]
    yield
    for hook in hooks:
        hook.remove()
    for _, normalization in folded:
        count, total, squares = seen[normalization]
        mean = total / count
        variance = (squares / count - mean * mean).clamp(min=1e-6)
        normalization.running_mean.copy_(mean)
        normalization.running_var.copy_(variance)
        normalization.weight.copy_((variance + normalization.eps).sqrt())
        normalization.bias.add_(mean)


@torch.no_grad()
def take(files):
    """Gives networks ({network: ONNX file}) the files' weights, and normalization that does nothing, in evaluation mode: to be
    used. Returns pairs of convolution and normalization.

    Raises KeyError for a weight that a file lacks, ValueError for one of another shape."""
    folded = []
    for network, path in files.items():
        stored, names = weights_of(path), {module: name for name, module in network.named_modules()}
        pairs = [(part[0], part[1]) for part in normalized(network)]
        for convolution, normalization in pairs:
            normalization.reset_running_stats()
            normalization.weight.fill_((1 + normalization.eps) ** 0.5)
            normalization.bias.copy_(stored[f"{names[convolution]}.bias"])
        of_normalization = {p for _, normalization in pairs for p in normalization.parameters()}
        for name, parameter in network.named_parameters():
            if parameter not in of_normalization:
                if stored[name].shape != parameter.shape:
                    raise ValueError(f"{path}: {name} is {list(stored[name].shape)}, not {list(parameter.shape)}")
                parameter.copy_(stored[name])
        network.eval()
        folded += pairs
    return folded


@torch.no_grad()
def load(files, run):
    """`take`, to be trained on: run() runs pictures through all networks, on which normalization is measured, so that they do
    the same in training as in use."""
    with inputs_measured(take(files)):
        run()
