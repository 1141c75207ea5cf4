# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is wrong with a PNG or JPEG picture. GStreamer's decoders leave out such ones, or show the one before, without a word."""
import os
import struct
import zlib

MAX_SIDE = 32767  # of the elements
PLAIN_BYTES = 64 << 20  # so large may any file be
_PNG = b"\x89PNG\r\n\x1a\n"
_SAMPLES = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}  # of a pixel, by the type of color
_ADAM7 = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))  # x, y, steps
_SOF = {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}
_ALONE = {0x01, *range(0xD0, 0xD8)}  # markers without data


class _Damage(Exception):
    pass


def damage(data, form):
    """Why bytes are no picture of a form, image/png or image/jpeg, that can be decoded, or ""."""
    try:
        if not data:
            raise _Damage("it is empty")
        if data[:8] == _PNG and form == "image/png":
            _check_png(memoryview(data))
        elif data[:2] == b"\xff\xd8" and form == "image/jpeg":
            if data.find(b"\xff\xd9", _jpeg_head(data)[2]) < 0:
                raise _Damage("it is cut short")
        else:
            raise _Damage(f"it is no {form}")
    except _Damage as found:
        return str(found)
    return ""


def too_large(path):
    """Why a file is larger than its picture can be, or "". Throws OSError."""
    size = os.path.getsize(path)
    if size <= PLAIN_BYTES:
        return ""
    with open(path, "rb") as file:
        head = file.read(1 << 20)
    try:
        width, height = struct.unpack(">II", head[16:24]) if head[:8] == _PNG else _jpeg_head(head)[:2]
    except _Damage:
        width, height = MAX_SIDE, MAX_SIDE if head[:2] == b"\xff\xd8" else 0
    most = PLAIN_BYTES + 9 * min(width, MAX_SIDE) * min(height, MAX_SIDE)
    return f"it has {size} bytes, more than a picture of {width}x{height} can have: it is damaged" if size > most else ""


def _check_size(width, height):
    if not 0 < width <= MAX_SIDE or not 0 < height <= MAX_SIDE:
        raise _Damage(f"it is {width}x{height}, and a side has 1 to {MAX_SIDE} pixels")


def _check_png(data):
    place, expected, pixels = 8, None, zlib.decompressobj()
    while len(data) >= place + 12:
        size, kind = struct.unpack_from(">I4s", data, place)
        content, behind = data[place + 8:place + 8 + size], place + 12 + size
        if behind > len(data):
            break
        if kind[0] < 0x60 and zlib.crc32(data[place + 4:behind - 4]) != struct.unpack_from(">I", data, behind - 4)[0]:  # one that decoders need
            raise _Damage("its data is damaged")
        if expected is None:
            expected = _png_bytes(kind, content)
        elif kind == b"IDAT" and expected > 0:
            try:
                while expected > 0 and (found := pixels.decompress(content, min(expected, 1 << 24))):
                    expected, content = expected - len(found), pixels.unconsumed_tail
            except zlib.error:
                raise _Damage("its data is damaged") from None
        elif kind == b"IEND":
            if expected > 0:
                raise _Damage("it has too little data for its size")
            return
        place = behind
    raise _Damage("it is cut short")


def _png_bytes(kind, content):
    """How many bytes the pixels of a PNG have, by its first chunk."""
    if kind != b"IHDR" or len(content) != 13 or content[9] not in _SAMPLES:
        raise _Damage("its data is damaged")
    width, height, bits, color, _, _, interlaced = struct.unpack(">IIBBBBB", content)
    _check_size(width, height)
    bits *= _SAMPLES[color]
    parts = [(-(-(width - x) // right), -(-(height - y) // down)) for x, y, right, down in _ADAM7] if interlaced else [(width, height)]
    return sum((1 + -(-across * bits // 8)) * rows for across, rows in parts if across > 0 and rows > 0)


def _jpeg_head(data):
    """Width, height, and where its scan begins."""
    place, size = 2, None
    while len(data) >= place + 4:
        marker = data[place + 1]
        if data[place] != 0xFF:
            raise _Damage("its data is damaged")
        if marker == 0xFF or marker in _ALONE:
            place += 1 if marker == 0xFF else 2
            continue
        if marker in _SOF and len(data) >= place + 9:
            height, width = struct.unpack_from(">HH", data, place + 5)
            _check_size(width, height)
            size = width, height
        if marker == 0xDA and size:
            return (*size, place)
        place += 2 + struct.unpack_from(">H", data, place + 2)[0]
    raise _Damage("it is cut short")
