# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the networks are trained by (thesis 7.4.2). All compare codes √P, in which a highlight 100 times as bright as skin
counts ten times as much."""
import torch

LIMIT = 3.0  # of codes: P = 9, beyond which a highlight counts no more


def signed(code):
    """Codes below zero mean zero; a tenth of them is left, so that a pixel can come back."""
    return torch.where(code > 0, code, 0.1 * code)


def photometric(code, truth, alpha):
    """Mean absolute difference of codes over the subject. code, truth: n × lights × 3 × h × w; alpha: n × 1 × 1 × h × w."""
    difference = (signed(code).clamp(max=LIMIT) - truth.clamp(max=LIMIT)).abs()
    return (difference * alpha).sum() / (alpha.sum() * code.shape[1] * 3).clamp(min=1)


def relighting(code, truth, alpha, random):
    """Mean absolute difference of the codes of the subject under all lights of the batch at once, each of a random brightness:
    where a median would be too dark for every single light, their sum is not."""
    weights = torch.from_numpy(random.exponential(1, code.shape[:2]).astype("float32")).to(code.device)
    weights = (weights / weights.sum(1, keepdim=True))[:, :, None, None, None]
    relit, true = ((weights * c.clamp(min=0, max=LIMIT) ** 2).sum(1) for c in (code, truth))
    difference = ((relit + 1e-4).sqrt() - (true + 1e-4).sqrt()).abs()
    return (difference * alpha[:, 0]).sum() / (3 * alpha.sum()).clamp(min=1)


def patches_of(images, random, size=64):
    """One patch of each of m images, m × 3 × size × size, all from one place."""
    h, w = images[0].shape[-2:]
    y, x = int(random.integers(0, h - size + 1)), int(random.integers(0, w - size + 1))
    return [i.flatten(0, 1)[:, :, y:y + size, x:x + size] for i in images]


def perceptual(net, code, truth):
    """Eq. 7.1 with the features of a DirectionNet: Σ over layers of the mean square of differences, each layer in units of its
    own mean square."""
    with torch.no_grad():
        wanted = net.activations(truth.clamp(max=LIMIT))
    got = net.activations(code.clamp(min=0, max=LIMIT))
    return sum(((g - t) ** 2).mean() / (t ** 2).mean().clamp(min=1e-4) for g, t in zip(got, wanted)) / len(got)


@torch.no_grad()
def align(code, truth, reach):
    """Eq. 7.2, slide-pooling: each true OLAT image (n × lights × 3 × h × w), shifted by at most `reach` pixels to where it
    is nearest to the prediction. What a shift brings in from outside is the border's."""
    n, lights, _, h, w = truth.shape
    a, b = code.clamp(min=0).mean(2), truth.mean(2)
    inner = a[..., reach:h - reach, reach:w - reach]
    best = torch.full((n, lights), float("inf"), device=truth.device)
    dy, dx = (torch.zeros(n, lights, dtype=torch.long, device=truth.device) for _ in range(2))
    for y in range(-reach, reach + 1):
        for x in range(-reach, reach + 1):
            moved = b[..., reach - y:h - reach - y, reach - x:w - reach - x]
            cost = (inner - moved).abs().mean((2, 3))
            better = cost < best
            best = torch.where(better, cost, best)
            dy[better], dx[better] = y, x
    return shift(truth, dy, dx)


def shift(images, dy, dx):
    """Images n × lights × 3 × h × w moved down by dy and right by dx (n × lights, whole pixels), borders repeated."""
    h, w = images.shape[-2:]
    out = torch.empty_like(images)
    rows, columns = torch.arange(h, device=images.device), torch.arange(w, device=images.device)
    for i in range(images.shape[0]):
        for j in range(images.shape[1]):
            r, c = (rows - dy[i, j]).clamp(0, h - 1), (columns - dx[i, j]).clamp(0, w - 1)
            out[i, j] = images[i, j][:, r][:, :, c]
    return out
