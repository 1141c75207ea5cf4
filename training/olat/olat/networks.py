# SPDX-License-Identifier: LGPL-2.1-or-later
"""Networks from gradient images and a light direction to the picture under that light, from operators of the project's engine."""
import pathlib

import torch
import warm_start
from torch import nn
from torch.nn import functional

from . import encoding

WIDTHS = (16, 32, 64, 96, 128, 128)  # of the U-Net's levels, each half as large as the one before
DECODER = (24, 32, 48, 96, 128)      # of its way up
HIDDEN, SECOND = 16, 24              # of the head: units of the first layer, of the second
HARMONICS = 8
MULTIPLE = 2 ** (len(WIDTHS) - 1)    # pictures have sides of a multiple of this


def convolution(inputs, outputs, stride=1):
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False), nn.BatchNorm2d(outputs), nn.ReLU(True))


class UNet(nn.Module):
    """n × inputs × h × w → n × outputs × h × w, linear outputs."""

    def __init__(self, inputs, outputs, widths=WIDTHS, decoder=DECODER):
        super().__init__()
        self.down = nn.ModuleList([convolution(inputs, widths[0])])
        for a, b in zip(widths, widths[1:]):
            self.down.append(nn.Sequential(convolution(a, b, 2), convolution(b, b)))
        below = (*decoder[1:], widths[-1])
        self.up = nn.ModuleList([convolution(b + w, d) for b, w, d in zip(below, widths, decoder)])
        self.last = nn.Conv2d(decoder[0], outputs, 1)

    def forward(self, x):
        levels = []
        for down in self.down:
            x = down(x)
            levels.append(x)
        for level, up in reversed(list(zip(levels, self.up))):
            wide = functional.interpolate(x, scale_factor=2, mode="bilinear", align_corners=False)
            x = up(torch.cat([wide, level], 1))
        return self.last(x)


class LightHead(nn.Module):
    """(n × HIDDEN + HARMONICS × h × w) → n × 4 × h × w: two 1 × 1 layers that every light goes through."""

    def __init__(self):
        super().__init__()
        self.second = nn.Conv2d(HIDDEN + HARMONICS, SECOND, 1)
        self.last = nn.Conv2d(SECOND, 4, 1)

    def forward(self, x):
        return self.last(functional.relu(self.second(x)))

    def lit(self, hidden, harmonics):
        """The same without planes of constants: hidden m × HIDDEN × h × w, harmonics m × HARMONICS."""
        weight = self.second.weight
        per_light = functional.linear(harmonics, weight[:, HIDDEN:, 0, 0], self.second.bias)
        x = functional.conv2d(hidden, weight[:, :HIDDEN]) + per_light[:, :, None, None]
        return self.last(functional.relu(x))


def compose(base, y):
    """Code of P from the code of the full-on image (n × 3 × h × w) and the head's four numbers (n × lights × 4 × h × w):
    √S · y_color + mean √S · y_white. May be negative, which means zero."""
    base = base[:, None]
    return base * y[:, :, :3] + base.mean(2, keepdim=True) * y[:, :, 3:]


def scaled(widths, by):
    """Channels of another network size, multiples of four."""
    return tuple(4 * max(1, round(w * by / 4)) for w in widths)


class Late(nn.Module):
    """Features of the frame once; of each pixel HIDDEN planes m·ω + b over light directions, then LightHead for each light."""

    def __init__(self, inputs=6, width=1):
        super().__init__()
        self.features = UNet(inputs, 4 * HIDDEN, scaled(WIDTHS, width), scaled(DECODER, width))
        self.light = LightHead()

    def forward(self, x, directions):
        """x: n × inputs × h × w; directions: n × lights × 3. Code of P, n × lights × 3 × h × w."""
        return self.relight(x, self.features(x), directions)

    def relight(self, x, features, directions):
        n, _, h, w = x.shape
        lights = directions.shape[1]
        ones = torch.ones_like(directions[..., :1])
        planes = features.view(n, HIDDEN, 4, h * w)
        hidden = torch.einsum("nlk,nukp->nlup", torch.cat([directions, ones], 2), planes).relu()
        y = self.light.lit(hidden.reshape(n * lights, HIDDEN, h, w), encoding.harmonics(directions).flatten(0, 1))
        return compose(x[:, :3], y.view(n, lights, 4, h, w))


class Early(nn.Module):
    """As in the thesis: the direction is concatenated to every pixel of the input, and the whole network runs for each light."""

    def __init__(self, inputs=6, width=1):
        super().__init__()
        self.network = UNet(inputs + 3, 4, scaled(WIDTHS, width), scaled(DECODER, width))

    def forward(self, x, directions):
        n, c, h, w = x.shape
        lights = directions.shape[1]
        many = torch.cat([x[:, None].expand(n, lights, c, h, w), directions[..., None, None].expand(n, lights, 3, h, w)], 2)
        return compose(x[:, :3], self.network(many.flatten(0, 1)).view(n, lights, 4, h, w))


class DirectionNet(nn.Module):
    """Five convolutions, as VGG's, and the light's direction from a patch of an OLAT image (code, n × 3 × 64 × 64): the network
    whose features the perceptual loss compares."""

    def __init__(self, widths=(12, 24, 32, 48, 48)):
        super().__init__()
        self.layers = nn.ModuleList([nn.Conv2d(a, b, 3, 1, 1) for a, b in zip((3, *widths), widths)])
        self.dense = nn.Sequential(nn.Flatten(), nn.Linear(widths[-1] * 16, 64), nn.ReLU(True), nn.Linear(64, 3))

    def activations(self, x):
        """After each convolution; max-pooled between them."""
        out = []
        for number, layer in enumerate(self.layers):
            x = functional.relu(layer(functional.max_pool2d(x, 2) if number else x))
            out.append(x)
        return out

    def forward(self, x):
        return functional.normalize(self.dense(self.activations(x)[-1]), dim=1)


def network(variant):
    """variant: {"fusion": "late" | "early", "input": "gradients" | "olats", "width": of the U-Net against the standard one}."""
    inputs = 6 if variant["input"] == "gradients" else 12
    return (Late if variant["fusion"] == "late" else Early)(inputs, variant.get("width", 1))


def exported(net, folder):
    """The files of export.py: {network: its ONNX file}."""
    return {net.features: pathlib.Path(folder) / "features.onnx", net.light: pathlib.Path(folder) / "light.onnx"}


def load_checkpoint(path):
    """What a checkpoint of train.py sees ("gradients" or "olats") and its network (the running average of weights), or the
    network of a folder that export.py wrote, on the CPU, in evaluation mode."""
    if pathlib.Path(path).is_dir():
        net = Late()
        warm_start.take(exported(net, path))
        return "gradients", net.eval()
    saved = torch.load(path, map_location="cpu")
    net = network(saved["variant"])
    net.load_state_dict(saved["average"])
    return saved["variant"]["input"], net.eval()


def count_flops(net, *shape):
    """Floating-point operations of one forward pass of a UNet: 2 per multiply-add of convolutions."""
    total = 0

    def add(layer, _, out):
        nonlocal total
        total += 2 * out.numel() * layer.weight[0].numel()

    hooks = [m.register_forward_hook(add) for m in net.modules() if isinstance(m, nn.Conv2d)]
    was_training = net.training
    net.eval()
    with torch.no_grad():
        net(torch.zeros(shape))
    net.train(was_training)
    for hook in hooks:
        hook.remove()
    return total
