# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the networks are trained by (thesis 6.5.2 and 6.5.3)."""
import torch
from torch.nn import functional

from . import encoding


def mask_loss(probability, batch):
    """Mean square."""
    return functional.mse_loss(probability, batch.mask)


def code_loss(code, truth, mask):
    """Mean absolute difference of codes inside the mask."""
    return ((code - truth).abs() * mask).sum() / mask.sum().clamp(min=1)


def albedo_loss(albedo, batch):
    """Mean square over m_d and alpha."""
    return functional.mse_loss(albedo, torch.cat([batch.diffuse, batch.alpha[:, None]], 1))


def exponent_loss(scores, batch, regress):
    """Cross entropy of bins, or the mean square of log10 s, over the objects that are not matte."""
    if regress:
        each = (scores[:, 0] - torch.log10(batch.shininess)) ** 2
    else:
        each = functional.cross_entropy(scores, batch.bin, reduction="none")
    return (each * batch.shiny).sum() / batch.shiny.sum().clamp(min=1)


def rendering_loss(batch, specular=None, albedo=None):
    """The perceptual rendering loss, Eq. 6.4: mean square over the mask of I − (A + m̂_d D + m̂_s Ŝ).

    specular: code of the predicted layer; it stands for m_s Ŝ, so that m̂_s Ŝ is the layer times the predicted over the
    true alpha (of matte objects the layer itself). albedo: n × 4. Either may be None, which is the true one. Compared as the
    camera shows it: clipped at white, where I tells nothing more. The highlight's color, which a gray layer leaves out, is the
    true one, as D is.
    """
    layer = batch.layer * batch.tint if specular is None else encoding.decode(specular) * batch.tint
    diffuse = batch.diffuse
    if albedo is not None:
        diffuse = albedo[:, :3]
        ratio = torch.where(batch.shiny > 0, albedo[:, 3] / batch.alpha.clamp(min=0.03), torch.ones_like(batch.alpha))
        layer = layer * ratio.view(-1, 1, 1, 1)
    rendered = batch.ambient.view(-1, 1, 1, 1) + diffuse[:, :, None, None] * batch.shading + layer
    difference = encoding.to_linear(batch.image) - rendered.clamp(max=1)
    return (difference ** 2 * batch.mask).sum() / (3 * batch.mask.sum().clamp(min=1))
