# SPDX-License-Identifier: LGPL-2.1-or-later
"""Containers and codecs by name, and the elements that write them."""
import contextlib
import re
from dataclasses import dataclass

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402
from inverse_common.media import formats_of  # noqa: E402

from . import losses  # noqa: E402


class FormatError(Exception):
    """A name that is not known, of which this machine has no element, or a picture that cannot be read or written."""


@dataclass(frozen=True)
class Container:
    muxer: str  # "": a folder of pictures
    video: str  # default codecs
    deep_video: str  # of more than 8 bits
    audio: str  # of streams that it cannot copy


CONTAINERS = {
    "mkv": Container("matroskamux", "vp8", "vp9", "opus"),
    "webm": Container("webmmux", "vp8", "vp9", "opus"),
    "mp4": Container("mp4mux", "h264", "h265", "aac"),
    "mov": Container("qtmux", "h264", "prores", "aac"),
    "png": Container("", "png", "png16", ""),
    "jpg": Container("", "mjpeg", "mjpeg", ""),
    "exr": Container("", "exr", "exr", ""),
}

# Software first; with --hardware, the others first. What follows the element's name are settings.
_SOFTWARE = {
    "vp8": ["vp8enc deadline=1 cpu-used=8 threads=4 end-usage=cq cq-level=16 target-bitrate=20000000 keyframe-max-dist=60"],
    # Without a lag no frame waits in the encoder.
    "vp9": ["vp9enc deadline=1 cpu-used=8 threads=4 row-mt=true lag-in-frames=0 end-usage=cq cq-level=20 "
            "target-bitrate=20000000 keyframe-max-dist=60"],
    "h264": ["x264enc speed-preset=faster pass=qual quantizer=20 key-int-max=60 ! h264parse",
             "openh264enc rate-control=quality bitrate=8000000 gop-size=60 ! h264parse"],
    # Without a text of its settings in the stream: for HDR it holds uninitialized memory, on which h265parse or mp4mux may fail.
    "h265": ["x265enc speed-preset=faster key-int-max=60 bitrate=8000 option-string=info=0 ! h265parse"],
    "av1": ["svtav1enc preset=9 ! av1parse",
            "av1enc cpu-used=8 threads=4 target-bitrate=20000 min-quantizer=20 max-quantizer=40 keyframe-max-dist=60 ! av1parse"],
    "ffv1": ["avenc_ffv1"],
    "mjpeg": ["jpegenc quality=92"],
    "prores": ["avenc_prores_ks"],
    "png": ["pngenc"],
}
_HARDWARE = {
    "h264": ["nvh264enc ! h264parse", "vah264enc ! h264parse", "vaapih264enc ! h264parse"],
    "h265": ["nvh265enc ! h265parse", "vah265enc ! h265parse", "vaapih265enc ! h265parse"],
    "av1": ["nvav1enc ! av1parse", "vaav1enc ! av1parse"],
    "vp9": ["vavp9enc", "vaapivp9enc"],
    "vp8": ["vavp8enc", "vaapivp8enc"],
}
_AUDIO = {
    "opus": ["opusenc"],
    "vorbis": ["vorbisenc"],
    "flac": ["flacenc"],
    "aac": ["fdkaacenc", "avenc_aac", "voaacenc"],
    "mp3": ["lamemp3enc"],
}
_PACKAGES = {
    "x264enc": "gstreamer1.0-plugins-ugly",
    "x265enc": "gstreamer1.0-plugins-bad",
    "openh264enc": "gstreamer1.0-plugins-bad",
    "av1enc": "gstreamer1.0-plugins-bad",
    "avenc_ffv1": "gstreamer1.0-libav",
    "avenc_prores_ks": "gstreamer1.0-libav",
    "avenc_aac": "gstreamer1.0-libav",
    "gdppay": "gstreamer1.0-plugins-bad",
    "scenechange": "gstreamer1.0-plugins-bad",
    "matroskamux": "gstreamer1.0-plugins-good",
    "mp4mux": "gstreamer1.0-plugins-good",
}

SEQUENCES = tuple(name for name, container in CONTAINERS.items() if not container.muxer)  # written to folders
MATROSKA = ("mkv", "webm")
OWN_CODECS = ("png16", "exr")  # of pictures.py
VIDEO_CODECS, AUDIO_CODECS = sorted(_SOFTWARE.keys() - {"png"}), sorted(_AUDIO)


def version():
    """Of the elements, which this program is a part of."""
    plugin = Gst.Registry.get().find_plugin("inverse")
    return plugin.get_version() if plugin else "without elements"


def need(elements, what):
    """Throws FormatError if one of the elements is missing."""
    for element in elements:
        _first([element], what)


def is_element(name):
    """Whether GStreamer has such an element."""
    return Gst.ElementFactory.find(name) is not None


def layers():
    """The names of the layers that intrinsicsplit has; %u: a number."""
    split = Gst.ElementFactory.find("intrinsicsplit")
    templates = split.get_static_pad_templates() if split else []
    return [t.name_template for t in templates if t.direction == Gst.PadDirection.SRC]


def is_layer(name):
    """Whether intrinsicsplit has such a layer."""
    return re.sub("_[0-9]+$", "_%u", name) in layers()


def own_pictures(exr):
    """The module that has elements of this program for pictures. `exr`: whether for OpenEXR. Throws FormatError."""
    try:
        from . import pictures
    except ImportError as error:
        raise FormatError(f"EXR, and PNG of 16 bits, need Python's {error.name}: install python3-numpy") from error
    if exr:
        pictures.openexr()
    return pictures


def own_line(codec, place=0):
    """A part of a launch line for pictures.connect: frames go in, what the codec makes of them comes out. Throws FormatError."""
    frames = own_pictures(codec == "exr").CODECS[codec].frames
    return (f"appsink name=frames{place} caps={frames} sync=false async=false emit-signals=true max-buffers=1 "
            f"appsrc name=packets{place} format=time handle-segment-change=true block=true")


def container(name):
    """The Container of a file name's ending. Throws FormatError."""
    if name not in CONTAINERS:
        raise FormatError(f"there is no container {name!r}; choose of {', '.join(CONTAINERS)}")
    found = CONTAINERS[name]
    _first([found.muxer or "multifilesink"], f"the container {name}")
    return found


def _first(lines, what):
    for line in lines:
        if all(Gst.ElementFactory.find(part.split()[0]) for part in line.split(" ! ")):
            return line
    element = lines[0].split()[0]
    raise FormatError(f"there is no element for {what}; {element} is in {_PACKAGES.get(element, 'no package that is known')}")


def video_encoder(codec, hardware=False, options="", place=0):
    """The end of a launch line that encodes video. `options`: properties in addition; `place`: among several of a line. Throws FormatError."""
    if codec not in _SOFTWARE and codec not in OWN_CODECS:
        raise FormatError(f"there is no video codec {codec!r}; choose of {', '.join(VIDEO_CODECS)}")
    if codec in OWN_CODECS:
        if options:
            raise FormatError("--video-options is for encoders of GStreamer, which EXR and PNG of 16 bits are not written by")
        return own_line(codec, place)
    lines = (_HARDWARE.get(codec, []) if hardware else []) + _SOFTWARE[codec]
    head, *parser = _first(lines, f"the video codec {codec}").split(" ! ")
    return " ! ".join([f"{head} {options}".strip(), *parser])


def _fits(muxer, encoder):
    """Whether a muxer takes what an encoder, a part of a launch line, outputs."""
    def pads(element, direction):
        return [t.get_caps() for t in Gst.ElementFactory.find(element).get_static_pad_templates() if t.direction == direction]

    made = pads(encoder.split(" ! ")[-1].split()[0], Gst.PadDirection.SRC)
    return any(one.can_intersect(other) for one in made for other in pads(muxer, Gst.PadDirection.SINK))


def _codecs_of(muxer, codecs, encoder_of):
    for codec in codecs:
        with contextlib.suppress(FormatError):  # there is no encoder
            if _fits(muxer, encoder_of(codec)):
                yield codec


def check_fit(ending, kind, codec, encoder):
    """Throws FormatError if a container does not take a codec ("": its own) of the kind "video" or "audio", of which this encoder was found."""
    muxer = CONTAINERS[ending].muxer
    if codec and muxer and not _fits(muxer, encoder):
        codecs = _codecs_of(muxer, *((VIDEO_CODECS, video_encoder) if kind == "video" else (AUDIO_CODECS, audio_encoder)))
        other = "; mkv takes it" if ending != "mkv" and _fits(CONTAINERS["mkv"].muxer, encoder) else ""
        raise FormatError(f"{ending} does not take the {kind} codec {codec}; it takes {', '.join(codecs)}{other}")


LOSSLESS = ("ffv1", "png")
_WITH_ALPHA = ("prores",)


def kept_formats(codec, encoder, kind, most_bits):
    """A filter before `encoder`, a part of a launch line, by which it keeps of pictures of a Kind what the codec is meant to keep: all, alpha
    and bits, or bits; up to `most_bits` a sample. "" if any format does."""
    bits = {name: losses.kind_named(name).bits for name in formats_of(encoder.split()[0])}
    known = [name for name in bits if bits[name] <= most_bits]
    if codec in LOSSLESS or kind.alpha and codec in _WITH_ALPHA:
        chosen = losses.faithful(known, kind)
    else:
        chosen = [name for name in known if bits[name] > 8] if kind.bits > 8 else []
    return f"video/x-raw,format=(string){{{','.join(chosen)}}} ! " if chosen else ""


def audio_encoder(codec):
    """The end of a launch line that encodes sound. Throws FormatError."""
    if codec not in _AUDIO:
        raise FormatError(f"there is no audio codec {codec!r}; choose of {', '.join(AUDIO_CODECS)}")
    return _first(_AUDIO[codec], f"the audio codec {codec}")
