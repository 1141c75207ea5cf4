# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is learned in a step of training, which train.py and ablate.py share."""

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
