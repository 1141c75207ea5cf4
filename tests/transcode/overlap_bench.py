# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the overlap of chunks buys: videos are decomposed undivided and in chunks, and the layers are compared.

    tests/transcode/overlap_bench.py [--chunk SECONDS] [--overlaps N,...] [--divide-shots] [--cut SECONDS] VIDEO... [-- ELEMENTS]

In ./dev shell. A row for each overlap, over all videos: "twice", the share of frames that are worked twice; "step", the largest mean of the
difference of ln reflectance of a chunk (for shading it is the opposite); then what is left without that step, as rms of ln reflectance and ln
shading (values above 8 of 255) of the first frame of a chunk, of its first second, and after that, of the worst chunk; "equal", the share of
frames with the same bytes. First chunks do not count. --cut: one video of six shots of that length is made of the videos, in turn."""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import numpy

from case import ROOT
from raw_video import frames, read_raw, write_raw

LAYERS = ("reflectance", "shading")
TOOL = ROOT / "transcode" / "inverse-transcode"
VALUE = (numpy.arange(256) + 1e-9) / 255
LOG = numpy.log(numpy.where(VALUE > 0.04, ((VALUE + 0.055) / 1.055) ** 2.4, VALUE / 12.92))  # of linear light


def cut(videos, seconds, path):
    """Writes a video of six shots, of the videos in turn."""
    form = "video/x-raw,format=I420,width=640,height=480,framerate=30/1,pixel-aspect-ratio=1/1"
    length, shots = round(30 * seconds), []
    found = [list(read_raw(video, form)) for video in videos]
    for shot in range(6):
        own = found[shot % len(found)]
        begin = shot // len(found) * length % max(len(own) - length, 1)
        shots += own[begin:begin + length]
    write_raw(path, shots)


def differences(one, other):
    """Of a layer's frames: time, mean and mean square of the difference of ln, and whether they are equal."""
    for (time, first), (same, second) in zip(frames(*one), frames(*other), strict=True):
        if abs(time - same) > 2e6:
            raise AssertionError(f"{one[0]}: frames at {time} and {same} ns")
        if numpy.array_equal(first, second):
            yield time, 0.0, 0.0, True
            continue
        valid = numpy.minimum(first, second) > 8
        difference = LOG[second[valid]] - LOG[first[valid]] if valid.any() else numpy.zeros(1)
        yield time, difference.mean(), (difference ** 2).mean(), False


def compare(whole, joined, chunks):
    """A row for each chunk but the first, and the share of equal frames."""
    rows, equal = [[] for _ in chunks[1:]], []
    for layer in range(len(LAYERS)):
        found = list(differences((whole, layer), (joined, layer)))
        equal += [same for *_, same in found]
        for row, chunk in zip(rows, chunks[1:]):
            inside = numpy.array([f[:3] for f in found if chunk["start"] <= f[0] < (chunk["end"] or float("inf"))])
            step = inside[:, 1].mean()
            rest = numpy.maximum(inside[:, 2] - 2 * step * inside[:, 1] + step * step, 0)
            early = inside[:, 0] < chunk["start"] + 1e9
            row += [abs(step), *(numpy.sqrt(part.mean()) if len(part) else 0.0 for part in (rest[:1], rest[early], rest[~early]))]
    return rows, sum(equal) / len(equal)


def main():
    words, chain = sys.argv[1:], ["intrinsicdecomp"]
    if "--" in words:
        words, chain = words[:words.index("--")], words[words.index("--") + 1:]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--chunk", default="1.5")
    parser.add_argument("--overlaps", default="0,1,2,4,8,16,32,64")
    parser.add_argument("--divide-shots", action="store_true")
    parser.add_argument("--cut", type=float)
    parser.add_argument("videos", nargs="+")
    arguments = parser.parse_args(words)
    common = [TOOL, "--quiet", "--video", "ffv1", "--audio", "none", "--layers", ",".join(LAYERS)]
    shots = ["--divide-shots"] if arguments.divide_shots else []
    print("overlap  twice    step   first: R    S      second: R   S      after: R    S      equal")
    with tempfile.TemporaryDirectory() as folder:
        if arguments.cut:
            cut(arguments.videos, arguments.cut, os.path.join(folder, "cut.mkv"))
            arguments.videos = [os.path.join(folder, "cut.mkv")]
        whole = [os.path.join(folder, f"{k}.mkv") for k in range(len(arguments.videos))]
        for video, path in zip(arguments.videos, whole):
            subprocess.run([*common, "-o", path, video, "--", *chain], check=True)
        for overlap in arguments.overlaps.split(","):
            rows, twice, length, equal = [], 0, 0, []
            for k, video in enumerate(arguments.videos):
                batch, joined = os.path.join(folder, f"b{overlap}.{k}"), os.path.join(folder, f"j{overlap}.{k}.mkv")
                divided = ["--batch", batch, "--chunk", arguments.chunk, "--overlap", overlap, *shots, "-o", joined]
                subprocess.run([*common, *divided, video, "--", *chain], check=True)
                subprocess.run(["make", "-s", "-C", batch], check=True, stderr=subprocess.DEVNULL)
                with open(os.path.join(batch, "manifest.json"), encoding="ascii") as read:
                    chunks = [task["chunk"] for task in json.load(read)["tasks"] if "chunk" in task]
                found, same = compare(whole[k], joined, chunks)
                rows += found
                equal.append(same)
                twice += sum(c["start"] - c["lead"] for c in chunks)
                length += max(time for time, *_ in frames(joined, 0))
            step, *rest = numpy.max(numpy.array(rows)[:, [0, 1, 5, 2, 6, 3, 7]], axis=0)
            print(f"{overlap:>7} {100 * twice / length:5.1f} %  {step:.4f}   " +
                  "   ".join(f"{rest[k]:.4f} {rest[k + 1]:.4f}" for k in (0, 2, 4)) +
                  f"   {100 * numpy.mean(equal):5.1f} %  ({len(rows)} chunks)", flush=True)


if __name__ == "__main__":
    main()
