"""Weights of exported networks as the start of another training: batch normalization is folded into them, and is put back."""
import pathlib
import sys

import onnx
import onnx.numpy_helper
import torch
from torch import nn

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2]))
import onnx_file  # noqa: E402


def weights_of(path):
    return {i.name: torch.from_numpy(onnx.numpy_helper.to_array(i).copy()) for i in onnx.load(str(path)).graph.initializer}


def pairs(module):
    """Every convolution with the batch normalization behind it."""
    for child in module.modules():
        if isinstance(child, nn.Sequential) and len(child) >= 2 and isinstance(child[1], nn.BatchNorm2d):
            yield child[0], child[1]


@torch.no_grad()
def load(net, folder, inputs):
    """Gives a Late network the weights that export.py wrote to a folder; inputs: pictures (n × 6 × h × w) that normalization
    is measured on, so that the network does the same in training as in use."""
    folder = pathlib.Path(folder)
    net.light.load_state_dict(weights_of(folder / "light.onnx"))
    stored = weights_of(folder / "features.onnx")
    names = {module: name for name, module in net.features.named_modules()}
    folded = list(pairs(net.features))
    for convolution, normalization in folded:
        convolution.weight.copy_(stored[f"{names[convolution]}.weight"])
        normalization.reset_running_stats()
        normalization.weight.fill_((1 + normalization.eps) ** 0.5)
        normalization.bias.copy_(stored[f"{names[convolution]}.bias"])
    net.features.last.weight.copy_(stored["last.weight"])
    net.features.last.bias.copy_(stored["last.bias"])
    seen = {}

    def note(module, given, _):
        x = given[0].transpose(0, 1).flatten(1).double()
        count, total, squares = seen.get(module, (0, 0, 0))
        seen[module] = (count + x.shape[1], total + x.sum(1), squares + (x * x).sum(1))

    hooks = [normalization.register_forward_hook(note) for _, normalization in folded]
    net.eval()
    for x in inputs:
        net.features(x)
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
    net.train()
