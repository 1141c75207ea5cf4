# SPDX-License-Identifier: LGPL-2.1-or-later
"""What matroskamux of GStreamer 1.22 to 1.26 writes otherwise than it is: texts of tags with spaces or letters beyond ASCII in quotes, and
escaped; the light of a mastering display as a fifth."""
import functools
import os
import re
import struct

from gi.repository import Gst

SEGMENT, _TAGS, _TAG, _SIMPLE, _STRING = 0x18538067, 0x1254C367, 0x7373, 0x67C8, 0x4487
_MASTERING = (SEGMENT, 0x1654AE6B, 0xAE, 0xE0, 0x55B0, 0x55D0)  # tracks, track, video, color
_LIGHT = {0x55D9: 0, 0x55DA: 1}  # the highest, the lowest
_ESCAPE = re.compile(rb"\\([0-3][0-7]{2}|.)", re.DOTALL)


def plain(text):
    """What a text was before it was escaped, bytes to bytes."""
    if len(text) < 2 or text[:1] != b'"' or text[-1:] != b'"':
        return text
    return _ESCAPE.sub(lambda found: bytes([int(found[1], 8)]) if len(found[1]) == 3 else found[1], text[1:-1])


def _number(file, marker):
    """A number of EBML of one to eight bytes, with its `marker` bit or without; None where it ends or is not known."""
    first = file.read(1)
    if not first or not first[0]:
        return None
    more = 8 - first[0].bit_length()
    rest = file.read(more)
    number = int.from_bytes(first + rest, "big")
    if len(rest) < more:
        return None
    if marker:
        return number
    number &= (1 << 7 * (more + 1)) - 1
    return None if number == (1 << 7 * (more + 1)) - 1 else number


def children(file, end):
    """(ID, end) of the elements up to a place in the file, which is at the start of their data; of damaged ones no more than there is."""
    while file.tell() < end:
        name, size = _number(file, True), _number(file, False)
        if name is None or size is None or file.tell() > end:
            return
        behind = min(file.tell() + size, end)
        yield name, behind
        file.seek(behind)


def find(file, end, names):
    """(start, end) of the data of elements at a path of IDs, from a place in the file up to `end`."""
    for name, child in children(file, end):
        if name == names[0]:
            if len(names) == 1:
                yield file.tell(), child
            else:
                yield from find(file, child, names[1:])


@functools.cache
def muxer_escapes():
    """Whether matroskamux of this GStreamer does so."""
    pipeline = Gst.parse_launch("videotestsrc num-buffers=1 ! video/x-raw,format=I420,width=16,height=16 ! matroskamux name=mux ! "
                                "appsink name=take sync=false")
    tags = Gst.TagList.new_empty()
    tags.add_value(Gst.TagMergeMode.REPLACE, Gst.TAG_TITLE, "two words")
    pipeline.get_by_name("mux").merge_tags(tags, Gst.TagMergeMode.REPLACE)
    pipeline.set_state(Gst.State.PLAYING)
    take, found = pipeline.get_by_name("take"), b""
    while sample := take.emit("try-pull-sample", 5 * Gst.SECOND):
        buffer = sample.get_buffer()
        found += buffer.extract_dup(0, buffer.get_size())
    pipeline.set_state(Gst.State.NULL)
    return b"two\\ words" in found


def mend_tags(path):
    """Writes the texts of a complete file as they are, if the muxer escapes them. They are shorter then; zeros fill up, as Matroska allows."""
    if not muxer_escapes():
        return
    with open(path, "r+b") as file:
        size = os.path.getsize(path)
        for start, end in list(find(file, size, (SEGMENT, _TAGS, _TAG, _SIMPLE, _STRING))):
            file.seek(start)
            text = file.read(end - start)
            file.seek(start)
            file.write(plain(text.rstrip(b"\0")).ljust(len(text), b"\0"))


def mend_mastering(path, light):
    """Writes the highest and the lowest luminance of the display that a video was mastered on, in cd/m², as they are."""
    with open(path, "r+b") as file:
        for start, end in list(find(file, os.path.getsize(path), _MASTERING)):
            file.seek(start)
            for name, behind in list(children(file, end)):
                if name in _LIGHT:
                    file.seek(behind - 8)
                    file.write(struct.pack(">d", light[_LIGHT[name]]))
