# SPDX-License-Identifier: LGPL-2.1-or-later
"""The five networks of thesis Fig. 6.3, from operators that the project's own engine runs.

Convolutions 3×3 with stride 1 or 2, batch normalization (folded at export), ReLU, 2×2 max-pooling, global means, bilinear ×2
upsampling (half-pixel centers), concatenation, dense layers, sigmoid and soft-max.
"""
import pathlib

import torch
import warm_start
from torch import nn
from torch.nn import functional

from .encoding import BINS

# Widths of the U-Nets per level (each half as wide as the one before) and of the encoders per block, and the dense layer.
WIDTHS = {"segmentation": (8, 16, 32, 48, 64), "specular": (12, 24, 48, 64, 80, 80), "mirror": (8, 16, 32, 48, 64, 64),
          "albedo": (16, 32, 48, 64, 96), "exponent": (16, 32, 48, 64, 96), "dense": 64}
INPUT = 128  # side of the input, pixels


def convolution(inputs, outputs, stride=1):
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False), nn.BatchNorm2d(outputs), nn.ReLU(True))


def upsample(x):
    """Twice as large; in 32 bits, as PyTorch 1.13's gradient of it takes six times as long in 16."""
    narrow = x.dtype != torch.float32
    wide = functional.interpolate(x.float() if narrow else x, scale_factor=2, mode="bilinear", align_corners=False)
    return wide.to(x.dtype) if narrow else wide


class UNet(nn.Module):
    """n × inputs × h × w → n × outputs × h × w, linear outputs; h and w are multiples of 2^(levels − 1)."""

    def __init__(self, inputs, outputs, widths):
        super().__init__()
        self.down = nn.ModuleList([convolution(inputs, widths[0])])
        for a, b in zip(widths, widths[1:]):
            self.down.append(nn.Sequential(convolution(a, b, 2), convolution(b, b)))
        self.up = nn.ModuleList([convolution(a + b, a) for a, b in zip(widths, widths[1:])])
        self.last = nn.Conv2d(widths[0], outputs, 3, 1, 1)

    def forward(self, x):
        levels = []
        for down in self.down:
            x = down(x)
            levels.append(x)
        for level, up in reversed(list(zip(levels, self.up))):
            x = up(torch.cat([upsample(x), level], 1))
        return self.last(x)


class Encoder(nn.Module):
    """Five convolutions with ReLU and max-pooling, and three dense layers: n × inputs × size × size → n × outputs."""

    def __init__(self, inputs, outputs, widths, dense, size):
        super().__init__()
        self.blocks = nn.Sequential(*[nn.Sequential(convolution(a, b), nn.MaxPool2d(2))
                                      for a, b in zip((inputs, *widths), widths)])
        cells = (size >> len(widths)) ** 2
        self.dense = nn.Sequential(nn.Flatten(), nn.Linear(cells * widths[-1], dense), nn.ReLU(True),
                                   nn.Linear(dense, dense), nn.ReLU(True), nn.Linear(dense, outputs))

    def forward(self, x):
        return self.dense(self.blocks(x))


class PooledEncoder(nn.Module):
    """Five blocks of convolutions with ReLU and max-pooling (two convolutions where pictures are small), what each channel
    has on average and at most, and three dense layers: n × inputs × size × size → n × outputs; size is 2^k ≥ 2^blocks.

    Gloss looks the same anywhere on an object, which dense layers that tell places apart (Encoder) have to learn.
    """

    def __init__(self, inputs, outputs, widths, size):
        super().__init__()
        self.blocks = nn.Sequential()
        for number, (a, b) in enumerate(zip((inputs, *widths), widths)):
            second = [convolution(b, b)] if number >= 2 else []
            self.blocks.append(nn.Sequential(convolution(a, b), *second, nn.MaxPool2d(2)))
        self.mean = nn.AdaptiveAvgPool2d(1)
        halvings = (size >> len(widths)).bit_length() - 1
        self.most = nn.Sequential(*[nn.MaxPool2d(2) for _ in range(halvings)])  # the largest pooling that the engine has
        wide = widths[-1]
        self.dense = nn.Sequential(nn.Flatten(), nn.Linear(2 * wide, wide), nn.ReLU(True), nn.Linear(wide, wide), nn.ReLU(True),
                                   nn.Linear(wide, outputs))

    def forward(self, x):
        x = self.blocks(x)
        return self.dense(torch.cat([self.mean(x), self.most(x)], 1))


class Networks(nn.Module):
    """All five, and the way of a picture through them. Codes are those of encoding.encode.

    use_mirror=False leaves MirrorNet out; regress=True lets ExponentNet give log10 of the shininess instead of bins; settled
    ones have no normalization any more, but biases in its place.
    """

    def __init__(self, use_mirror=True, regress=False, settled=False):
        super().__init__()
        s = WIDTHS
        self.use_mirror, self.regress = use_mirror, regress
        self.segmentation = UNet(3, 1, s["segmentation"])
        self.specular = UNet(4, 1, s["specular"])
        self.mirror = UNet(1, 1, s["mirror"])
        self.albedo = Encoder(4, 4, s["albedo"], s["dense"], INPUT)
        self.exponent = PooledEncoder(1 + use_mirror, 1 if regress else BINS, s["exponent"], INPUT)
        if settled:  # what it does will be loaded
            warm_start.settle(self).train()

    def find_mask(self, image):
        """sRGB n × 3 × h × w → probability of the object, n × 1 × h × w."""
        return torch.sigmoid(self.segmentation(image))

    def find_specular(self, image, mask):
        """Masked sRGB and mask → code of the specular layer m_s S (gray)."""
        return self.specular(torch.cat([image * mask, mask], 1)) * mask

    def find_mirror(self, specular, mask):
        """Code of the specular layer → code of the mirror image alpha M (gray)."""
        return self.mirror(specular) * mask

    def find_albedo(self, image, mask, specular):
        """→ n × 4: diffuse albedo m_d in linear RGB, and alpha; 0 … 1."""
        return torch.sigmoid(self.albedo(torch.cat([image * mask, specular], 1)))

    def find_exponent(self, specular, mirror):
        """Codes → scores of the 8 bins (before soft-max), or log10 of the shininess (n × 1) in the regressing variant."""
        return self.exponent(torch.cat([specular, mirror], 1) if self.use_mirror else specular)

    def parts(self):
        """Networks by name, with the shape of their inputs (one sample)."""
        n = INPUT
        shapes = {"segmentation": (1, 3, n, n), "specular": (1, 4, n, n), "mirror": (1, 1, n, n), "albedo": (1, 4, n, n),
                  "exponent": (1, 1 + self.use_mirror, n, n)}
        return {name: (getattr(self, name), shape) for name, shape in shapes.items() if name != "mirror" or self.use_mirror}


def exported(networks, folder):
    """The files of export.py: {network: its ONNX file}."""
    return {part: pathlib.Path(folder) / f"{name}.onnx" for name, (part, _) in networks.parts().items()}


def load_checkpoint(path):
    """The networks of a checkpoint of train.py, or of a folder that export.py wrote, to be used: on the CPU,
    in evaluation mode."""
    if pathlib.Path(path).is_dir():
        networks = Networks()
        warm_start.take(exported(networks, path))
        return networks.eval()
    saved = torch.load(path, map_location="cpu")
    networks = Networks(**saved["variant"])
    networks.load_state_dict(saved["networks"])
    return networks.eval()


def count_flops(network, shape):
    """Floating-point operations of one forward pass: 2 per multiply-add of convolutions and dense layers."""
    total = 0

    def add(layer, _, out):
        nonlocal total
        total += 2 * out.numel() * layer.weight[0].numel()

    hooks = [m.register_forward_hook(add) for m in network.modules() if isinstance(m, (nn.Conv2d, nn.Linear))]
    was_training = network.training
    network.eval()
    with torch.no_grad():
        network(torch.zeros(shape))
    network.train(was_training)
    for hook in hooks:
        hook.remove()
    return total
