# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a codec does not hold of pictures: by what they are when they are decoded, and when they are encoded."""
from dataclasses import dataclass

from gi.repository import GstVideo
from inverse_common.gst import structure_of

_FLAGS = GstVideo.VideoFormatFlags
_NAMES = {(0, 0): "4:4:4", (1, 0): "4:2:2", (1, 1): "4:2:0", (2, 0): "4:1:1", (2, 2): "4:1:0", (0, 1): "4:4:0"}


@dataclass(frozen=True)
class Kind:
    """What a format holds. `sub`: log2 of the pixels across and down that share a color."""

    gray: bool
    rgb: bool
    alpha: bool
    sub: tuple
    bits: int


def kind_of(finfo):
    """Of a GstVideo.VideoFormatInfo."""
    gray, rgb = bool(finfo.flags & _FLAGS.GRAY), bool(finfo.flags & _FLAGS.RGB)
    sub = (0, 0) if gray or rgb else (finfo.w_sub[1], finfo.h_sub[1])
    return Kind(gray, rgb, bool(finfo.flags & _FLAGS.ALPHA), sub, finfo.depth[0])


def kind_named(name):
    """Of the format of that name."""
    return kind_of(GstVideo.VideoFormat.get_info(GstVideo.VideoFormat.from_string(name)))


def lost(before, after, codec):
    """What is lost where one Kind becomes another, in words, a text each."""
    if before.alpha and not after.alpha:
        yield f"transparency is left out, since {codec} has none here: --video ffv1 or prores, and --to png, keep it"
    if not before.gray and (after.gray or any(a > b for a, b in zip(after.sub, before.sub))):
        form = "no color" if after.gray else f"color of {_NAMES.get(after.sub, 'a lower resolution')}"
        yield f"{codec} has {form}, the input {_NAMES.get(before.sub, 'more')}{' (RGB)' if before.rgb else ''}: --video ffv1, and --to png, keep it"
    if after.bits < before.bits:
        yield f"{codec} has {after.bits} bits a sample, the input {before.bits}"


def lost_marks(before, after, codec, matroska):
    """What is lost of caps of pictures between the decoder and the encoder, or by a codec in a container, Matroska or not; in words, a text
    each."""
    display = [name for name in ("mastering-display-info", "content-light-level") if structure_of(before).has_field(name)]
    if display and not matroska and codec != "h265":
        yield f"what HDR says of its display ({', '.join(display)}) is left out: mkv, and --video h265, keep it"
    stereo = structure_of(before).get_string("multiview-mode")
    if stereo and stereo != "mono" and (not matroska or stereo != structure_of(after).get_string("multiview-mode")):
        yield f"that its pictures are stereo ({stereo}) is left out" + ("" if matroska else ": mkv keeps it")


def faithful(formats, kind):
    """Of the names of formats, those that lose nothing of a Kind; if there is none, those that lose least."""
    known = {name: kind_named(name) for name in formats}

    def rank(name):
        found = known[name]
        return (kind.alpha and not found.alpha, not kind.gray and found.gray, any(a > b for a, b in zip(found.sub, kind.sub)),
                max(kind.bits - found.bits, 0), kind.rgb and not found.rgb)

    best = min(map(rank, known), default=None)
    chosen = [name for name in known if rank(name) == best]
    # No more than is needed: the encoder's work grows with it.
    least = min(((known[n].alpha, known[n].bits) for n in chosen), default=None)
    return [name for name in chosen if (known[name].alpha, known[name].bits) == least]
