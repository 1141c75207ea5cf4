# SPDX-License-Identifier: LGPL-2.1-or-later
"""Steps of gradient descent."""
import math

import torch


class Muon(torch.optim.Optimizer):
    """Descent for networks whose Adam has come to its end: matrices and filters go along the mean of their gradients, equally
    far in all its directions (its singular values count as 1; Jordan et al., Muon, 2024); biases and what has fewer rows or
    columns than LEAST go by Adam, at ADAM times the rate. Wants a fast BLAS (libopenblas0-pthread)."""

    LEAST, ADAM = 8, 0.3
    MOMENTUM, BETAS, EPSILON = 0.95, (0.9, 0.999), 1e-8

    def __init__(self, parameters, lr):
        super().__init__(parameters, {"lr": lr})

    @staticmethod
    def orthogonal(matrix):
        """U V' of its singular value decomposition U S V', about, by five Newton-Schulz steps."""
        x = matrix.T if matrix.shape[0] > matrix.shape[1] else matrix
        x = x / (x.norm() + 1e-12)
        for _ in range(5):
            square = x @ x.T
            x = 3.4445 * x + (-4.7750 * square + 2.0315 * square @ square) @ x
        return x.T if matrix.shape[0] > matrix.shape[1] else x

    @torch.no_grad()
    def step(self, closure=None):
        for group in self.param_groups:
            for p in group["params"]:
                if p.grad is not None:
                    self.move(p, self.state[p], group["lr"])

    def move(self, p, state, rate):
        if not state:
            state.update(step=0, mean=torch.zeros_like(p))
        state["step"] += 1
        rows, columns = (len(p), p[0].numel()) if p.ndim > 1 else (1, 1)
        if min(rows, columns) >= self.LEAST:
            state["mean"].lerp_(p.grad, 1 - self.MOMENTUM)
            ahead = p.grad.lerp(state["mean"], self.MOMENTUM).reshape(rows, columns).contiguous()
            p.add_(self.orthogonal(ahead).reshape(p.shape), alpha=-rate * max(1, rows / columns) ** 0.5)
            return
        first, second = self.BETAS
        state["mean"].lerp_(p.grad, 1 - first)
        state.setdefault("square", torch.zeros_like(p)).lerp_(p.grad * p.grad, 1 - second)
        scale = (state["square"] / (1 - second ** state["step"])).sqrt_().add_(self.EPSILON)
        p.addcdiv_(state["mean"], scale, value=-self.ADAM * rate / (1 - first ** state["step"]))


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
