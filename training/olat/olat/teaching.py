"""One step of training, which train.py and ablate.py share."""
import math

import torch

from . import losses

PERCEPTUAL, RELIGHTING = 0.2, 0.5  # weights of losses against the photometric one
REACH = 4          # pixels, of the alignment loss


def terms_of(net, judge, batch, random, inputs="gradients", photometric=True, perceptual=True, alignment=False,
             relighting=True):
    """Loss terms of a batch. judge: a trained DirectionNet."""
    code = net(batch.x[inputs], batch.directions)
    truth = losses.align(code, batch.truth, REACH) if alignment else batch.truth
    terms = {}
    if photometric:
        terms["photometric"] = losses.photometric(code, truth, batch.alpha)
    if relighting:
        terms["relighting"] = RELIGHTING * losses.relighting(code, truth, batch.alpha, random)
    if perceptual:
        terms["perceptual"] = PERCEPTUAL * losses.perceptual(judge, *losses.patches_of([code, truth], random))
    return terms


def direction_loss(judge, batch, random):
    """Mean ℓ1 distance of the direction that is read off a patch to the light's (thesis 7.4.2)."""
    patch, = losses.patches_of([batch.truth.clamp(max=losses.LIMIT)], random)
    return (judge(patch) - batch.directions.flatten(0, 1)).abs().sum(1).mean()


def rate_of(first, progress, count, warm=50):
    """Learning rate: a short warm-up, then a cosine to a hundredth."""
    return first * min(1, (count + 1) / warm) * (0.01 + 0.99 * 0.5 * (1 + math.cos(math.pi * min(progress, 1))))


def step(net, optimizer, total, rate):
    for group in optimizer.param_groups:
        group["lr"] = rate
    optimizer.zero_grad(set_to_none=True)
    total.backward()
    torch.nn.utils.clip_grad_norm_(net.parameters(), 1.0)
    optimizer.step()


class Average:
    """Running average of a network's weights, which is what is used after training."""

    def __init__(self, net, decay=0.998):
        self.decay, self.steps = decay, 0
        self.state = {k: v.detach().clone() for k, v in net.state_dict().items()}

    def update(self, net):
        self.steps += 1
        decay = min(self.decay, self.steps / (self.steps + 10))
        for name, value in net.state_dict().items():
            kept = self.state[name]
            if kept.dtype.is_floating_point:
                kept.mul_(decay).add_(value.detach(), alpha=1 - decay)
            else:
                kept.copy_(value)
