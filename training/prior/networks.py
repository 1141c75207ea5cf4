# SPDX-License-Identifier: LGPL-2.1-or-later
"""Networks of the learned prior: guide (6 × height × width, sides multiples of 16) → 44 × height/2 × width/2 (docs/reference/networks.md)."""
import torch
from torch import nn

INPUTS, OUTPUTS = 6, 44
WIDTHS = {  # channels at 1/2, 1/4, 1/8, 1/16 of the picture, and of the last layer at 1/2
    "small": (8, 12, 16, 24, 12),
    "medium": (16, 32, 48, 64, 16),
    "large": (24, 40, 64, 104, 16),
}


def convolution(inputs, outputs, stride=1):
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, stride, 1), nn.LeakyReLU(0.1))


class Prior(nn.Module):
    """A U-Net. Starts at zero: at the fitted prior."""

    def __init__(self, width, inputs=INPUTS, outputs=OUTPUTS):
        super().__init__()
        *channels, last = WIDTHS[width]
        self.down = nn.ModuleList()
        before = inputs
        for c in channels:
            self.down.append(nn.Sequential(convolution(before, c, 2), convolution(c, c)))
            before = c
        self.bottom = convolution(before, before)
        self.up = nn.ModuleList()
        for c, out in zip(channels[-2::-1], [*channels[-2:0:-1], last]):
            self.up.append(convolution(before + c, out))
            before = out
        self.head = nn.Conv2d(last, outputs, 1)
        for module in self.modules():
            if isinstance(module, nn.Conv2d):
                nn.init.kaiming_normal_(module.weight, 0.1)
                nn.init.zeros_(module.bias)
        nn.init.zeros_(self.head.weight)

    def forward(self, guide):
        skips, x = [], guide
        for stage in self.down:
            x = stage(x)
            skips.append(x)
        x = self.bottom(x)
        for stage, skip in zip(self.up, skips[-2::-1]):
            x = nn.functional.interpolate(x, scale_factor=2, mode="bilinear", align_corners=False)
            x = stage(torch.cat([x, skip], 1))
        return self.head(x)


def _copied(new, old, *inputs):
    """Puts a convolution into a wider one, whose further channels it does not use. inputs: channels of each part of the input, of both."""
    kept, start_old, start_new = len(old.weight), 0, 0
    new.weight[:kept], new.bias[:kept] = 0, old.bias
    for channels_old, channels_new in inputs:
        new.weight[:kept, start_new : start_new + channels_old] = old.weight[:, start_old : start_old + channels_old]
        start_old, start_new = start_old + channels_old, start_new + channels_new


@torch.no_grad()
def grown(narrow, width):
    """A network of another width that gives the same answers as one that is as wide or narrower."""
    network = Prior(width)
    before, skips = (INPUTS, INPUTS), []
    for new, old in zip(network.down, narrow.down):
        skips.append((len(old[0][0].weight), len(new[0][0].weight)))
        _copied(new[0][0], old[0][0], before)
        before = skips[-1]
        _copied(new[1][0], old[1][0], before)
    _copied(network.bottom[0], narrow.bottom[0], before)
    for new, old, skip in zip(network.up, narrow.up, skips[-2::-1]):
        _copied(new[0], old[0], before, skip)
        before = (len(old[0].weight), len(new[0].weight))
    _copied(network.head, narrow.head, before)
    return network


def parameters(network):
    return sum(p.numel() for p in network.parameters())
