# SPDX-License-Identifier: LGPL-2.1-or-later
"""What numbers the networks see, and back; and the analytic cosine lobe.

Radiance P of a pixel under one light is scaled as if that light had the energy of the whole sphere of lights: the full-on
image S = A + B is its mean over the sphere. Code of a linear value x: √x.
"""
import torch

FLOOR = 0.004  # keeps ratios of black pixels quiet: one code value of an 8-bit sRGB picture is 0.0003, ten are 0.003


def inputs_of(a, b):
    """n × 6 × h × w: √(A + B), and (A − B)/(A + B + FLOOR), of linear gradient images n × 3 × h × w."""
    full = (a + b).clamp(min=0)
    return torch.cat([full.sqrt(), (a - b) / (full + FLOOR)], 1)


def harmonics(directions):
    """… × 8: x, y, z, xy, yz, zx, x² − y², 3z² − 1 of unit directions … × 3."""
    x, y, z = directions.unbind(-1)
    return torch.stack([x, y, z, x * y, y * z, z * x, x * x - y * y, 3 * z * z - 1], -1)


def encode(linear):
    return linear.clamp(min=0).sqrt()


def decode(code):
    return code.clamp(min=0) ** 2


def cosine_lobe(a, b, directions):
    """P of Fyffe et al. (2009) for gradient images 3 × h × w and directions n × 3: n × 3 × h × w.

    Per pixel: the mean reflectance direction is m = (A − B)/(A + B), one axis in each color channel; a lobe
    max(0, u·ω)^p over the sphere has |m| = (p + 1)/(p + 2). P = (A + B) · 2 (p + 1) max(0, u·ω)^p, of mean A + B.
    """
    full = a + b
    m = (a - b) / full.clamp(min=1e-6)
    size = m.square().sum(0, keepdim=True).sqrt()
    u = m / size.clamp(min=1e-6)
    size = size.clamp(min=0.5, max=0.99)  # p = 0 … 98
    p = (2 * size - 1) / (1 - size)
    cosine = torch.einsum("nk,khw->nhw", directions, u).clamp(min=0)[:, None]
    lobe = 2 * (p + 1) * torch.where(cosine > 0, cosine.clamp(min=1e-6) ** p, torch.zeros_like(cosine))
    return full[None] * lobe
