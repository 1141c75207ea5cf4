#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Readers in Python on inputs that are changed at random, for INVERSE_FUZZ_SECONDS (4):

  python_readers.py project|tags     project files of inverse-play; tags of Matroska files, as inverse-transcode mends them

What a reader does not refuse by its own error fails, with the input in a file that is named. INVERSE_TEST_SEED chooses the inputs.
"""
import json
import os
import pathlib
import random
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
for folder in ("common", "player", "transcode"):
    sys.path.insert(0, str(ROOT / folder))
SKIPPED = 77
try:
    import gi
    gi.require_version("Gst", "1.0")
    from gi.repository import Gst
    from inverse_play import elements, project
    from inverse_transcode import marks, matroska
except (ImportError, ValueError) as error:
    print(f"GStreamer for Python is missing ({error}): install python3-gi, gir1.2-gst-plugins-base-1.0")
    sys.exit(SKIPPED)
Gst.init(None)

WORDS = [b'"', b"{", b"}", b"[", b"]", b",", b":", b"null", b"true", b"1e999", b"-1", b"NaN", b"\\ud800", b"\\u0000", b'"editors"',
         b'"intrinsicrecolor"', b'"properties"', b"\0", b"\xff", b"\x45\xa3", b"\x44\x87", b"\x01\xff\xff\xff\xff\xff\xff\xff"]


def changed(data, chance):
    """The data with up to eight changes: a byte, a word put in, a part taken out or doubled."""
    data = bytearray(data)
    for _ in range(chance.randint(1, 8)):
        place, length = chance.randint(0, len(data)), chance.randint(1, 32)
        kind = chance.randrange(4)
        if kind == 0 and place < len(data):
            data[place] = chance.randrange(256)
        elif kind == 1:
            data[place:place] = chance.choice(WORDS)
        elif kind == 2:
            del data[place:place + length]
        else:
            data[place:place] = data[place:place + length]
    return bytes(data)


def read_project(path):
    """Loads a project, and what it would be saved as: both are the same."""
    try:
        loaded = project.load(path)
    except elements.ElementError:
        return
    project.demands(loaded)
    again = project.from_data(json.loads(json.dumps(project.to_data(loaded))))
    assert again == loaded, "it is loaded otherwise when it was saved"


def read_tags(path):
    """Reads the marks of a file's tracks and mends its tags; its length stays."""
    size = os.path.getsize(path)
    marks.left_out(path)
    matroska.mend_tags(path)
    assert os.path.getsize(path) == size, "the file has another length"


def projects():
    """Project files with every editor, and with wrong ones."""
    whole = project.Project(source="test", split=0.5)
    for factory in elements.editors():
        whole = whole.with_editors((*whole.editors, project.Element(whole.new_name(factory), factory)))
    strokes = json.dumps([{"kind": "shading", "radius": 12, "points": [[100, 80], [120, 80]]}])
    edited = whole.with_editors(whole.editors[:1]).with_element(whole.decomposer.with_property("strokes::list", strokes))
    return [json.dumps(project.to_data(p)).encode() for p in (project.Project(), edited, whole)] + [b'{"version":1,"editors":[{}]}', b"[" * 2000]


def matroska_files():
    """A short video with tags, as the muxer writes it, and one of tags alone."""
    def element(name, body):
        return name + (0x10000000 | len(body)).to_bytes(4, "big") + body
    text = element(b"\x44\x87", b'"two\\ words \\303\\244"')
    segment_tags = element(b"\x12\x54\xc3\x67", element(b"\x73\x73", element(b"\x67\xc8", element(b"\x45\xa3", b"TITLE") + text)))
    with tempfile.NamedTemporaryFile(suffix=".mkv") as file:
        pipeline = Gst.parse_launch("videotestsrc num-buffers=2 ! video/x-raw,width=16,height=16 ! matroskamux name=mux ! filesink name=file")
        pipeline.get_by_name("file").set_property("location", file.name)
        tags = Gst.TagList.new_empty()
        tags.add_value(Gst.TagMergeMode.REPLACE, Gst.TAG_TITLE, "two words")
        pipeline.get_by_name("mux").merge_tags(tags, Gst.TagMergeMode.REPLACE)
        pipeline.set_state(Gst.State.PLAYING)
        pipeline.get_bus().timed_pop_filtered(20 * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
        pipeline.set_state(Gst.State.NULL)
        whole = pathlib.Path(file.name).read_bytes()
    assert b"two" in whole
    return [element(b"\x18\x53\x80\x67", segment_tags), whole]


def main(kind):
    """Runs one kind of reader; returns the exit status."""
    reader, seeds = {"project": (read_project, projects), "tags": (read_tags, matroska_files)}[kind]
    matroska.muxer_escapes = lambda: True  # mend, whatever this GStreamer's muxer does
    seeds = seeds()
    chance = random.Random(int(os.environ.get("INVERSE_TEST_SEED", "0")))
    end, count = time.monotonic() + float(os.environ.get("INVERSE_FUZZ_SECONDS", "4")), 0
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as folder:
        path = os.path.join(folder, "input")
        while time.monotonic() < end or count < len(seeds):
            data = seeds[count] if count < len(seeds) else changed(chance.choice(seeds), chance)
            if count >= len(seeds) and chance.random() < 0.1 and len(seeds) < 500:
                seeds.append(data)  # changes add up
            pathlib.Path(path).write_bytes(data)
            try:
                reader(path)
            except Exception as error:  # pylint: disable=broad-except
                kept = os.path.join(tempfile.mkdtemp(), kind)
                pathlib.Path(kept).write_bytes(data)
                print(f"FAILED on {kept}: {error!r}")
                raise
            count += 1
    print(f"{count} inputs")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
