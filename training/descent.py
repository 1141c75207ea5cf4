"""One step of gradient descent, as all trainings take it."""
import math

import torch


def rate_of(first, progress, count, warm=50):
    """Learning rate: a short warm-up, then a cosine to a hundredth. progress: 0 … 1; count: steps that were taken."""
    return first * min(1, (count + 1) / warm) * (0.01 + 0.99 * 0.5 * (1 + math.cos(math.pi * min(progress, 1))))


def step(optimizer, total, rate):
    """Down the gradient of a loss, whose norm counts as at most 1. Raises RuntimeError where it is no finite number, before it
    spoils a weight."""
    for group in optimizer.param_groups:
        group["lr"] = rate
    optimizer.zero_grad(set_to_none=True)
    total.backward()
    torch.nn.utils.clip_grad_norm_([p for group in optimizer.param_groups for p in group["params"]], 1.0,
                                   error_if_nonfinite=True)
    optimizer.step()
