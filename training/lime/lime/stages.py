# SPDX-License-Identifier: LGPL-2.1-or-later
"""The order of the training (thesis 6.5.4): each network apart, with the true layers as its input, then chained step by step.
In all of them but `segmentation` every second sample has the mask that SegmentationNet finds, as in use."""
import dataclasses

import torch

from . import losses


@dataclasses.dataclass(frozen=True)
class Stage:
    name: str
    share: float      # of the whole time
    rate: float       # first learning rate; it falls to a hundredth as a cosine over the stage
    batch: int        # samples a step
    coarse: float     # share of the stage that sees pictures of half the size, four times as many
    parts: tuple      # networks that learn
    times: int = 1    # that each sample is used; beyond one, layers are those that were found for it at first


STAGES = (
    Stage("segmentation", 0.10, 2e-3, 16, 0.4, ("segmentation",)),
    Stage("specular", 0.30, 2e-3, 16, 0.4, ("specular",)),
    Stage("mirror", 0.10, 2e-3, 16, 0.4, ("mirror",)),
    Stage("albedo", 0.08, 1e-3, 32, 0, ("albedo",)),
    Stage("exponent", 0.06, 1e-3, 32, 0, ("exponent",)),
    Stage("chain-mirror", 0.06, 5e-4, 16, 0, ("specular", "mirror")),
    Stage("chain-exponent", 0.14, 5e-4, 16, 0, ("specular", "mirror", "exponent")),
    Stage("chain-albedo", 0.16, 5e-4, 16, 0, ("specular", "mirror", "exponent", "albedo")),
    # The two that decide, on layers as they are found: several times the samples in the same time, as nothing is learned
    # by the larger ones, which run once for three uses.
    Stage("heads", 0.15, 1e-3, 32, 0, ("exponent", "albedo"), 3),
)


def stages_of(networks, names=None):
    """The stages that a variant has, or those of them that are named; shares add up to 1. Named ones go on from weights
    that are known already: at full size only, from half the learning rate."""
    chosen = [s for s in STAGES if networks.use_mirror or s.name not in ("mirror", "chain-mirror")]
    unknown = set(names or ()) - {s.name for s in chosen}
    if unknown:
        raise ValueError(f"no stage is called {', '.join(sorted(unknown))}; there are {', '.join(s.name for s in chosen)}")
    if names:
        chosen = [dataclasses.replace(s, coarse=0, rate=s.rate / 2) for s in chosen if s.name in names]
    total = sum(s.share for s in chosen)
    return [dataclasses.replace(s, share=s.share / total,
                                parts=tuple(p for p in s.parts if networks.use_mirror or p != "mirror")) for s in chosen]


def pick_mask(networks, batch):
    """The true mask, and in every second sample the predicted one, as in use."""
    true = batch.mask[::2]
    with torch.no_grad():
        was_training = networks.segmentation.training
        networks.segmentation.eval()
        found = (networks.find_mask(batch.image[::2]) > 0.5).float()
        networks.segmentation.train(was_training)
    # An object that was not found leaves nothing to learn from.
    usable = (found * true).sum((1, 2, 3), keepdim=True) > 0.5 * true.sum((1, 2, 3), keepdim=True)
    mask = batch.mask.clone()
    mask[::2] = torch.where(usable, found, true)
    return mask


def find_layers(networks, batch):
    """Mask, codes of the specular layer and of the mirror image as exported networks find them (none is below 0: export.py's
    ReLU); nothing is learned by them."""
    with torch.no_grad():
        mask = pick_mask(networks, batch)
        specular = networks.find_specular(batch.image, mask).clamp(min=0)
        return mask, specular, networks.find_mirror(specular, mask).clamp(min=0) if networks.use_mirror else batch.mirror_code


def exponent_terms(networks, batch, specular, mirror):
    return {"exponent": 0.2 * losses.exponent_loss(networks.find_exponent(specular, mirror), batch, networks.regress)}


def albedo_terms(networks, batch, mask, specular, perceptual):
    """With the rendering loss of these albedos beside the true layer: beside the predicted one they would learn to make up for
    its errors."""
    albedo = networks.find_albedo(batch.image, mask, specular)
    terms = {"albedo": 5 * losses.albedo_loss(albedo, batch)}
    if perceptual:
        terms["rendering_albedo"] = 5 * losses.rendering_loss(batch, albedo=albedo)
    return terms


def stage_losses(stage, networks, batch, perceptual):
    """Dictionary of the loss terms of one batch in one stage; their sum is what the stage minimizes."""
    terms = {}
    if stage == "segmentation":
        terms["mask"] = losses.mask_loss(networks.find_mask(batch.image), batch)
        return terms
    if stage == "heads":
        mask, specular, mirror = batch.found or find_layers(networks, batch)
        return {**exponent_terms(networks, batch, specular, mirror),
                **albedo_terms(networks, batch, mask, specular, perceptual)}
    specular, mirror = batch.layer_code, batch.mirror_code
    if stage == "exponent":  # layers are all that it sees
        return exponent_terms(networks, batch, specular, mirror)
    mask = pick_mask(networks, batch)
    inside = mask * batch.mask
    chained = stage.startswith("chain")
    if stage == "specular" or chained:
        specular = networks.find_specular(batch.image, mask)
        terms["specular"] = losses.code_loss(specular, batch.layer_code, inside)
        if perceptual:
            terms["rendering"] = 5 * losses.rendering_loss(batch, specular)
    if networks.use_mirror and (stage == "mirror" or chained):
        mirror = networks.find_mirror(specular, mask)
        terms["mirror"] = losses.code_loss(mirror, batch.mirror_code, inside)
    if stage in ("chain-exponent", "chain-albedo"):
        terms.update(exponent_terms(networks, batch, specular, mirror))
    if stage in ("albedo", "chain-albedo"):
        terms.update(albedo_terms(networks, batch, mask, specular, perceptual))
    return terms
