# SPDX-License-Identifier: LGPL-2.1-or-later
"""Examples for fits and for tests of them: procedural scenes, photographs mixed from path-traced samples, and drawn ones (../intrinsic)."""
import concurrent.futures
import pathlib
import sys
import threading

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "intrinsic"))
import flat
import mix
import problem
import retexture
import sample

SIZES = ((176, 132), (176, 132), (224, 168), (128, 96))
EASY = 0.1  # loss of the fitted prior below which an example counts no more than in proportion
HELD_OUT_SEEDS = 1_000_000  # procedural seeds from here on are in no fit


def level(rng, width):
    """Of the network's picture: elements solve pictures that are 1 to 16 times as large."""
    return int(rng.choice(3, p=(0.3, 0.7, 0) if width < 256 else (0, 0.5, 0.5)))


def procedural(seed):
    width, height = SIZES[seed % len(SIZES)]
    return problem.of_seed(seed, width, height, level(np.random.default_rng(seed), width))


def mixed(scene, seed, rng, size):
    m = mix.mix(scene, seed, size, camera=rng.random() < 0.5)
    planes = [m[name] for name in ("I", "R", "E", "mask")]
    if rng.random() < 0.5:
        planes = [p[:, ::-1] for p in planes]
    return problem.of_picture(*planes, int(rng.integers(2**31)), scene["meta"]["kind"], level(rng, max(planes[3].shape)))


def photograph(path, seed, assets):
    """Photograph number `seed` of a path-traced sample, half of them mirrored. One of four has the paint that was rendered."""
    rng = np.random.default_rng([seed, int(path.stem)])
    scene = sample.read(path)
    if max(scene["mask"].shape) > 256 and rng.random() < 0.8:
        scene = mix.shrink(scene, 2)
    if seed % 4 > 1:
        scene = retexture.retexture(scene, rng, assets)
    if seed % 2:
        scene = mix.repaint(scene, rng)
    return mixed(scene, seed, rng, 1)


def drawn(seed, assets):
    """A picture of flat.py."""
    rng = np.random.default_rng([seed, 5])
    return mixed(flat.sample(seed, assets), seed, rng, 1 if rng.random() < 0.08 else 2)


def samples(folders, held_out):
    """Files of one side of the split."""
    files = [p for f in folders for p in pathlib.Path(f).glob("*.npz") if sample.held_out(p) == held_out]
    return sorted(files)


class Pool:
    """Examples that fits draw batches from; `add` replaces the oldest."""

    def __init__(self, folders, assets, shares, count, seed, pairs=(1.0, 0.5)):
        """shares: of photographs and of drawn pictures, among the examples; the others are procedural. pairs: as for Problem.loss."""
        self.pairs = pairs
        self.folders, self.assets, self.shares, self.count = folders, assets, shares, count
        self.rng, self.lock = np.random.default_rng(seed), threading.Lock()
        self.items, self.next, self.made = [], 0, 0
        self.maker, self.adding = concurrent.futures.ThreadPoolExecutor(1), None
        self.choices = np.random.default_rng(seed + 1)
        self.files = samples(folders, False)

    def make(self, rng):
        """Files that a renderer adds meanwhile are used, too."""
        if self.made % 100 == 0:
            self.files = samples(self.folders, False)
        which, seed = rng.random(), int(rng.integers(HELD_OUT_SEEDS))
        if which < self.shares[0] and self.files:
            return photograph(self.files[int(rng.integers(len(self.files)))], seed, self.assets)
        return drawn(seed, self.assets) if which < sum(self.shares) else procedural(seed)

    def add(self, rng):
        new = self.make(rng)
        fitted = new.loss(np.zeros((problem.FIELDS, *new.size), np.float32), self.pairs, False)[0]
        new.weight = 1 / (fitted + EASY)  # or dark rooms decide alone
        with self.lock:
            self.made += 1
            if len(self.items) < self.count:
                self.items.append(new)
            else:
                self.items[self.next] = new
                self.next = (self.next + 1) % self.count

    def add_later(self):
        """Adds one in the background; waits for the one before."""
        if self.adding:
            self.adding.result()
        self.adding = self.maker.submit(self.add, self.rng)

    def fill(self, threads=2):
        def work(rng):
            while len(self.items) < self.count:
                self.add(rng)

        workers = [threading.Thread(target=work, args=(np.random.default_rng(int(self.rng.integers(2**31))),)) for _ in range(threads)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()

    def batch(self, count):
        """Examples of one size."""
        with self.lock:
            first = self.items[int(self.choices.integers(len(self.items)))]
            alike = [p for p in self.items if p.input.shape == first.input.shape and p is not first]
            others = self.choices.permutation(len(alike))[: count - 1]
            return [first] + [alike[int(i)] for i in others]


def held_out(folders, assets, count, mixes=4):
    """The same examples in every run: `count` procedural and drawn ones each, `mixes` of each sample that is held out."""
    result = [f(HELD_OUT_SEEDS + k) for k in range(count) for f in (procedural, lambda seed: drawn(seed, assets))]
    for path in samples(folders, True):
        result += [photograph(path, 5000 + k, assets) for k in range(mixes)]
    return result
