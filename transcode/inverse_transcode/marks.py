# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a file says of its tracks that GStreamer neither reads nor writes."""
import struct

from . import matroska

_TRACKS, _CLUSTER, _ENTRY, _NUMBER, _KIND = 0x1654AE6B, 0x1F43B675, 0xAE, 0xD7, 0x83
_DEFAULT = 0x88
# Of a track: name of the flag, and the value that it has if it is not written, which is no news.
_FLAGS = {_DEFAULT: ("not default", 1), 0x55AA: ("forced", 0), 0xB9: ("disabled", 1), 0x55AB: ("for the hearing impaired", 0),
          0x55AC: ("for the visually impaired", 0), 0x55AD: ("text descriptions", 0), 0x55AE: ("original language", 0), 0x55AF: ("commentary", 0)}
_KINDS = {1: "video", 2: "sound", 17: "subtitles"}
_BOXES = {b"moov": (b"trak",), b"trak": (b"mdia",), b"mdia": (b"hdlr",)}  # of MP4, on the way to the kind of a track


def left_out(path):
    """Warnings about a file, a text each. Throws OSError."""
    with open(path, "rb") as file:
        head = file.read(12)
        end = file.seek(0, 2)
        file.seek(0)
        if head[:4] == b"\x1aE\xdf\xa3":
            tracks = [_track(file, start, stop) for start, stop in list(_entries(file, end))]
            flags = [text for track in tracks for text in _flags(track, tracks)]
            return [f"marks of tracks are left out, as GStreamer writes none: {', '.join(flags)}"] if flags else []
        if head[4:8] == b"ftyp" and b"tmcd" in _handlers(file, end, b"moov"):
            return ["the time code is left out, as GStreamer does not read it"]
    return []


def _entries(file, end):
    """(start, end) of each track of Matroska."""
    for start, stop in matroska.find(file, end, (matroska.SEGMENT,)):
        file.seek(start)
        for name, behind in matroska.children(file, stop):
            if name == _TRACKS:
                yield from matroska.find(file, behind, (_ENTRY,))
            elif name == _CLUSTER:
                return  # tracks come before


def _track(file, start, stop):
    """Numbers of a track by their IDs."""
    file.seek(start)
    return {name: int.from_bytes(file.read(min(end - file.tell(), 8)), "big") for name, end in matroska.children(file, stop)
            if name in _FLAGS or name in (_NUMBER, _KIND)}


def _flags(track, tracks):
    """Flags of one of the tracks, in words."""
    others = [other for other in tracks if other.get(_KIND) == track.get(_KIND)]
    for name, (words, usual) in _FLAGS.items():
        if track.get(name, usual) != usual and not (name == _DEFAULT and not any(other.get(name, usual) for other in others)):
            yield f"{words} ({_KINDS.get(track.get(_KIND), 'track')} {track.get(_NUMBER, '')})"


def _handlers(file, end, wanted):
    """Kinds of the tracks of an MP4 file, of four letters."""
    while (start := file.tell()) + 8 <= end:
        size, name = struct.unpack(">I4s", file.read(8))
        if size == 1:
            (size,) = struct.unpack(">Q", file.read(8).rjust(8, b"\0"))
        stop = min(start + size, end) if size else end
        if stop < start + 8:
            return
        if name == wanted == b"hdlr":
            yield file.read(12)[8:12]
        elif name == wanted:
            for below in _BOXES[name]:
                yield from _handlers(file, stop, below)
        file.seek(stop)
