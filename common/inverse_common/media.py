# SPDX-License-Identifier: LGPL-2.1-or-later
"""Rules for files of video that all programs follow."""
import re

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstBase", "1.0")
gi.require_version("GstVideo", "1.0")
from gi.repository import GLib, Gst, GstBase, GstVideo  # noqa: E402

from .gst import structure_of, with_field  # noqa: E402

HEAD = 1 << 16  # bytes that tell what a file is
# What is no video itself, but names others, on this machine or elsewhere.
_LISTS = ("application/x-hls", "application/dash+xml", "application/vnd.ms-sstr+xml", "application/sdp", "text/uri-list", "application/xges",
          "text/x-xptv")


def is_list(path):
    """Whether a file only names streams, on other hosts perhaps, that GStreamer would open. Throws OSError."""
    with open(path, "rb") as file:
        head = file.read(HEAD)
    try:
        caps, _ = GstBase.type_find_helper_for_data(None, head) if head else (None, 0)
    except (GLib.Error, TypeError):
        return False
    return bool(caps) and structure_of(caps).get_name() in _LISTS


def prefer_decoders():
    """Makes decodebin take the decoder of libav, and the parser that it needs, for JPEG: jpegdec of GStreamer 1.22 makes blotches of color that is
    not 4:2:0."""
    parser, decoder, other = (Gst.Registry.get().lookup_feature(name) for name in ("jpegparse", "avdec_mjpeg", "jpegdec"))
    if parser and decoder and other:
        for feature in (parser, decoder):
            feature.set_rank(max(feature.get_rank(), other.get_rank() + 1))


LIST_ADVICE = "is a list of streams, which may be on other hosts: open one of them by its address, if you trust it"


def names_address(text):
    """Whether a launch line or an input names an address that is no file."""
    return "://" in text.lower().replace("file://", "")


def allow_lists(allowed):
    """Whether what decodes in this process from now on plays lists of streams, also those within a file, and so opens connections to the hosts
    that they name: if the user typed an address. In shell: pipelines/common.sh, in C++: tools/runner/input.cpp."""
    for name in _LISTS:
        for factory in Gst.ElementFactory.list_filter(_demuxers(), Gst.Caps.from_string(name), Gst.PadDirection.SINK, False):
            _ranks.setdefault(factory.get_name(), factory.get_rank())
            factory.set_rank(_ranks[factory.get_name()] if allowed else Gst.Rank.NONE)


_ranks = {}  # of these elements, as they were


def _demuxers():
    return Gst.ElementFactory.list_get_elements(Gst.ELEMENT_FACTORY_TYPE_DEMUXER, Gst.Rank.NONE)


def names_list(kinds):
    """Whether a list of streams is among these kinds: names of caps, or a message that has some."""
    return any(name in kinds for name in _LISTS)


def formats_of(element):
    """Names of the formats of raw video that an element takes, other than those that it only passes on."""
    found = []
    for template in Gst.ElementFactory.find(element).get_static_pad_templates():
        caps = template.get_caps()
        if template.direction == Gst.PadDirection.SINK and not caps.is_any():
            plain = [structure_of(caps, k).to_string() for k in range(caps.get_size()) if not caps.get_features(k).is_any()]
            found += re.findall(r"\b[A-Z][A-Za-z0-9_]+\b", " ".join(plain))
    return [name for name in dict.fromkeys(found) if GstVideo.VideoFormat.from_string(name) != GstVideo.VideoFormat.UNKNOWN]


def deinterlaces(finfo):
    """Whether `deinterlace` of this GStreamer does so for a format; that of 1.22 passes more than 8 bits on as they are."""
    return finfo.name in formats_of("deinterlace")


def deinterlace_line():
    """Makes full frames of interlaced video of any format, at its frame rate: in a format that `deinterlace` takes, of 8 bits where it takes no
    other."""
    return f"videoconvert ! video/x-raw,format=(string){{{','.join(formats_of('deinterlace'))}}} ! deinterlace fields=top"


# Scales what comes to the size and shape of the first picture, and gives it that one's frame rate, with times as they are: encoders and muxers
# take one. `keep_first` has to be called before a picture comes.
LIKE_FIRST = "videoscale ! capsfilter name=like-first"


def keep_first(parent, caps):
    """Gives LIKE_FIRST in a bin the caps of the first picture."""
    info, like_first = GstVideo.VideoInfo.new_from_caps(caps), parent.get_by_name("like-first")
    shape = f"width={info.width},height={info.height},pixel-aspect-ratio={info.par_n}/{info.par_d}"
    like_first.set_property("caps", Gst.Caps.from_string(f"video/x-raw(ANY),{shape}"))

    def keep_rate(pad, probe):
        event = probe.get_event()
        if event.type != Gst.EventType.CAPS or structure_of(event.parse_caps()).get_fraction("framerate") in ((True, info.fps_n, info.fps_d), (False, 0, 0)):
            return Gst.PadProbeReturn.OK
        pad.push_event(Gst.Event.new_caps(with_field(event.parse_caps(), "framerate", f"(fraction){info.fps_n}/{info.fps_d}")))
        return Gst.PadProbeReturn.DROP

    like_first.get_static_pad("src").add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM, keep_rate)


def give_lengths(pad):
    """Gives packets of video without a duration that of the one before: players leave out the last picture of an MP4 if it has none."""
    state = {"time": None, "length": Gst.SECOND // 25}

    def seen(_, probe):
        buffer = probe.get_buffer()
        time = buffer.dts if buffer.dts != Gst.CLOCK_TIME_NONE else buffer.pts
        if state["time"] is not None and time > state["time"]:
            state["length"] = time - state["time"]
        state["time"] = time
        if buffer.duration == Gst.CLOCK_TIME_NONE:
            buffer.duration = state["length"]
        return Gst.PadProbeReturn.OK

    pad.add_probe(Gst.PadProbeType.BUFFER, seen)


def upright(line, direction):
    """A line of video, turned in a direction of videoflip ("auto": by the video's tag)."""
    return line if direction == "identity" else f"{line} ! videoconvert ! videoflip video-direction={direction}"
