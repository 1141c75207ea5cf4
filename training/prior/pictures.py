# SPDX-License-Identifier: LGPL-2.1-or-later
"""Examples for fits and for tests of them: procedural scenes, photographs mixed from path-traced samples, and drawn ones (../intrinsic)."""
import concurrent.futures
import multiprocessing
import pathlib
import sys
import threading

import cv2
import numpy as np

TRAINING = pathlib.Path(__file__).resolve().parents[1]
sys.path += [str(TRAINING / "intrinsic"), str(TRAINING / "couples")]
import flat
import mix
import problem
import retexture
import sample
import scenes

SIZES = ((176, 132), (176, 132), (224, 168), (128, 96))
EASY = 0.1  # loss of the fitted prior below which an example counts no more than in proportion
HELD_OUT_SEEDS = 1_000_000  # procedural seeds from here on are in no fit
LEAST_SURFACE = 0.3  # share of a part's pixels
PLAIN = 0.3  # share of one paint, among what is painted anew
COPIES = 3  # pictures that `several` makes


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


def mixed(scene, seed, rng, twin=False):
    """A list of arguments of problem.of_picture: one picture or, with twin, also one in other light, in every second twin of the same lights with
    other strengths."""
    camera, flipped = seed if rng.random() < 0.5 else None, rng.random() < 0.5
    pictures = [mix.mix(scene, seed, camera=camera)]
    if twin:
        change = np.random.default_rng(int(rng.integers(2**31))) if seed % 8 < 4 else None
        pictures.append(mix.mix(scene, seed if change else seed + HELD_OUT_SEEDS, camera=camera, change=change))
    size = level(rng, max(scene["mask"].shape))
    result = []
    for m in pictures:
        planes = [m[name][:, ::-1] if flipped else m[name] for name in ("I", "R", "E", "mask")]
        result.append((*planes, int(rng.integers(2**31)), scene["meta"]["kind"], size))
    return result


def painted(scene, rng):
    """Other colors and contrast, or hardly any."""
    return mix.plain(scene, rng) if rng.random() < PLAIN else mix.repaint(scene, rng)


def several(scene, seed, rng, twins):
    """A picture of a scene, or three: one more in other light, and one more of other paint."""
    first = mixed(painted(scene, rng) if seed % 2 else scene, seed, rng, twins)
    return first + mixed(painted(scene, rng), seed + 1, rng) if twins else first


def photographs(path, seed, assets, twins=False):
    """One or three pictures of a path-traced sample; half of the samples have other paint on their surfaces. Arguments of problem.of_picture."""
    rng = np.random.default_rng([seed, int(path.stem)])
    scene = sized(sample.read(path), rng)
    return several(retexture.retexture(scene, rng, assets) if seed % 4 > 1 else scene, seed, rng, twins)


def drawn(seed, assets, twins=False):
    """The same of a drawing of flat.py."""
    rng = np.random.default_rng([seed, 5])
    return several(sized(flat.sample(seed, assets), rng), seed, rng, twins)


def samples(folders, held_out):
    """Files of one side of the split."""
    files = [p for f in folders for p in pathlib.Path(f).glob("*.npz") if sample.held_out(p) == held_out]
    return sorted(files)


class Pool:
    """Examples that fits draw batches from. A thread and processes replace the oldest: `fresh` of them for each batch, until `stop`."""

    def __init__(self, folders, assets, shares, count, seed, weights=(1.0, 0.5, 0.0), fresh=1.2):
        """shares: of photographs and of drawn pictures, among what is made; the others are procedural. weights: as for Problem.loss."""
        self.weights, self.fresh, self.wanted = weights, fresh, threading.Semaphore(0)
        self.owed = 0.0
        self.folders, self.assets, self.shares, self.count = folders, assets, shares, count
        self.rng, self.lock = np.random.default_rng(seed), threading.Lock()
        self.items, self.next, self.made = [], 0, 0
        self.choices = np.random.default_rng(seed + 1)
        self.maker, self.renewing = concurrent.futures.ThreadPoolExecutor(2), None
        self.painter = concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("spawn"), cv2.setNumThreads, (0,))
        self.stopped = False

    def make(self, rng):
        """Files that a renderer adds meanwhile are used, too."""
        which, seed = rng.random(), int(rng.integers(HELD_OUT_SEEDS - COPIES))
        if which >= sum(self.shares):
            return [procedural(seed)]
        if which < self.shares[0] and (files := samples(self.folders, False)):
            job = self.painter.submit(photographs, files[int(rng.integers(len(files)))], seed, self.assets, True)
        else:
            job = self.painter.submit(drawn, seed, self.assets, True)
        first, twin, other = (problem.of_picture(*picture) for picture in job.result())
        first.twin, twin.twin = twin, first
        return [first, twin, other]

    def add(self, rng):
        """Returns how many it added."""
        pictures = self.make(rng)
        for new in pictures:
            fitted = new.loss(np.zeros((problem.FIELDS, *new.size), np.float32), self.weights, False)[0]
            new.weight = 1 / (fitted + EASY)  # or dark rooms decide alone
            with self.lock:
                self.made += 1
                if len(self.items) < self.count:
                    self.items.append(new)
                else:
                    self.items[self.next] = new
                    self.next = (self.next + 1) % self.count
        return len(pictures)

    def fill(self):
        def work(rng):
            while len(self.items) < self.count:
                self.add(rng)

        list(self.maker.map(work, [np.random.default_rng(int(self.rng.integers(2**31))) for _ in range(2)]))  # raises what they raise
        self.renewing = self.maker.submit(self.renew)

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
        self.renewing.result()
        self.painter.shutdown()

    def batch(self, count):
        """Examples of one size. Raises what went wrong in making new ones."""
        if self.renewing.done():
            self.renewing.result()
        self.owed += self.fresh
        for _ in range(int(self.owed)):
            self.wanted.release()
        self.owed %= 1
        with self.lock:
            first = self.items[int(self.choices.integers(len(self.items)))]
            alike = [p for p in self.items if p.input.shape == first.input.shape and p is not first]
            order = [first] + [alike[int(i)] for i in self.choices.permutation(len(alike))[:count]]
        batch = []
        for example in order:  # with their twins, so that neither has changed since the other was seen
            batch += [e for e in (example, example.twin) if e and e not in batch]
        return batch[:count]


def held_out(folders, assets, count, couples=(), mixes=2):
    """The same examples in every run: `count` procedural and drawn ones each, `mixes` of each sample that is held out, and all couples."""
    result = []
    for k in range(count):
        result += [procedural(HELD_OUT_SEEDS + k), problem.of_picture(*drawn(HELD_OUT_SEEDS + k, assets)[0])]
    for path in samples(folders, True):
        result += [problem.of_picture(*photographs(path, 5000 + k, assets)[0]) for k in range(mixes)]
    triples = (triple(p, k) for k, p in enumerate(p for f in couples for p in sorted(pathlib.Path(f).glob("*.npz"))))
    return result + [t for t in triples if t]


def triple(path, seed):
    """Of a file of ../couples, or None if hardly any light or paint was added."""
    rng, found = np.random.default_rng([seed, 3]), scenes.read(path)
    if not (found.has_light and found.has_paint):
        return None
    images, ratio, masks = found.pictures, found.light, found.usable
    if rng.random() < 0.5:
        images, ratio, masks = images[:, :, ::-1], ratio[:, ::-1], [m[:, ::-1] for m in masks]
    size = int(rng.random() < 0.5)
    pictures = [problem.of_picture(image, image, ratio, mask, int(rng.integers(2**31)), "photograph", size) for image, mask in zip(images, masks)]
    return problem.Triple(pictures, found.base, ratio, pathlib.Path(path).parent.name)


class Couples:
    """Triples that fits draw batches from: like Pool."""

    def __init__(self, folders, count, seed, fresh):
        self.files = sorted(p for f in folders for p in pathlib.Path(f).glob("*.npz"))
        self.fresh, self.rng, self.items, self.owed = fresh, np.random.default_rng(seed), [], 0.0
        self.maker = concurrent.futures.ThreadPoolExecutor(2)
        if self.files:
            self.items = [t for t in self.maker.map(lambda job: triple(*job), [self.job() for _ in range(count)]) if t]
        self.coming, self.next = [], 0

    def job(self):
        return self.files[int(self.rng.integers(len(self.files)))], int(self.rng.integers(2**31))

    def batch(self, count):
        """Triples of one size."""
        self.owed += self.fresh * count
        for _ in range(int(self.owed)):
            self.coming.append(self.maker.submit(triple, *self.job()))
        self.owed %= 1
        while len(self.coming) > 16 or self.coming and self.coming[0].done():
            new = self.coming.pop(0).result()
            if new:
                self.items[self.next] = new
                self.next = (self.next + 1) % len(self.items)
        size = self.items[int(self.rng.integers(len(self.items)))].pictures[0].input.shape
        alike = [t for t in self.items if t.pictures[0].input.shape == size]
        return [alike[int(k)] for k in self.rng.permutation(len(alike))[:count]]

    def stop(self):
        self.maker.shutdown()
