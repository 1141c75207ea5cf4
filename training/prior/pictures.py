# SPDX-License-Identifier: LGPL-2.1-or-later
"""Examples for fits and for tests of them: procedural scenes, photographs mixed from path-traced samples, and drawn ones (../intrinsic)."""
import concurrent.futures
import multiprocessing
import pathlib
import sys
import threading

import cv2
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
LEAST_SURFACE = 0.3  # share of a part's pixels
COPIES = 3  # pictures of one drawing or sample, each in its own light


def level(rng, width):
    """Of the network's picture: elements solve pictures that are 1 to 16 times as large."""
    return int(rng.choice(3, p=(0.1, 0.7, 0.2) if width < 256 else (0, 0.5, 0.5)))


def procedural(seed):
    width, height = SIZES[seed % len(SIZES)]
    return problem.of_seed(seed, width, height, level(np.random.default_rng(seed), width))


def window(scene, rng):
    """A part of a scene, of the size that most examples have."""
    height, width = scene["mask"].shape
    h, w = (SIZES[0][::-1] if width > height else SIZES[0])
    y, x = int(rng.integers(height - h + 1)), int(rng.integers(width - w + 1))
    part = np.s_[..., y : y + h, x : x + w, :]
    return {**scene, **{k: scene[k][part] for k in ("R", "S", "N")}, **{k: scene[k][y : y + h, x : x + w] for k in ("Z", "mask")}}


def sized(scene, rng):
    """A large scene at half its size, or a part of it, or rarely all of it."""
    if max(scene["mask"].shape) < 256:
        return scene
    which = rng.random()
    if which > 0.92:
        return scene
    part = window(scene, rng) if which > 0.55 else None
    return part if part and part["mask"].mean() > LEAST_SURFACE else mix.shrink(scene, 2)


def mixed(scene, seed, rng):
    """Arguments of problem.of_picture."""
    m = mix.mix(scene, seed, camera=rng.random() < 0.5)
    planes = [m[name] for name in ("I", "R", "E", "mask")]
    if rng.random() < 0.5:
        planes = [p[:, ::-1] for p in planes]
    return *planes, int(rng.integers(2**31)), scene["meta"]["kind"], level(rng, max(planes[3].shape))


def photographs(path, seed, assets, count=1):
    """`count` photographs, each in its own light, of a path-traced sample; half of the samples have other paint on their surfaces, and every second
    photograph has other colors and contrast. Arguments of problem.of_picture."""
    rng = np.random.default_rng([seed, int(path.stem)])
    scene = sized(sample.read(path), rng)
    if seed % 4 > 1:
        scene = retexture.retexture(scene, rng, assets)
    return [mixed(mix.repaint(scene, rng) if (seed + k) % 2 else scene, seed + k, rng) for k in range(count)]


def drawn(seed, assets, count=1):
    """`count` pictures of a drawing of flat.py, likewise."""
    rng = np.random.default_rng([seed, 5])
    scene = sized(flat.sample(seed, assets), rng)
    return [mixed(mix.repaint(scene, rng) if k else scene, seed + k, rng) for k in range(count)]


def samples(folders, held_out):
    """Files of one side of the split."""
    files = [p for f in folders for p in pathlib.Path(f).glob("*.npz") if sample.held_out(p) == held_out]
    return sorted(files)


class Pool:
    """Examples that fits draw batches from. A thread and processes replace the oldest: `fresh` of them for each batch, until `stop`."""

    def __init__(self, folders, assets, shares, count, seed, pairs=(1.0, 0.5), fresh=1.2):
        """shares: of photographs and of drawn pictures, among what is made; the others are procedural. pairs: as for Problem.loss."""
        self.pairs, self.fresh, self.wanted = pairs, fresh, threading.Semaphore(0)
        self.owed = 0.0
        self.folders, self.assets, self.shares, self.count = folders, assets, shares, count
        self.rng, self.lock = np.random.default_rng(seed), threading.Lock()
        self.items, self.next, self.made = [], 0, 0
        self.choices = np.random.default_rng(seed + 1)
        self.painter = concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("spawn"), cv2.setNumThreads, (0,))
        self.stopped = False

    def make(self, rng):
        """Files that a renderer adds meanwhile are used, too."""
        which, seed = rng.random(), int(rng.integers(HELD_OUT_SEEDS - COPIES))
        if which >= sum(self.shares):
            return [procedural(seed)]
        if which < self.shares[0] and (files := samples(self.folders, False)):
            job = self.painter.submit(photographs, files[int(rng.integers(len(files)))], seed, self.assets, COPIES)
        else:
            job = self.painter.submit(drawn, seed, self.assets, COPIES)
        return [problem.of_picture(*picture) for picture in job.result()]

    def add(self, rng):
        """Returns how many it added."""
        pictures = self.make(rng)
        for new in pictures:
            fitted = new.loss(np.zeros((problem.FIELDS, *new.size), np.float32), self.pairs, False)[0]
            new.weight = 1 / (fitted + EASY)  # or dark rooms decide alone
            with self.lock:
                self.made += 1
                if len(self.items) < self.count:
                    self.items.append(new)
                else:
                    self.items[self.next] = new
                    self.next = (self.next + 1) % self.count
        return len(pictures)

    def fill(self, threads=2):
        def work(rng):
            while len(self.items) < self.count:
                self.add(rng)

        workers = [threading.Thread(target=work, args=(np.random.default_rng(int(self.rng.integers(2**31))),)) for _ in range(threads)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.renewer = threading.Thread(target=self.renew, daemon=True)
        self.renewer.start()

    def renew(self):
        while True:
            self.wanted.acquire()
            if self.stopped:
                return
            for _ in range(self.add(self.rng) - 1):
                self.wanted.acquire()

    def stop(self):
        self.stopped = True
        self.wanted.release(COPIES)
        self.renewer.join()
        self.painter.shutdown()

    def batch(self, count):
        """Examples of one size."""
        self.owed += self.fresh
        for _ in range(int(self.owed)):
            self.wanted.release()
        self.owed %= 1
        with self.lock:
            first = self.items[int(self.choices.integers(len(self.items)))]
            alike = [p for p in self.items if p.input.shape == first.input.shape and p is not first]
            others = self.choices.permutation(len(alike))[: count - 1]
            return [first] + [alike[int(i)] for i in others]


def held_out(folders, assets, count, mixes=4):
    """The same examples in every run: `count` procedural and drawn ones each, `mixes` of each sample that is held out."""
    result = []
    for k in range(count):
        result += [procedural(HELD_OUT_SEEDS + k), problem.of_picture(*drawn(HELD_OUT_SEEDS + k, assets)[0])]
    for path in samples(folders, True):
        result += [problem.of_picture(*photographs(path, 5000 + k, assets)[0]) for k in range(mixes)]
    return result
