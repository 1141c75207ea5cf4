# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a file says of its tracks that GStreamer does not tell or write."""
import struct

from . import matroska

_TRACKS, _CLUSTER, _ENTRY, _NUMBER, _KIND = 0x1654AE6B, 0x1F43B675, 0xAE, 0xD7, 0x83
_DEFAULT = 0x88
# Of a track: name of the flag, and the value that it has if it is not written, which is no news.
_FLAGS = {_DEFAULT: ("not default", 1), 0x55AA: ("forced", 0), 0xB9: ("disabled", 1), 0x55AB: ("for the hearing impaired", 0),
          0x55AC: ("for the visually impaired", 0), 0x55AD: ("text descriptions", 0), 0x55AE: ("original language", 0), 0x55AF: ("commentary", 0)}
_KINDS = {1: "video", 2: "sound", 17: "subtitles"}


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
        return list(_left_out_of_mp4(file, end)) if head[4:8] == b"ftyp" else []


def _left_out_of_mp4(file, end):
    """Of a file, from its start."""
    if b"tmcd" in [file.read(12)[8:] for _ in _find(file, end, (b"moov", b"trak", b"mdia", b"hdlr"))]:
        yield "the time code is left out, as GStreamer does not read it"
    for path in ((b"moov", b"udta", b"chpl"), (b"moov", b"trak", b"tref", b"chap")):
        file.seek(0)
        if any(_find(file, end, path)):
            yield "chapters are left out, as GStreamer does not read them from MP4"
            return


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


def _boxes(file, end):
    """(name, end) of the boxes of MP4 up to a place in the file, which is at the start of their data; the last one may end behind it."""
    while (start := file.tell()) + 8 <= end:
        size, name = struct.unpack(">I4s", file.read(8))
        if size == 1:
            (size,) = struct.unpack(">Q", file.read(8).rjust(8, b"\0"))
        stop = start + size if size else end
        if stop < start + 8:
            return
        yield name, stop
        file.seek(stop)


def _find(file, end, names):
    """(start, end) of the data of boxes at a path of names, as matroska.find."""
    for name, stop in _boxes(file, end):
        if name == names[0]:
            if len(names) == 1:
                yield file.tell(), min(stop, end)
            else:
                yield from _find(file, min(stop, end), names[1:])


def video_seconds(path):
    """How long a file says that its video is, where that is of the video alone: MP4, AVI; else 0. Throws OSError."""
    with open(path, "rb") as file:
        head = file.read(1 << 12)
        end = file.seek(0, 2)
        file.seek(0)
        if head[4:8] == b"ftyp":
            return _mp4_seconds(file, end)
    place = head.find(b"vids", 0, len(head) - 36) if head[:4] == b"RIFF" and head[8:12] == b"AVI " else -1
    if place < 0:
        return 0
    scale, rate, start, length = struct.unpack_from("<4I", head, place + 20)
    return (start + length) * scale / rate if rate else 0


def _packet(head):
    """Bytes of a packet of MPEG-TS, by the begin of a file; 0 if it is of another kind."""
    return next((n for n in (188, 192, 204) if all(head[k * n + (4 if n == 192 else 0):][:1] == b"G" for k in range(4))), 0)


def counts_from_elsewhere(path):
    """Whether the length of a file is only known with the time that its clock begins at: MPEG-TS, MPEG-PS. Throws OSError."""
    with open(path, "rb") as file:
        head = file.read(5 * 204)
    return bool(_packet(head)) or head[:4] == b"\0\0\1\xba"


def ends_inside(path):
    """Whether a file ends within a page of Ogg, a packet of MPEG-TS or a box of MP4, or before its Ogg stream does. Throws OSError."""
    with open(path, "rb") as file:
        head = file.read(5 * 204)
        size = file.seek(0, 2)
        file.seek(0)
        if head[4:8] == b"ftyp":
            stop = 0
            for _, stop in _boxes(file, size):
                pass
            return stop != size
        file.seek(max(0, size - (1 << 17)))  # a page has less than 65308 bytes
        tail = file.read()
    if head[:4] == b"OggS":
        page = tail[tail.rfind(b"OggS"):]
        lengths = page[27:27 + page[26]] if len(page) > 26 else b""
        return len(page) < 27 or 27 + len(lengths) + sum(lengths) != len(page) or not page[5] & 4
    return bool(_packet(head)) and size % _packet(head) != 0


def shown_seconds(path):
    """How long players say that an MP4 is; 0 where it does not say. Throws OSError."""
    with open(path, "rb") as file:
        end = file.seek(0, 2)
        file.seek(0)
        scale, ticks = _movie(file, end)
    return ticks / scale if scale else 0


def _movie(file, end):
    """Units a second of an MP4, and its length in them; 0 where it does not say."""
    for start, _ in _find(file, end, (b"moov", b"mvhd")):
        scale = _numbers(file, 12, ">I", 20, ">I")
        file.seek(start)
        return scale, _numbers(file, 16, ">I", 24, ">Q")
    return 0, 0


def _mp4_seconds(file, end):
    """Of the longest track of video, with its edits; 0 where fragments have it."""
    (scale, _), ticks = _movie(file, end), [0]
    file.seek(0)
    for start, stop in _find(file, end, (b"moov", b"trak")):
        kinds = [file.read(12)[8:] for _ in _find(file, stop, (b"mdia", b"hdlr"))]
        file.seek(start)
        for _ in _find(file, stop, (b"tkhd",)):
            length = _numbers(file, 20, ">I", 28, ">Q")
            ticks.append(length if b"vide" in kinds and length not in (0xFFFFFFFF, 0xFFFFFFFFFFFFFFFF) else 0)
    return max(ticks) / (scale or 1)


def _numbers(file, place, form, place_1, form_1):
    """A number of a box: where it is and its form in version 0 and 1; 0 where the box is too short."""
    data = file.read(place_1 + 8)
    place, form = (place_1, form_1) if data[:1] == b"\1" else (place, form)
    return struct.unpack_from(form, data, place)[0] if len(data) >= place + struct.calcsize(form) else 0
