# SPDX-License-Identifier: LGPL-2.1-or-later
"""Chunks of a long file: where it is divided, how one is decoded, and how the encoded ones are joined. Times are stream times in ns."""
import os
import struct
import subprocess
from dataclasses import dataclass

import gi

gi.require_version("Gst", "1.0")
from gi.repository import GLib, Gst  # noqa: E402
from inverse_common.gst import structure_of  # noqa: E402
from inverse_common.probe import ProbeError, probe  # noqa: E402


# A demuxer may begin its segment where a seek goes to, and decoders move the frame that is shown then to its start: one that is dropped.
SEEK_BEFORE = Gst.SECOND // 2
ONE_SEGMENT = ("mkv", "webm")  # whose times do not jump, once streams that begin later have begun
FIRST_PACKETS = 16  # by which they have
SEEKABLE = ("mp4", "m4v", "mov", "mkv", "webm")  # whose frames have the same times after a seek


@dataclass
class Chunk:
    """The frames at `start` <= time < `end`; the elements get those from `lead` on. `end` None: to the end of the file. `first`: the caps of
    the file's first frame, whose size and rate all chunks have."""

    start: int
    end: int | None
    lead: int
    first: str

    def first_caps(self):
        return Gst.Caps.from_string(self.first)

    def seek(self, pad, path, ready, failed):
        """Makes what comes from a parser's pad, of the file at `path`, begin with the last key frame before `lead`. `ready`: called to link the
        pad, which no data has left then; `failed`: if there is no such frame."""
        target = self.lead - SEEK_BEFORE
        if target <= 0:
            ready()
            return
        state = {"asked": False, "packets": 0, "shift": 0}

        def ask():
            segment = pad.get_sticky_event(Gst.EventType.SEGMENT, 0)
            if segment:
                segment = segment.parse_segment()
                state["shift"] = segment.start - segment.time
            flags = Gst.SeekFlags.FLUSH | Gst.SeekFlags.KEY_UNIT | Gst.SeekFlags.SNAP_BEFORE
            event = Gst.Event.new_seek(1.0, Gst.Format.TIME, flags, Gst.SeekType.SET, target, Gst.SeekType.NONE, 0)
            if not pad.send_event(event):
                failed("it has no index to seek in: a file like this is not divided")
            return GLib.SOURCE_REMOVE

        def before(_, info):
            if info.type & Gst.PadProbeType.BUFFER or info.get_event().type == Gst.EventType.EOS:
                state["packets"] += 1
                ended = bool(info.type & Gst.PadProbeType.EVENT_DOWNSTREAM)
                if not state["asked"] and (ended or state["packets"] > FIRST_PACKETS):
                    state["asked"] = True
                    GLib.idle_add(ask)
                return Gst.PadProbeReturn.DROP
            if info.get_event().type == Gst.EventType.FLUSH_STOP:
                if path.lower().endswith(ONE_SEGMENT):
                    pad.add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM, lambda pad, info: _shift(pad, info, state["shift"]))
                ready()
                return Gst.PadProbeReturn.REMOVE
            return Gst.PadProbeReturn.OK

        pad.add_probe(Gst.PadProbeType.BUFFER | Gst.PadProbeType.EVENT_DOWNSTREAM | Gst.PadProbeType.EVENT_FLUSH, before)

    def cut(self, pad, guarded):
        """Leaves out what comes before `lead`, and ends a stream of frames at `end`. `guarded`: makes a function of one that reports what it
        throws; a probe that throws drops frames."""
        def enter(_, info):
            time = _stream_time(pad, info.get_buffer())
            if self.end is not None and time >= self.end:
                pad.send_event(Gst.Event.new_eos())
                return Gst.PadProbeReturn.DROP
            return Gst.PadProbeReturn.DROP if time < self.lead else Gst.PadProbeReturn.OK

        pad.add_probe(Gst.PadProbeType.BUFFER, guarded(enter))

    def drop_lead(self, pad, guarded):
        """Leaves out what the elements made of frames before `start`."""
        if self.start > 0:
            pad.add_probe(Gst.PadProbeType.BUFFER, guarded(lambda _, info: Gst.PadProbeReturn.DROP
                          if _stream_time(pad, info.get_buffer()) < self.start else Gst.PadProbeReturn.OK))


def is_fragmented(path):
    """Whether a file is an MP4 whose index is divided (moof). After a seek, qtdemux gives frames of such a file other times."""
    with open(path, "rb") as file:
        while len(head := file.read(16)) >= 8:
            size, kind = struct.unpack(">I4s", head[:8])
            if kind == b"moof":
                return True
            if size == 1 and len(head) == 16:
                size, = struct.unpack(">Q", head[8:])
            if size < 8 or not kind.isalnum():
                return False
            file.seek(size - len(head), os.SEEK_CUR)
    return False


def _shift(pad, info, shift):
    """Gives a segment the stream times that it has without a seek: matroskademux counts from the first frame after one, and mostly from 0
    without.
    `shift`: of times in the file against these."""
    event = info.get_event()
    if event.type != Gst.EventType.SEGMENT:
        return Gst.PadProbeReturn.OK
    segment = event.parse_segment().copy()
    if segment.start - segment.time == shift:
        return Gst.PadProbeReturn.OK
    segment.start = max(segment.start, shift)
    segment.time = segment.start - shift
    pad.push_event(Gst.Event.new_segment(segment))
    return Gst.PadProbeReturn.DROP


def _stream_time(pad, buffer):
    if buffer.pts == Gst.CLOCK_TIME_NONE:
        return 0
    segment = pad.get_sticky_event(Gst.EventType.SEGMENT, 0).parse_segment()
    sign, time = segment.to_stream_time_full(Gst.Format.TIME, buffer.pts)  # also of what is before the segment
    return time if sign > 0 else -time


def divide(uri, seconds, overlap, shots):
    """Chunks of at least some `seconds`, each with `overlap` frames of lead. They begin at cuts; with `shots`, where there is no cut for
    another half of that time, without one. Throws ProbeError."""
    found, starts = probe(uri), []
    first = _first_caps(uri, found)
    length = int(seconds * Gst.SECOND)
    while found.seconds * Gst.SECOND - max(starts, default=0) > 1.5 * length:
        target = max(starts, default=0) + length
        start = _first_cut(uri, found, target, target + length // 2 if shots else None)
        if start is None and not shots:
            break
        starts.append(target if start is None else start)
    # Of a frame's time some, since times are rounded.
    frame = Gst.SECOND / found.rate
    starts = [int(start - 0.25 * frame) for start in starts]
    leads = [max(int(start - overlap * frame - 0.25 * frame), 0) if overlap else start for start in starts]
    return [Chunk(start, end, lead, first) for start, end, lead in zip([0, *starts], [*starts, None], [0, *leads])]


def _first_caps(uri, found):
    """The caps of the first frame as it is decoded, as text. `found`: the file's Probe. Throws ProbeError."""
    pipeline = _decoding(uri, found, "fakesink name=sink")
    try:
        pipeline.set_state(Gst.State.PAUSED)
        if not _reached(pipeline, Gst.MessageType.ASYNC_DONE):
            raise ProbeError("its first frame cannot be decoded")
        return pipeline.get_by_name("sink").get_static_pad("sink").get_current_caps().to_string()
    finally:
        pipeline.set_state(Gst.State.NULL)


def _first_cut(uri, found, begin, end):
    """The time of the first frame of the first shot that begins in [begin, end), or None. `found`: the file's Probe; `end` None: to the end of
    the file."""
    pipeline = _decoding(uri, found, "videoconvert ! videoscale ! video/x-raw,format=I420,width=160,height=90 ! scenechange ! "
                                     "fakesink name=sink sync=false")
    state = {"cut": False, "time": None}

    def seen(pad, info):
        if info.type & Gst.PadProbeType.EVENT_DOWNSTREAM:
            structure = structure_of(info.get_event())
            state["cut"] = state["cut"] or structure is not None and structure.get_name() == "GstForceKeyUnit"
            return Gst.PadProbeReturn.OK
        time = _stream_time(pad, info.get_buffer())
        if end is not None and time >= end:
            pad.send_event(Gst.Event.new_eos())
            return Gst.PadProbeReturn.DROP
        if state["cut"] and time >= begin and state["time"] is None:
            state["time"] = time
            pad.send_event(Gst.Event.new_eos())
        state["cut"] = False
        return Gst.PadProbeReturn.OK

    pipeline.get_by_name("sink").get_static_pad("sink").add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM | Gst.PadProbeType.BUFFER, seen)
    try:
        pipeline.set_state(Gst.State.PAUSED)
        if (_reached(pipeline, Gst.MessageType.ASYNC_DONE)
                and pipeline.seek_simple(Gst.Format.TIME, Gst.SeekFlags.FLUSH | Gst.SeekFlags.KEY_UNIT, begin)):
            pipeline.set_state(Gst.State.PLAYING)
            _reached(pipeline, Gst.MessageType.EOS)
        return state["time"]
    finally:
        pipeline.set_state(Gst.State.NULL)


def _decoding(uri, found, rest):
    """A pipeline of a file's decoded video and of the elements of `rest`. `found`: its Probe."""
    pipeline = Gst.parse_launch(f"parsebin name=parse decodebin name=decode ! {rest}")
    source, parse = Gst.Element.make_from_uri(Gst.URIType.SRC, uri, None), pipeline.get_by_name("parse")
    pipeline.add(source)
    source.link(parse)

    def added(_, pad):
        target = pipeline.get_by_name("decode").get_static_pad("sink")
        structure = structure_of(pad.query_caps())
        if structure and found.decodes(structure.get_name()) and not target.is_linked():
            pad.link(target)
        else:
            pad.add_probe(Gst.PadProbeType.DATA_DOWNSTREAM, lambda *_: Gst.PadProbeReturn.DROP)

    parse.connect("pad-added", added)
    return pipeline


def _reached(pipeline, kind):
    """Whether such a message came before an error or the end."""
    message = pipeline.get_bus().timed_pop_filtered(Gst.CLOCK_TIME_NONE, kind | Gst.MessageType.ERROR | Gst.MessageType.EOS)
    return message.type == kind


def keep_plain(pad):
    """Lets those events through that gdpdepay reads and that are of use: a stream-start without the stream that it carries, caps, segments
    and the end."""
    kept = (Gst.EventType.CAPS, Gst.EventType.SEGMENT, Gst.EventType.EOS)

    def pass_on(_, info):
        event = info.get_event()
        if event.type == Gst.EventType.STREAM_START and structure_of(event).has_field("stream"):
            pad.send_event(Gst.Event.new_stream_start(event.parse_stream_start()))
        elif event.type == Gst.EventType.STREAM_START or event.type in kept:
            return Gst.PadProbeReturn.OK
        return Gst.PadProbeReturn.DROP

    pad.add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM, pass_on)


def stream(folder, index):
    """The file of one of a chunk's encoded video streams."""
    return os.path.join(folder, f"{index}.gdp")


def join(pipeline, folders, index, target):
    """Brings one of the video streams of chunks to a pad, as that of an undivided file. Returns the process that reads them."""
    reader = subprocess.Popen(["cat", "--", *(stream(folder, index) for folder in folders)], stdout=subprocess.PIPE)
    read, depay = Gst.ElementFactory.make("fdsrc"), Gst.ElementFactory.make("gdpdepay")
    read.set_property("fd", reader.stdout.fileno())
    state = {"ended": False}

    def last(_, info):
        state["ended"] = state["ended"] or info.get_event().type == Gst.EventType.EOS
        return Gst.PadProbeReturn.OK

    def event(pad, info):
        if info.get_event().type == Gst.EventType.EOS and not state["ended"]:
            return Gst.PadProbeReturn.DROP  # a chunk's
        return _run_by_stream_time(pad, info)

    depay.get_static_pad("sink").add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM, last)
    depay.get_static_pad("src").add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM, event)
    pipeline.add(read)
    pipeline.add(depay)
    read.link(depay)
    depay.get_static_pad("src").link(target)
    depay.sync_state_with_parent()
    read.sync_state_with_parent()
    return reader


def _run_by_stream_time(pad, info):
    """A chunk's running time began with its lead; that of the whole begins with the file."""
    event = info.get_event()
    if event.type != Gst.EventType.SEGMENT:
        return Gst.PadProbeReturn.OK
    segment = event.parse_segment().copy()
    if segment.base == segment.time:
        return Gst.PadProbeReturn.OK
    segment.base = segment.time
    pad.push_event(Gst.Event.new_segment(segment))
    return Gst.PadProbeReturn.DROP
