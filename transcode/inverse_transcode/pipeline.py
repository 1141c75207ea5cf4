# SPDX-License-Identifier: LGPL-2.1-or-later
"""The GStreamer pipeline that transcodes one file."""
import collections
import dataclasses
import os
import pathlib
import re
import shlex

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstVideo", "1.0")
from gi.repository import GLib, Gst, GstVideo  # noqa: E402
from inverse_common.gst import size_of, structure_of, without  # noqa: E402
from inverse_common.media import LIKE_FIRST, deinterlaces, give_lengths, keep_first  # noqa: E402
from inverse_common.picture import damage, too_large  # noqa: E402
from inverse_common.probe import DIRECTIONS, Probe, jpeg_orientation, probe  # noqa: E402

from . import formats, losses, marks  # noqa: E402
from .chunk import Chunk, join, keep_plain, stream  # noqa: E402
from .gaps import Gaps  # noqa: E402
from .plan import is_exr, is_pattern, numbered, pattern_parts, picture  # noqa: E402

# Streams of which muxers want another form of the same packets, and what it is.
_FORMS = {
    "audio/mpeg": ("aacparse", "audio/mpeg,mpegversion=4,stream-format=raw"),
    # Its tags are those of SubRip, which containers call plain text.
    "text/x-raw": ("capssetter caps=text/x-raw,format=utf8", "text/x-raw,format=utf8"),
}
_PICTURES = {"png": "image/png", "jpg": "image/jpeg", "jpeg": "image/jpeg"}  # sequences that are read

_HDR = (GstVideo.VideoTransferFunction.SMPTE2084, GstVideo.VideoTransferFunction.ARIB_STD_B67)
_UNTITLED = ("Video", "Audio", "Subtitle")  # what matroskamux writes of a track without a title
_STYLED = ("application/x-ass", "application/x-ssa")  # subtitles
FIELDS = "fields"  # in the names of the elements that deinterlace
_LATE, _LATE_SHARE = 0.25, 0.05  # seconds, and a part of the file
SMALL = 64  # pixels a side, which every encoder takes
_NO_LIGHT = ("reflectance", "mask", "clusters")  # layers that have no exposure


class TranscodeError(Exception):
    """A file that cannot be transcoded, and why."""


def uri_of(path):
    """The URI of a file."""
    return pathlib.Path(os.path.abspath(path)).as_uri()  # also of names that are no UTF-8


def tolerance(seconds):
    """Seconds by which lengths may differ."""
    return max(_LATE, seconds * _LATE_SHARE)


def _stream_seconds(pad, buffer):
    """The stream time of a buffer's begin in seconds, or 0."""
    segment = pad.get_sticky_event(Gst.EventType.SEGMENT, 0)
    time = segment.parse_segment().to_stream_time(Gst.Format.TIME, buffer.pts) if segment and buffer.pts != Gst.CLOCK_TIME_NONE else Gst.CLOCK_TIME_NONE
    return 0 if time == Gst.CLOCK_TIME_NONE else time / Gst.SECOND


class Transcode:
    """One video stream goes through the chain and is encoded, or is joined of chunks that were; sound, subtitles and further video are
    copied where the container takes them. Of a chunk, the encoded video alone is written, a file for each stream. `loop`: quit once it
    has ended. Then `error` has the cause of a failure, or is empty."""

    def __init__(self, task, part, loop):
        """`task`: as Task.as_json; `part`: the file or folder to write. Throws FormatError, ProbeError, TranscodeError."""
        self.task, self.loop = task, loop
        self.error, self.warnings, self.copied, self.time = "", [], [], 0
        self.made, self.frames = 0, 0  # frames that came out of the elements, and of the encoder
        self.container = formats.container(task["container"])
        self.pictures = len(numbered(task["input"])) if is_pattern(task["input"]) else 0
        self.said = 0 if is_pattern(task["input"]) else marks.video_seconds(task["input"])  # how long the video is, 0: not known
        self.gaps = Gaps()
        self.reached = {}  # seconds that packets of the file reached, by "video" and "audio"
        self.chunk = Chunk(**task["chunk"]) if task["chunk"] else None
        self.small = ""  # what to do about an error if pictures are so small that it may be due to that
        self.exr = None  # the source of EXR pictures
        self.formats = {}  # by pads of it
        self.captions = set()  # where pictures had closed captions
        self.mastering = None  # the highest and the lowest luminance of the display that it was mastered on
        self.direction = "identity"  # how pictures are turned
        self.size = None  # of the first one
        self.gates = []  # what holds other streams back until the muxer knows the format of the video: (pad, probe)
        self.clipped = collections.Counter()  # pixels that the elements output too bright for the result
        if self.chunk:
            self.size = size_of(self.chunk.first_caps())
        self.probe, source = self._source(task)
        if self.chunk and self.chunk.end:
            self.probe.seconds = self.chunk.end / Gst.SECOND
        if task["audio"] not in ("copy", "none"):
            formats.audio_encoder(task["audio"])
        if self.probe.placed and not self.chunk:
            self.warnings.append("the place where it was recorded is left out: GStreamer writes none")
        if not self.chunk:
            self.warnings += [f"a stream is left out, of which nothing is known here: {missing}" for missing in self.probe.missing]
        if self.probe.attached and not self.chunk:
            self.warnings.append(f"what is attached is left out, as GStreamer writes none: {', '.join(self.probe.attached)}")
        if not self.chunk and not is_pattern(task["input"]):
            self.warnings += marks.left_out(task["input"])
        self.pipeline = Gst.Pipeline.new()
        self.part, self.mux = part, None
        if self.container.muxer and not self.chunk:
            self.mux, sink = Gst.ElementFactory.make(self.container.muxer), Gst.ElementFactory.make("filesink")
            sink.set_property("location", part)
            self.pipeline.add(self.mux)
            self.pipeline.add(sink)
            self.mux.link(sink)
        self.pipeline.add(source)
        self.video_pads = []  # of the muxer
        self.stopping, self.cut, self.head = False, None, None
        self.readers = []  # processes that read parts
        if self.exr:
            self._link_video(source.get_static_pad("src"))
        else:
            parse = Gst.ElementFactory.make("parsebin")
            self.pipeline.add(parse)
            source.link(parse)
            parse.connect("autoplug-continue", self._guarded(self._parses))
            parse.connect("pad-added", self._guarded(lambda _, pad: self._link(pad)))
        self.pipeline.get_bus().add_signal_watch()
        self.pipeline.get_bus().connect("message", self._message)

    def _source(self, task):
        path = task["input"]
        if not is_pattern(path):
            uri = uri_of(path)
            found = probe(uri)
            self.direction = "auto" if found.turned else DIRECTIONS[jpeg_orientation(path) - 1]
            return found, Gst.Element.make_from_uri(Gst.URIType.SRC, uri, None)
        numbers = numbered(path)
        above, below = (int(n) for n in task["rate"].split("/"))
        found = Probe(len(numbers) * below / above, still=True)
        if is_exr(path):
            files = [picture(path, number) for number in numbers]
            self.exr = formats.own_pictures(exr=True).ExrSource(files, task["rate"], task["exposure"], self._fail)
            return found, self.exr.element
        ending = os.path.splitext(path)[1][1:].lower()
        if ending not in _PICTURES:
            raise TranscodeError(f"pictures that end in {ending!r} are not read; those in {', '.join(_PICTURES)}, exr are")
        files = [picture(path, number) for number in numbers]
        for file in files:
            if why := too_large(file):  # it would be read at once
                raise TranscodeError(f"{file}: {why}")
        self.direction = self._direction_of(files)
        source = Gst.ElementFactory.make("multifilesrc")
        head, digits, tail = (part.replace("%", "%%") if isinstance(part, str) else part for part in pattern_parts(path))
        location = os.path.join(os.path.dirname(path).replace("%", "%%"), f"{head}%0{digits}d{tail}" if digits else f"{head}%d{tail}")
        for name, value in (("location", location), ("start-index", numbers[0]), ("stop-index", numbers[-1])):
            source.set_property(name, value)
        source.set_property("caps", Gst.Caps.from_string(f"{_PICTURES[ending]},framerate={task['rate']}"))
        source.get_static_pad("src").add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._see_picture), iter(files), _PICTURES[ending])
        return found, source

    def _see_picture(self, _, info, files, form):
        """Leaves a damaged picture out. Each buffer is a file."""
        file, buffer = next(files), info.get_buffer()
        why = damage(buffer.extract_dup(0, buffer.get_size()), form)
        if not why:
            return Gst.PadProbeReturn.OK
        self.pictures -= 1
        self._warn(f"{file} is left out: {why}")
        return Gst.PadProbeReturn.DROP

    @staticmethod
    def _direction_of(files):
        """How all pictures of a sequence are to be turned."""
        first, *others = found = [jpeg_orientation(file) for file in files]
        if any(other != first for other in others):
            file = files[next(k for k, other in enumerate(found) if other != first)]
            raise TranscodeError(f"{file} is to be turned otherwise than {files[0]}: turn the pictures first, as by exiftran -ai *.jpg")
        return DIRECTIONS[first - 1]

    def start(self):
        self.pipeline.set_state(Gst.State.PLAYING)

    def finish(self):
        """Ends the file at the frame that is decoded next; other streams end at its time."""
        self.stopping = True

    def _cut(self, pad, info):
        """Ends a stream once the file is to end: what comes after it is refused, back to the demuxer."""
        pts = info.get_buffer().pts
        if not self.stopping:
            return Gst.PadProbeReturn.OK
        if pad == self.head:
            self.cut = pts
        elif self.cut is None or pts == Gst.CLOCK_TIME_NONE or pts < self.cut:
            return Gst.PadProbeReturn.OK
        pad.send_event(Gst.Event.new_eos())
        return Gst.PadProbeReturn.DROP

    def close(self):
        self.pipeline.get_bus().remove_signal_watch()
        self.pipeline.set_state(Gst.State.NULL)
        if self.exr:
            self.warnings += self.exr.warnings()
        self.warnings += [f"{count} pixels{layer} were as bright as frames can be, {limit}, or brighter and clipped"
                          for (layer, limit), count in self.clipped.items()]
        if self.captions == {"decoded"}:
            self._warn("closed captions in its pictures are left out")
        for reader in self.readers:
            reader.stdout.close()
            if reader.wait() and not self.stopping:
                self.error = self.error or "not all of its parts could be read"

    def _guarded(self, function):
        def call(*arguments):
            try:
                return function(*arguments)
            except (TranscodeError, formats.FormatError) as error:
                self._fail(str(error))
            except Exception as error:  # a thread of GStreamer would ignore it
                self._fail(f"{type(error).__name__}: {error}")
                raise

        return call

    def _fail(self, why):
        self.error = self.error or why
        GLib.idle_add(self.loop.quit)

    def _warn(self, text):
        """Tells of it once."""
        if text not in self.warnings:
            self.warnings.append(text)

    def _message(self, _, message):
        if message.type == Gst.MessageType.ERROR:
            error, details = message.parse_error()
            why = error.message.rstrip(".")
            if "not-negotiated" in (details or ""):
                why = "an element after it does not take its pictures: check caps and sizes (--verbose with GST_DEBUG=3 names the element)"
            self._fail(f"{message.src.get_name()}: {why}{self.small}")
        elif message.type == Gst.MessageType.WARNING:
            error, _ = message.parse_warning()
            self._warn(f"{message.src.get_name()}: {error.message}")
        elif message.type == Gst.MessageType.EOS:
            if self.frames == 0 and not self.chunk:  # a chunk may have none: video may begin late, or end before sound does
                self.error = self.error or f"not one frame came out of the chain{self.small}"
            self.loop.quit()

    @staticmethod
    def _parse(description):
        try:
            return Gst.parse_bin_from_description(description, False)
        except GLib.Error as error:
            raise TranscodeError(f"{error.message}: {description}") from error

    def _bin(self, description):
        """A bin with a pad for each end that is not linked."""
        found = self._parse(description)
        # Not find_unlinked_pad(), which also finds those inside of elements that are bins.
        for pad in [pad for element in found.children for pad in element.pads if not pad.is_linked()]:
            found.add_pad(Gst.GhostPad.new(None, pad))
        return found

    def _join(self, source, sink, what):
        try:
            source.link(sink)
        except Gst.LinkError:
            raise TranscodeError(f"{what}{self.small}") from None

    def _video_bin(self, caps):
        """What is between decoded frames and the muxer."""
        task, info = self.task, GstVideo.VideoInfo.new_from_caps(caps)
        if not info:
            raise TranscodeError(f"its frames are no pictures in memory: {caps.to_string()}")
        deep = task["bits"] == 16 if task["bits"] else info.finfo.depth[0] > 8
        codec = task["video"] or (self.container.deep_video if deep else self.container.video)
        if self.container.muxer and min(info.width, info.height) < SMALL:
            self.small = (f"; its pictures are {info.width}x{info.height}, which may be too small for {codec}: enlarge them by ending the elements "
                          f"with videoscale ! video/x-raw,width={SMALL},height={SMALL}, or choose --video ffv1, or --to png")
        # Most muxers take pictures of one size, rate and format: all are made as the first ones are.
        same = codec not in formats.OWN_CODECS and bool(self.container.muxer)
        before = f"videoconvert ! {LIKE_FIRST}" if same else "videoconvert"
        if deinterlaces(info.finfo):
            before += " ! deinterlace fields=top"
        elif info.interlace_mode != GstVideo.VideoInterlaceMode.PROGRESSIVE:
            before += f" ! {formats.own_line('fields', FIELDS)} ! videoconvert ! video/x-raw,format={info.finfo.name}"
        if self.direction != "identity":
            before += f" ! videoflip video-direction={self.direction} ! videoconvert"
        demand, chain = self._demand(info, codec), f"{before} ! {task['chain']} !"
        encoders = [formats.video_encoder(codec, task["hardware"], task["video_options"], k) for k in range(len(self.video_pads))]
        # Pictures of 16 bits: players take 10.
        most_bits = 10 if info.finfo.depth[0] > 12 and codec != "ffv1" else 16
        kind = losses.kind_of(info.finfo)
        kept = formats.kept_formats(codec, encoders[0], dataclasses.replace(kind, bits=kind.bits if deep else 8), most_bits) if codec not in formats.OWN_CODECS else ""
        # A muxer may wait for one layer's packets while it has another's.
        packets = " ! queue max-size-buffers=0 max-size-bytes=0 max-size-time=0" if len(encoders) > 1 else ""
        # A muxer orders packets by running time, which jumps where a file has several edits.
        line = "" if self.chunk else "identity single-segment=true ! "
        encode = [f"queue name=encode{k} max-size-buffers=4 max-size-bytes=0 max-size-time=0 ! {line}videoconvert ! {kept}capsfilter name=same{k} ! "
                  f"{encoder}{packets} ! identity name=end{k}" for k, encoder in enumerate(encoders)]
        if task["layers"]:
            # On the curve of EXR there is room for the layers as they are.
            scales = "reflectance-scale=1 shading-scale=1 mirror-scale=1" if codec == "exr" else ""
            shows = task["layers"]
            found = self._bin(f"{chain} intrinsicsplit name=layers {scales} " +
                              " ".join(f"layers.{shlex.quote(layer)} ! {demand} {end}" for layer, end in zip(shows, encode)))
        else:
            demand, *shows = self._last_element(demand)
            found = self._bin(f"{chain} {demand} {encode[0]}")
        if found.numsinkpads != 1 or found.numsrcpads != len(self.video_pads):
            raise TranscodeError(f"the elements must have one beginning and one end: {task['chain']}")
        if same:
            keep_first(found, self.chunk.first_caps() if self.chunk else caps)
        ends = {pad.get_target().get_parent_element().get_name(): pad for pad in found.srcpads}  # which are in any order
        ends = [ends[f"end{k}"] for k in range(len(self.video_pads))]
        ends[0].add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._count))
        if encoders[0].startswith("openh264enc"):
            found.get_by_name("encode0").get_static_pad("sink").add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._watch_size))
        if encoders[0].startswith("x264enc"):  # which writes them
            found.get_by_name("encode0").get_static_pad("sink").add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._see_captions), "encoded")
        if "frames" + FIELDS in before:
            self._own(found, FIELDS, "fields", None)
        for k in range(len(self.video_pads)):
            self._watch_format(found, k, kind, codec, same, caps)
            pad = found.get_by_name(f"encode{k}").get_static_pad("sink")
            if self.chunk:
                self.chunk.drop_lead(pad, self._guarded)
            if k == 0:
                pad.add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._count_made))
            if self.exr or not self.container.muxer:
                self._watch_light(pad, "colorimetry" in demand, shows[k])
            if codec in formats.OWN_CODECS:
                stops = -task["exposure"] if self.exr and shows[k] not in _NO_LIGHT else 0
                self._own(found, k, codec, stops)
        return found, ends, codec

    def _demand(self, info, codec):
        """What an element of gst-inverse is to deliver, as a part of a launch line: it converts between curves, videoconvert does not."""
        if codec == "exr":
            caps = formats.own_pictures(exr=True).FRAMES
        elif info.colorimetry.transfer in _HDR and (self.exr or not self.container.muxer):
            caps = "video/x-raw,format=RGBA64_LE,colorimetry=sRGB"
        elif codec == "png16":
            caps = "video/x-raw,format={GRAY16_LE,RGBA64_LE}" if self.task["layers"] else "video/x-raw,format=RGBA64_LE"
        else:
            return ""
        return f"{caps} !"

    def _last_element(self, demand):
        """The demand if the chain ends with an element of gst-inverse, else ""; and what that shows."""
        chain = self._parse(f"{self.task['chain']} ! identity name=chain-end")
        last = chain.get_by_name("chain-end").get_static_pad("sink").get_peer()
        element = last.get_parent_element() if last else None
        if not element or not (element.get_factory().get_plugin_name() or "").startswith("inverse"):
            return "", ""
        return demand, element.get_property("show").value_nick if element.find_property("show") else ""

    def _own(self, found, place, codec, setting):
        ends = (found.get_by_name(f"{name}{place}") for name in ("frames", "packets"))
        formats.own_pictures(codec == "exr").connect(*ends, codec, setting, self._fail)

    def _watch_light(self, pad, counted, shown):
        """Refuses HDR where a picture's file cannot name its curve. `counted`: frames are of 16 bits, on a curve that was demanded; what it
        clips is counted."""
        pictures = formats.own_pictures(exr=False) if counted else None

        def seen(pad, data):
            info = GstVideo.VideoInfo.new_from_caps(pad.get_current_caps())
            hdr = info.colorimetry.transfer in _HDR
            if hdr and self.task["container"] in ("png", "jpg"):
                self._fail(f"{self.task['container']} is not written of HDR: end the elements with one of gst-inverse, which converts it")
                return Gst.PadProbeReturn.DROP
            if counted:
                light = pictures.pixels_of(info, data.get_buffer())[..., :3]
                if light.max() == 65535:
                    where = f" of {shown}" if shown else ""
                    self.clipped[where, f"{pictures.PEAK:.3g} times white" if hdr else "white"] += int((light == 65535).any(-1).sum())
            return Gst.PadProbeReturn.OK

        pad.add_probe(Gst.PadProbeType.BUFFER, self._guarded(seen))

    def _watch_format(self, found, place, kind, codec, keep, decoded):
        """Tells what the encoder does not hold of pictures of a Kind, whose caps are `decoded`, and has later ones converted to the
        format of the first one, if `keep`."""
        same = found.get_by_name(f"same{place}")

        def seen(pad, _):  # a frame: caps before it may change once more, by a tag that turns it
            caps = pad.get_current_caps()
            info = GstVideo.VideoInfo.new_from_caps(caps)
            if place == 0 and info:
                marks_lost = losses.lost_marks(decoded, caps, codec, self.task["container"] in formats.MATROSKA)
                for text in (*losses.lost(kind, losses.kind_of(info.finfo), codec), *marks_lost):
                    self._warn(text)
                if self.task["container"] in formats.MATROSKA:
                    above, below = (info.width * info.par_n, info.par_d) if info.par_n > info.par_d else (info.height * info.par_d, info.par_n)
                    if above % below:
                        self._warn(f"{self.task['container']} keeps the shape of pixels, {info.par_n}:{info.par_d}, rounded: mp4 and mov keep it exactly")
                if not self.container.muxer and info.par_n != info.par_d and codec != "exr":
                    self._warn(f"{self.task['container']} does not say that its pixels have a shape of {info.par_n}:{info.par_d}: a player shows them square")
            if keep:
                same.set_property("caps", without(caps, "framerate"))
            return Gst.PadProbeReturn.REMOVE

        same.get_static_pad("src").add_probe(Gst.PadProbeType.BUFFER, self._guarded(seen))

    def _see_captions(self, _, info, place):
        if not info.get_buffer().get_meta(GstVideo.video_caption_meta_api_get_type()):
            return Gst.PadProbeReturn.OK
        self.captions.add(place)
        return Gst.PadProbeReturn.REMOVE

    def _watch_sizes(self, pad, info):
        """Tells where decoded pictures change their size, if they go to a muxer."""
        event = info.get_event()
        if event.type == Gst.EventType.CAPS:
            size = size_of(event.parse_caps())
            if self.size and size != self.size and self.container.muxer:
                self._warn(f"its pictures change from {self.size[0]}x{self.size[1]} to {size[0]}x{size[1]} after {self.time:.1f} s: they are scaled to the first size")
            self.size = self.size or size
        return Gst.PadProbeReturn.OK

    def _watch_size(self, pad, _):
        """Warns of openh264enc, which leaves out the last column or row of an odd number."""
        width, height = size_of(pad.get_current_caps())
        if width % 2 or height % 2:
            self.warnings.append(f"h264 has {width // 2 * 2}x{height // 2 * 2} pixels of {width}x{height}, as openh264enc takes even numbers: end the "
                                 "elements with videoscale and caps of an even size, or choose another codec")
        return Gst.PadProbeReturn.REMOVE

    def _count_made(self, *_):
        self.made += 1
        return Gst.PadProbeReturn.OK

    def _count(self, pad, info):
        self.frames += 1
        self.time = max(self.time, _stream_seconds(pad, info.get_buffer()))  # encoders shift what they output
        return Gst.PadProbeReturn.OK

    def _mux_pad(self, caps):
        """A pad of the muxer that takes packets of these caps, or None."""
        if not self.mux:
            return None
        for template in self.mux.get_factory().get_static_pad_templates():
            if template.direction == Gst.PadDirection.SINK and template.static_caps.get().can_intersect(caps):
                pad = self.mux.request_pad_simple(template.name_template)
                pad.add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._cut))
                if template.name_template.startswith("video"):
                    give_lengths(pad)
                self._describe(pad)
                self._drop_title(pad)
                return pad
        return None

    def _describe(self, pad, layer=""):
        """Tells Matroska that the language of a stream is not known if it is not: it would be English. A layer is its title."""
        if self.task["container"] not in formats.MATROSKA:
            return

        def first(pad, _):
            known = [pad.get_sticky_event(Gst.EventType.TAG, k) for k in range(8)]
            tags = Gst.TagList.new_empty()
            if not any(event and event.parse_tag().get_string("language-code")[0] for event in known):
                tags.add_value(Gst.TagMergeMode.APPEND, Gst.TAG_LANGUAGE_CODE, "und")
            if layer:
                tags.add_value(Gst.TagMergeMode.APPEND, Gst.TAG_TITLE, layer)
            if not tags.is_empty():
                pad.send_event(Gst.Event.new_tag(tags))
            return Gst.PadProbeReturn.REMOVE

        pad.add_probe(Gst.PadProbeType.BUFFER, self._guarded(first))

    def _drop_title(self, pad):
        """Keeps the title of a track from becoming that of the file, as it does where tracks have none."""
        if self.task["container"] in formats.MATROSKA:
            return

        def seen(pad, info):
            event = info.get_event()
            tags = event.parse_tag() if event.type == Gst.EventType.TAG else None
            if not tags or tags.get_scope() != Gst.TagScope.STREAM or not tags.get_string(Gst.TAG_TITLE)[0]:
                return Gst.PadProbeReturn.OK
            title = tags.get_string(Gst.TAG_TITLE)[1]
            if title not in _UNTITLED:
                self._warn(f"{self.task['container']} takes no title of a track from GStreamer: {title!r} is left out")
            others = tags.copy()
            others.remove_tag(Gst.TAG_TITLE)
            if not others.is_empty():
                pad.send_event(Gst.Event.new_tag(others))
            return Gst.PadProbeReturn.DROP

        pad.add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM, self._guarded(seen))

    def _add(self, description):
        found = self._bin(description)
        self.pipeline.add(found)
        return found

    def should_last(self):
        """Seconds that the pictures should last, 0: not known. A file without an end of its own for video is as long as its longest stream: if none is cut,
        the video is as long as its packets."""
        seconds = self.said or self.probe.seconds
        if not self.pictures and marks.counts_from_elsewhere(self.task["input"]):
            return 0
        if not self.said and self.probe.seconds - max(self.reached.values(), default=0) <= tolerance(self.probe.seconds):
            seconds = self.reached.get("video", seconds)
        return min(seconds, self.chunk.end / Gst.SECOND) if self.chunk and self.chunk.end else seconds

    def _see_gap(self, _, info):
        if info.get_buffer().pts != Gst.CLOCK_TIME_NONE:
            self.gaps.add(info.get_buffer().pts)
        return Gst.PadProbeReturn.OK

    def _see_packet(self, pad, info, kind):
        self.reached[kind] = max(self.reached.get(kind, 0), _stream_seconds(pad, info.get_buffer()))
        return Gst.PadProbeReturn.OK

    def _link(self, pad):
        name = self._name(pad)
        kind = "video" if self.probe.decodes(name) else name.partition("/")[0]
        if kind in ("video", "audio"):
            pad.add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._see_packet), kind)
        if self.mux and self.task["container"] not in formats.MATROSKA:
            pad.add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM, self._guarded(self._see_chapters))
        if not self.video_pads and self.probe.decodes(name):
            self._link_video(pad)
        elif self.chunk:
            self._drop(pad)
        elif name.startswith("audio/"):
            self._link_sound(pad)
        elif name.endswith("/x-unknown"):
            self._drop(pad)
        else:
            self._link_other(pad)

    def _parses(self, _, __, caps):
        """Whether packets are parsed further."""
        if structure_of(caps).get_name() not in _STYLED:
            return True
        if self.mux and self.task["container"] not in formats.MATROSKA:
            self._warn(f"{self.task['container']} takes plain text: the style and place of subtitles (ASS) is left out; mkv keeps it")
        return self.task["container"] != "mkv"

    def _see_chapters(self, _, info):
        if info.get_event().type == Gst.EventType.TOC:
            self._warn(f"{self.task['container']} takes no chapters from GStreamer: they are left out")
        return Gst.PadProbeReturn.OK

    def _decode(self, pad, ready, queue_bytes):
        """Decodes what comes from a pad; `ready` is called with the decoded one. What is queued before has at most `queue_bytes`, 0: as
        much as comes."""
        queue, decode = self._queue(queue_bytes), Gst.ElementFactory.make("decodebin")
        self.pipeline.add(decode)
        decode.connect("pad-added", self._guarded(lambda _, source: ready(source)))
        queue.link(decode)
        decode.sync_state_with_parent()
        queue.sync_state_with_parent()
        pad.link(queue.get_static_pad("sink"))

    def _queue(self, most_bytes=0):
        queue = Gst.ElementFactory.make("queue")
        for name, value in (("max-size-buffers", 0), ("max-size-time", 0), ("max-size-bytes", most_bytes)):
            queue.set_property(name, value)
        self.pipeline.add(queue)
        if self.gates is not None and not most_bytes:
            # A muxer that got packets begins with the streams whose format it knows then, and takes no other.
            pad = queue.get_static_pad("src")
            self.gates.append((pad, pad.add_probe(Gst.PadProbeType.BLOCK_DOWNSTREAM, lambda *_: Gst.PadProbeReturn.OK)))
        return queue

    def _see_formats(self, pad, info):
        """Opens the gates once each video pad of the muxer has caps. Later ones that only describe colors otherwise are left out: muxers take
        one description."""
        if info.get_event().type != Gst.EventType.CAPS:
            return Gst.PadProbeReturn.OK
        before, caps = self.formats.get(pad), info.get_event().parse_caps().to_string()
        now = re.sub(r", (colorimetry|chroma-site|framerate|streamheader)=\([a-z]+\)(< [^>]*>|[^,;]*)", "", caps)
        if before:
            return Gst.PadProbeReturn.DROP if now == before else Gst.PadProbeReturn.OK
        self.formats[pad] = now
        display = structure_of(info.get_event().parse_caps()).get_string("mastering-display-info")
        if display:  # ends with the highest and the lowest luminance, in steps of a ten-thousandth
            self.mastering = [int(part) / 10000 for part in display.split(":")[-2:]]
        if len(self.formats) == len(self.video_pads):
            gates, self.gates = self.gates, None
            for gate, block in gates or []:
                gate.remove_probe(block)
        return Gst.PadProbeReturn.OK

    def _link_video(self, pad):
        # The pads now, since the muxer begins with those that it has; what goes there, once the format of the frames is known.
        for index, layer in enumerate(self.task["layers"] or [""]):
            self.video_pads.append(self.mux.request_pad_simple("video_%u") if self.mux else
                                   self._stream(index) if self.chunk else self._pictures(layer))
            if self.mux:
                give_lengths(self.video_pads[-1])
                self._describe(self.video_pads[-1], layer)
                self._drop_title(self.video_pads[-1])
                self.video_pads[-1].add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM, self._guarded(self._see_formats))
        if self.task["parts"]:
            pad.add_probe(Gst.PadProbeType.DATA_DOWNSTREAM, self._guarded(self._instead))
            return
        decode = self._guarded(lambda: self._decode(pad, self._decoded, 32 << 20))
        if self.chunk:
            self.chunk.seek(pad, self.task["input"], decode, self._fail)
        else:
            decode()

    def _instead(self, _, info):
        """Drops the file's own video. Parts flow once it does, when the muxer has all pads."""
        if info.type & Gst.PadProbeType.BUFFER and not self.readers:
            self._link_parts()
        return Gst.PadProbeReturn.DROP

    def _link_parts(self):
        for index, target in enumerate(self.video_pads):
            queue = self._queue(32 << 20)
            self._join(queue.get_static_pad("src"), target, f"{self.task['container']} does not take the video of its parts")
            if index == 0:
                self.head = target
                target.add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._count))
            target.add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._cut))
            queue.sync_state_with_parent()
            self.readers.append(join(self.pipeline, self.task["parts"], index, queue.get_static_pad("sink")))

    def _file_sink(self, factory, location):
        sink = Gst.ElementFactory.make(factory)
        sink.set_property("location", location)
        sink.set_property("sync", False)
        sink.set_property("async", False)  # an appsink before it passes nothing on until all play
        self.pipeline.add(sink)
        sink.sync_state_with_parent()
        return sink.get_static_pad("sink")

    def _stream(self, index):
        muxer = Gst.ElementFactory.find(self.container.muxer or "multifilesink")
        forms = Gst.Caps.new_empty()
        for template in muxer.get_static_pad_templates():
            if template.direction == Gst.PadDirection.SINK and not template.name_template.startswith(("audio", "subtitle")):
                forms = forms.merge(template.get_caps())
        pay = self._add("capsfilter name=forms ! gdppay")
        pay.get_by_name("forms").set_property("caps", forms)
        keep_plain(pay.sinkpads[0])
        pay.srcpads[0].link(self._file_sink("filesink", stream(self.part, index)))
        pay.sync_state_with_parent()
        return pay.sinkpads[0]

    def _pictures(self, layer):
        folder = os.path.join(self.part, layer)
        os.makedirs(folder, exist_ok=True)
        return self._file_sink("multifilesink", folder.replace("%", "%%") + f"/%06d.{self.task['container']}")

    def _decoded(self, source):
        caps = source.get_current_caps()
        if is_pattern(self.task["input"]) and structure_of(caps).get_string("format") == "ARGB64" and \
                formats.own_pictures(exr=False).pngdec_is_late():
            mend = self._add(formats.own_line("png16 in"))
            first = picture(self.task["input"], numbered(self.task["input"])[0])
            self._own(mend, 0, "png16 in", first)
            self._join(source, mend.sinkpads[0], "its frames cannot be read")
            mend.sync_state_with_parent()
            source = mend.srcpads[0]
        video, ends, codec = self._video_bin(caps)
        self.pipeline.add(video)
        for end, target in zip(ends, self.video_pads):
            self._join(end, target, f"{self.task['container']} does not take the video codec {codec}")
        video.sync_state_with_parent()
        self.head = video.sinkpads[0]
        self.head.add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._cut))
        self.head.add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM, self._guarded(self._watch_sizes))
        self.head.add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._see_captions), "decoded")
        if not self.pictures:
            self.head.add_probe(Gst.PadProbeType.BUFFER, self._guarded(self._see_gap))
        if self.chunk:
            self.chunk.cut(self.head, self._guarded)
        self._join(source, self.head, "the elements do not take its frames: check caps and sizes")

    @staticmethod
    def _decodable(caps):
        decoders = Gst.ElementFactory.list_get_elements(Gst.ELEMENT_FACTORY_TYPE_DECODER, Gst.Rank.MARGINAL)
        return structure_of(caps).get_name() == "audio/x-raw" or bool(Gst.ElementFactory.list_filter(decoders, caps, Gst.PadDirection.SINK, False))

    def _link_sound(self, pad):
        name = self._name(pad)
        if self.task["audio"] == "none" or name.endswith("/x-unknown"):  # of which the probe has told
            self._drop(pad)
        elif not self.mux:
            self._link_other(pad)
        elif self.task["audio"] == "copy" and self._copy(pad):
            return
        elif not self._decodable(self._caps(pad)):
            self.warnings.append(f"{self.task['container']} takes no {name}, and nothing here decodes it: it is left out")
            self._drop(pad)
        else:
            codec = self.task["audio"] if self.task["audio"] != "copy" else self.container.audio
            if self.task["audio"] == "copy":
                self.warnings.append(f"{self.task['container']} takes no {self._name(pad)}: it is encoded as {codec}")
            self._encode_sound(pad, codec)

    def _encode_sound(self, pad, codec):
        encode, queue = self._add(f"audioconvert ! audioresample ! {formats.audio_encoder(codec)}"), self._queue()
        target = self._mux_pad(encode.srcpads[0].query_caps())
        if not target:
            raise TranscodeError(f"{self.task['container']} does not take the audio codec {codec}")
        encode.link(queue)
        self._join(queue.get_static_pad("src"), target, f"{codec} cannot be brought into {self.task['container']}")
        queue.sync_state_with_parent()
        encode.sync_state_with_parent()
        self._decode(pad, lambda source: self._join(source, encode.sinkpads[0], "its sound cannot be encoded"), 0)

    def _link_other(self, pad):
        if not self._copy(pad):
            self.warnings.append(f"{self.task['container']} takes no {self._name(pad)}: it is left out")
            self._drop(pad)

    @staticmethod
    def _caps(pad):
        return pad.get_current_caps() or pad.get_stream() and pad.get_stream().get_caps() or pad.query_caps()

    def _name(self, pad):
        return structure_of(self._caps(pad)).get_name()

    def _copy(self, pad):
        """Copies packets, in another form where the container wants that; False if it does not take them."""
        caps, name = self._caps(pad), self._name(pad)
        target, form = self._mux_pad(caps), ""
        if not target and name in _FORMS and Gst.ElementFactory.find(_FORMS[name][0].split()[0]):
            form, wanted = _FORMS[name]
            target = self._mux_pad(Gst.Caps.from_string(wanted)) if Gst.Caps.from_string(name).can_intersect(caps) else None
        if not target:
            return False
        queue = self._queue()
        self._join(queue.get_static_pad("src"), target, f"{name} cannot be brought into {self.task['container']}")
        queue.sync_state_with_parent()
        end = queue.get_static_pad("sink")
        if form:
            changed = self._add(form)
            changed.srcpads[0].link(end)
            changed.sync_state_with_parent()
            end = changed.sinkpads[0]
        self._join(pad, end, f"{name} cannot be copied")
        self.copied.append(name)
        return True

    @staticmethod
    def _drop(pad):
        pad.add_probe(Gst.PadProbeType.DATA_DOWNSTREAM, lambda *_: Gst.PadProbeReturn.DROP)
