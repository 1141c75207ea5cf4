# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is in a file of video or pictures."""
import struct
from dataclasses import dataclass, field

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstPbutils", "1.0")
from gi.repository import GLib, Gst, GstPbutils  # noqa: E402

from . import media  # noqa: E402
from .gst import structure_of  # noqa: E402

_APP1, _ORIENTATION = 0xE1, 0x112
_MISSING = GstPbutils.DiscovererResult.MISSING_PLUGINS


class ProbeError(Exception):
    """A file that cannot be decoded, and why."""


class ListError(ProbeError):
    """A file that is a list of streams, or has one in it."""


@dataclass
class Probe:
    """Of the video stream that is decoded: the first one that is not compressed picture by picture, else the first."""

    seconds: float  # of the file; 0: not known
    turned: bool = False  # whether a player is to turn it, by a tag
    still: bool = False  # its pictures are compressed one by one
    behind: str = ""  # the name of its caps, if a cover picture is before it
    rate: float = 25  # frames a second; 25 where the file has none
    placed: bool = False  # whether the file says where it was recorded
    interlaced: bool = False
    sound: bool = False
    depth_stream: int | None = None  # the index of a second video stream, of gray pictures of 16 bits
    missing: list = field(default_factory=list)  # decoders of other streams that are not installed
    attached: list = field(default_factory=list)  # what the file has beside its streams: cover pictures, fonts

    def decodes(self, name):
        """Whether a stream whose caps have this name may be the one that is decoded."""
        return name.startswith("image/" if self.still else "video/")


def probe(uri, seconds=60):
    """Reads the beginning of a file. Throws ProbeError. From then on no list of streams is played (media.allow_lists)."""
    media.allow_lists(False)
    kinds, discoverer = [], GstPbutils.Discoverer.new(seconds * Gst.SECOND)
    discoverer.connect("source-setup", lambda _, source: source.get_parent().connect("autoplug-continue", _see, kinds))
    try:
        info = discoverer.discover_uri(uri)
    except GLib.Error as error:
        if media.names_list(kinds):
            raise ListError(f"it {media.LIST_ADVICE}") from error
        if kinds and error.matches(Gst.CoreError.quark(), Gst.CoreError.MISSING_PLUGIN):
            raise ProbeError(f"a plugin is missing: {GstPbutils.pb_utils_get_decoder_description(Gst.Caps.from_string(kinds[-1]))}") from error
        raise ProbeError(error.message) from error
    videos = sorted(info.get_video_streams(), key=lambda stream: stream.get_stream_number())
    known = [v for v in videos if v.get_caps() and not structure_of(v.get_caps()).get_name().endswith("/x-unknown")]
    missing = _missing(info)
    if info.get_result() == _MISSING and not known:
        raise ProbeError(f"a plugin is missing: {', '.join(missing)}")
    if info.get_result() not in (GstPbutils.DiscovererResult.OK, _MISSING):
        raise ProbeError(f"it cannot be read ({info.get_result().value_nick})")
    if not known:
        raise ProbeError("it has no video")
    bits = [v.get_depth() for v in videos]
    depth_stream = bits.index(16) if len(bits) == 2 and bits.count(16) == 1 else None
    names = {v: structure_of(v.get_caps()).get_name() for v in known}
    colors = [v for v in known if depth_stream is None or v is not videos[depth_stream]] or known
    # A stream of image/jpeg before one of video is a cover.
    video = next((v for v in colors if not names[v].startswith("image/")), colors[0])
    name = names[video]
    if any(name in text for text in missing):  # the one to decode
        raise ProbeError(f"a plugin is missing: {', '.join(missing)}")
    if name == "image/gst-libav-gif":
        raise ProbeError("it is a GIF, whose frames GStreamer reads without their times; make a video of it, as by ffmpeg -i IN.gif OUT.mkv")
    length, general = info.get_duration() / Gst.SECOND if 0 < info.get_duration() < Gst.CLOCK_TIME_NONE else 0, info.get_tags()
    tags = video.get_tags() or general
    found, orientation = tags.get_string("image-orientation") if tags else (False, "")
    rate = video.get_framerate_num() / max(video.get_framerate_denom(), 1)
    return Probe(length, found and orientation != "rotate-0", name.startswith("image/"), name if video is not colors[0] else "", rate or Probe.rate,
                 bool(general) and general.get_double("geo-location-latitude")[0], video.is_interlaced(), bool(info.get_audio_streams()),
                 depth_stream, missing, _attached(general))


def _see(_, __, caps, kinds):
    kinds.append(structure_of(caps).get_name())
    return True


def _missing(info):
    return [details.split("|")[-2] for details in info.get_missing_elements_installer_details()]


def _attached(tags):
    found = []
    for tag in ("image", "preview-image", "attachment"):
        for index in range(tags.get_tag_size(tag) if tags else 0):
            known, sample = tags.get_sample_index(tag, index)
            info = sample.get_info() if known else None
            name = info.get_string("filename") if info and info.has_field("filename") else None
            found.append(name or ("a picture" if tag != "attachment" else "an attachment"))
    return found


def jpeg_orientation(path):
    """How a JPEG picture is to be turned, 1 to 8 as in EXIF; 1 if it does not say. GStreamer's decoders do not look. Throws OSError."""
    with open(path, "rb") as file:
        if file.read(2) != b"\xff\xd8":
            return 1
        while len(head := file.read(4)) == 4 and head[0] == 0xFF and head[1] not in (0xDA, 0xD9):
            size = struct.unpack(">H", head[2:])[0] - 2
            data = file.read(max(size, 0))
            if head[1] == _APP1 and data.startswith(b"Exif\0\0"):
                return _exif_orientation(data[6:])
    return 1


def _exif_orientation(data):
    order = {b"II": "<", b"MM": ">"}.get(data[:2])
    try:
        (place,) = struct.unpack_from(f"{order}I", data, 4)
        (count,) = struct.unpack_from(f"{order}H", data, place)
        for entry in range(place + 2, place + 2 + 12 * count, 12):
            tag, kind, _, value = struct.unpack_from(f"{order}HHIH", data, entry)
            if tag == _ORIENTATION and kind == 3 and 1 <= value <= 8:
                return value
    except (struct.error, TypeError):
        pass  # damaged
    return 1


# Of EXIF, as videoflip names them.
DIRECTIONS = ("identity", "horiz", "180", "vert", "ul-lr", "90r", "ur-ll", "90l")
