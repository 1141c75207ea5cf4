# SPDX-License-Identifier: LGPL-2.1-or-later
"""Network of the learned prior: guide (6 × height × width, sides multiples of 16) → 12 × height/2 × width/2 (docs/reference/networks.md).

A MobileNetV2 (Sandler et al. 2018) with output stride 16, as in DeepLabV3, looks at the picture; a decoder joins its features with the guide itself."""
import torch
from torch import nn
from torch.nn import functional

INPUTS, OUTPUTS = 6, 12
FIELD_OF_VALUE = 1  # V, of ln v, V, ln g
BLOCKS = (  # expansion, channels, stride, dilation
    (1, 16, 1, 1), (6, 24, 2, 1), (6, 24, 1, 1), (6, 32, 2, 1), (6, 32, 1, 1), (6, 32, 1, 1), (6, 64, 2, 1), (6, 64, 1, 1), (6, 64, 1, 1),
    (6, 64, 1, 1), (6, 96, 1, 1), (6, 96, 1, 1), (6, 96, 1, 1), (6, 160, 1, 1), (6, 160, 1, 2), (6, 160, 1, 2), (6, 320, 1, 2))
TAPS = {0: 16, 2: 24, 5: 32, 12: 96, 16: 320}  # blocks whose channels the decoder reads, at 1/2, 1/4, 1/8, 1/16, 1/16
FROZEN = 4  # blocks, and the convolution before them, that no fit changes: half of the time
FLOOR = 0.01  # kIntensityFloor of the guide
KNOTS = (-4.6, -4.0, -3.4, -2.8, -2.2, -1.6, -1.0, -0.5, 0.0)  # of ln (linear + FLOOR)


class Block(nn.Module):
    def __init__(self, inputs, expansion, channels, stride, dilation):
        super().__init__()
        inner = inputs * expansion
        self.same = stride == 1 and inputs == channels
        self.expand = nn.Conv2d(inputs, inner, 1) if expansion > 1 else None
        self.depthwise = nn.Conv2d(inner, inner, 3, stride, dilation, dilation, inner)
        self.project = nn.Conv2d(inner, channels, 1)

    def forward(self, x):
        y = functional.relu6(self.expand(x)) if self.expand else x
        y = self.project(functional.relu6(self.depthwise(y)))
        return x + y if self.same else y


class Trunk(nn.Module):
    """sRGB, -1 … 1 → the features of TAPS."""

    def __init__(self):
        super().__init__()
        self.first = nn.Conv2d(3, 32, 3, 2, 1)
        self.blocks = nn.ModuleList()
        before = 32
        for expansion, channels, stride, dilation in BLOCKS:
            self.blocks.append(Block(before, expansion, channels, stride, dilation))
            before = channels

    def forward(self, x):
        with torch.no_grad():
            x = functional.relu6(self.first(x))
        taps = []
        for k, block in enumerate(self.blocks):
            with torch.set_grad_enabled(torch.is_grad_enabled() and k >= FROZEN):
                x = block(x)
            if k in TAPS:
                taps.append(x)
        return taps

    def convolutions(self):
        return [m for m in self.modules() if isinstance(m, nn.Conv2d)]

    def fitted(self):
        return self.blocks[FROZEN:].parameters()

    def start_pretrained(self, layers):
        """layers: (weight, bias) of each convolution, in order of execution."""
        for convolution, (weight, bias) in zip(self.convolutions(), layers):
            convolution.weight.data.copy_(weight)
            convolution.bias.data.copy_(bias)


def convolution(inputs, outputs, size=3, stride=1):
    made = nn.Conv2d(inputs, outputs, size, stride, size // 2)
    nn.init.kaiming_normal_(made.weight, nonlinearity="relu")
    nn.init.zeros_(made.bias)
    return nn.Sequential(made, nn.ReLU())


def colors():
    """Guide → sRGB, -1 … 1: linear pieces between KNOTS of each channel's logarithm."""
    count = len(KNOTS) - 1
    first, second = nn.Conv2d(INPUTS, 3 * count, 1), nn.Conv2d(3 * count, 3, 1)
    for p in (*first.parameters(), *second.parameters()):
        nn.init.zeros_(p)
    knots = torch.tensor(KNOTS, dtype=torch.float64)
    linear = (knots.exp() - FLOOR).clamp(0, 1)
    codes = torch.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    slopes = 2 * (codes[1:] - codes[:-1]) / (knots[1:] - knots[:-1])
    bends = torch.cat([slopes[:1], slopes[1:] - slopes[:-1]])
    # Of the guide: 2 c0, 2 c1, and (m + 4)/2 in channels 1, 2 and 4.
    ways = ((0.5 / 3**0.5, 0.5 / 3), (-0.5 / 3**0.5, 0.5 / 3), (0.0, -1.0 / 3))
    with torch.no_grad():
        second.bias.fill_(-1)
        for c, (c0, c1) in enumerate(ways):
            for k in range(count):
                at = c * count + k
                first.weight[at, :, 0, 0] = torch.tensor([0, c0, c1, 0, 2.0, 0])
                first.bias[at] = -4.0 - KNOTS[k]
                second.weight[c, at, 0, 0] = bends[k]
    return nn.Sequential(first, nn.ReLU(), second)


class Prior(nn.Module):
    """Starts at the fitted prior."""

    def __init__(self):
        super().__init__()
        self.colors, self.trunk = colors(), Trunk()
        half, quarter, eighth, sixteenth, last = TAPS.values()
        self.near = convolution(INPUTS + 3, 24, 3, 2)
        self.lateral = nn.ModuleList([convolution(last, 64, 1), convolution(sixteenth, 64, 1), convolution(eighth, 40, 1), convolution(quarter, 24, 1), convolution(half, 12, 1)])
        self.whole = nn.Conv2d(last, 64, 1)
        self.at16 = nn.Sequential(convolution(128, 64), convolution(64, 64))
        self.at8 = nn.Sequential(convolution(80, 40), convolution(40, 40))
        self.at4 = nn.Sequential(convolution(56, 32), convolution(32, 32))
        self.at2 = nn.Sequential(convolution(16 + 24 + 12, 32), convolution(32, 32))
        self.reduce = nn.ModuleList([convolution(64, 40, 1), convolution(40, 32, 1), convolution(32, 16, 1)])
        # ln S less ln I, in three scales: what V is made of.
        self.value = nn.ModuleList([nn.Conv2d(64, 1, 1), nn.Conv2d(40, 1, 1), nn.Conv2d(32, 1, 1)])
        self.head, self.straight = nn.Conv2d(33, OUTPUTS, 1), nn.Conv2d(INPUTS, OUTPUTS, 3, 2, 1)
        for module in (*self.value, self.head, self.straight):
            nn.init.zeros_(module.weight)
            nn.init.zeros_(module.bias)
        with torch.no_grad():
            self.head.weight[4 * FIELD_OF_VALUE : 4 * FIELD_OF_VALUE + 4, 32] = 1

    def forward(self, guide):
        seen = self.colors(guide)
        f2, f4, f8, f16, last = self.trunk(seen)
        near = self.near(torch.cat([guide, seen], 1))
        y = self.at16(torch.cat([self.lateral[0](last) + self.whole(functional.adaptive_avg_pool2d(last, 1)), self.lateral[1](f16)], 1))
        value = self.value[0](y)
        for x, at, reduce, out, lateral in ((f8, self.at8, self.reduce[0], self.value[1], self.lateral[2]), (f4, self.at4, self.reduce[1], self.value[2], self.lateral[3])):
            y = at(torch.cat([_double(reduce(y)), lateral(x)], 1))
            value = _double(value) + out(y)
        y = self.at2(torch.cat([_double(self.reduce[2](y)), near, self.lateral[4](f2)], 1))
        return self.head(torch.cat([y, _double(value)], 1)) + self.straight(guide)


def _double(x):
    return functional.interpolate(x, scale_factor=2, mode="bilinear", align_corners=False)


def parameters(network):
    return sum(p.numel() for p in network.parameters())
