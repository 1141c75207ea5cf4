# SPDX-License-Identifier: LGPL-2.1-or-later
"""Batches: crops of stored subjects as a camera would show them, under a few lights each."""
import queue
import threading

import numpy as np
import torch

from . import corpus, encoding


class Batch:
    """x: inputs of the networks by name, "gradients" and, where there are `wide` ones, "olats"; truth: codes √P,
    n × lights × 3 × h × w; directions: n × lights × 3; alpha: n × 1 × 1 × h × w."""

    def __init__(self, a, b, olats, directions, alpha, wide=None):
        self.directions, self.alpha = torch.from_numpy(directions), torch.from_numpy(alpha)[:, None, None]
        self.truth = encoding.encode(torch.from_numpy(olats))
        self.x = {"gradients": encoding.inputs_of(torch.from_numpy(a), torch.from_numpy(b))}
        if wide is not None:
            self.x["olats"] = inputs_of_olats(torch.from_numpy(wide))

    def to(self, device):
        self.x = {name: x.to(device) for name, x in self.x.items()}
        for name in ("truth", "directions", "alpha"):
            setattr(self, name, getattr(self, name).to(device))
        return self


def inputs_of_olats(wide):
    """The 3-OLAT input: n × 12 × h × w of n × 3 × 3 × h × w. What stands for the full-on image is 0.4 of the mean of the three,
    which is about as bright where all of them reach."""
    base = 0.4 * wide.mean(1) + 0.002
    return torch.cat([base.sqrt(), encoding.encode(wide).flatten(1, 2)], 1)


def to_srgb8(x):
    """What an 8-bit camera keeps of linear light, as linear light."""
    x = np.clip(x, 0, 1)
    code = np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-8) ** (1 / 2.4) - 0.055)
    code = np.round(255 * code) / 255
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4).astype(np.float32)


def camera(a, b, random):
    """Gradient images as a camera gives them: noise in two thirds, of 8 bits and clipped at white in half of them, and the
    second one pixel off in a tenth."""
    if random.random() < 0.65:
        read, shot = 0.004 * random.random() ** 2, 0.02 * random.random() ** 2
        a, b = (i + random.standard_normal(i.shape, np.float32) * np.sqrt(read ** 2 + shot ** 2 * np.maximum(i, 0))
                for i in (a, b))
    if random.random() < 0.1:
        b = np.roll(b, int(random.integers(-1, 2)), int(random.integers(1, 3)))
    if random.random() < 0.5:
        a, b = to_srgb8(a), to_srgb8(b)
    return np.maximum(a, 0).astype(np.float32), np.maximum(b, 0).astype(np.float32)


def draw(random, subjects, count, lights, height, width, shifts=0, with_olats=False):
    """A batch of `count` crops. shifts: OLATs are up to as many pixels off, as after a capture in which somebody moved;
    with_olats: with the 3-OLAT input, too."""
    parts = []
    for _ in range(count):
        s = subjects[int(random.integers(len(subjects)))]
        full_h, full_w = s.alpha.shape
        for _ in range(8):
            y, x = int(random.integers(0, full_h - height + 1)), int(random.integers(0, full_w - width + 1))
            area = (slice(y, y + height), slice(x, x + width))
            alpha = s.alpha[area]
            if alpha.mean() > 0.3:
                break
        # Lights from behind leave most pictures black: they are drawn less often.
        weight = np.where(s.directions[:, 2] > -0.3, 1.0, 0.5)
        chosen = np.sort(random.choice(len(weight), lights, False, weight / weight.sum()))
        olats = []
        for i in chosen:
            dy, dx = random.integers(-shifts, shifts + 1, 2) if shifts else (0, 0)
            rows = np.clip(np.arange(y, y + height) - dy, 0, full_h - 1)
            columns = np.clip(np.arange(x, x + width) - dx, 0, full_w - 1)
            olats.append(s.olats[i][:, rows][:, :, columns] if shifts else s.olats[i][(slice(None), *area)])
        wide = None
        if with_olats:
            wide = np.stack([s.olats[i][(slice(None), *area)] for i in corpus.wide_baseline(s.directions)]).astype(np.float32)
        olats, directions = np.stack(olats).astype(np.float32), s.directions[chosen].copy()
        a, b = (g[(slice(None), *area)] for g in s.gradients)
        gain = (np.exp(0.25 * random.standard_normal()) * np.exp(0.12 * random.standard_normal(3))).astype(np.float32)
        gain = gain[:, None, None]
        if random.random() < 0.5:  # mirrored: red of A and B change places, as x does
            a, b = np.stack([b[0], a[1], a[2]]), np.stack([a[0], b[1], b[2]])
            a, b, olats, alpha = (np.ascontiguousarray(i[..., ::-1]) for i in (a, b, olats, alpha))
            directions[:, 0] *= -1
            if wide is not None:
                wide = np.ascontiguousarray(wide[[1, 0, 2]][..., ::-1])
        a, b = camera(a * gain, b * gain, random)
        parts.append((a, b, olats * gain, directions, alpha, wide if wide is None else wide * gain))
    a, b, olats, directions, alpha, wide = zip(*parts)
    return Batch(np.stack(a), np.stack(b), np.stack(olats), np.stack(directions), np.stack(alpha),
                 None if wide[0] is None else np.stack(wide))


def shape_of(random):
    """Crops, lights, height and width of a batch: whole frames in a third."""
    return (2, 6, 160, 128) if random.random() < 0.35 else (4, 6, 96, 96)


class Stream:
    """Batches of one seed from number `first` on, drawn ahead by a thread. Batch k is always the same."""

    def __init__(self, make, first=0, ahead=4):
        self.queue, self.stopped = queue.Queue(ahead), False

        def work():
            number = first
            while not self.stopped:
                batch = make(number)
                while not self.stopped:
                    try:
                        self.queue.put(batch, timeout=0.5)
                        break
                    except queue.Full:
                        pass
                number += 1

        self.thread = threading.Thread(target=work, daemon=True)
        self.thread.start()

    def __next__(self):
        return self.queue.get()

    def close(self):
        self.stopped = True
        self.thread.join()
