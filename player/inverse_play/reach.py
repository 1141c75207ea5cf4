# SPDX-License-Identifier: LGPL-2.1-or-later
"""How far the streams of a file go: whether a file that ended is whole."""
from gi.repository import Gst

LONGEST, SHARE, FRAMES = 1.0, 0.05, 2  # what may be missing at the end: seconds, of the duration, frames


class Reach:
    """Reads the times of what demuxers and sources of video output, of sound as well: that often ends after the video.
    Not those of frames that are shown, as a slow machine leaves some out. Without any of these, `pad` counts, which decoded video
    flows through."""

    def __init__(self, pipeline, pad):
        self._demuxed, self._decoded = 0.0, 0.0
        self._read, self._source = 0, None
        pipeline.connect("deep-element-added", lambda _pipeline, _bin, element: self._look_at(element))
        found = pipeline.iterate_recurse()
        while (step := found.next())[0] == Gst.IteratorResult.OK:
            self._look_at(step[1])
        pad.add_probe(Gst.PadProbeType.BUFFER, self._on_decoded)

    def missing(self, duration, frame_rate):
        """Seconds that a file of this duration lacks at its end, as it is cut off; 0 if it is whole."""
        lacks = duration - (self._demuxed or self._decoded)
        frames = FRAMES / frame_rate if frame_rate else 0.0
        allowed = max(frames, min(LONGEST, SHARE * duration))
        return lacks if lacks > allowed and self._is_read() else 0.0

    def _is_read(self):
        """Whether the source was read to its end. A demuxer may stop before, as nothing plays the sound: what comes
        then is not missing."""
        known, size = self._source.query_duration(Gst.Format.BYTES) if self._source else (False, 0)
        return not known or self._read >= size

    def _look_at(self, element):
        kind = element.get_factory().get_metadata("klass") if element.get_factory() else ""
        if "Demux" in kind:
            element.connect("pad-added", self._on_pad)
        elif "Source" in kind and element.get_static_pad("src"):
            pad = element.get_static_pad("src")
            if "Video" in kind:
                pad.add_probe(Gst.PadProbeType.BUFFER, self._on_demuxed)
            else:
                self._source = pad
                pad.add_probe(Gst.PadProbeType.BUFFER, self._on_read)

    def _on_pad(self, _demuxer, pad):
        if pad.get_direction() == Gst.PadDirection.SRC:
            pad.add_probe(Gst.PadProbeType.BUFFER | Gst.PadProbeType.BUFFER_LIST, self._on_demuxed)

    def _on_read(self, _pad, info):
        buffer = info.get_buffer()
        # What is read before may be an index at the end.
        if buffer.offset != Gst.BUFFER_OFFSET_NONE and (self._demuxed or self._decoded):
            self._read = max(self._read, buffer.offset + buffer.get_size())
        return Gst.PadProbeReturn.OK

    def _on_demuxed(self, pad, info):
        listed = info.get_buffer_list() if info.type & Gst.PadProbeType.BUFFER_LIST else None
        buffer = listed.get(listed.length() - 1) if listed else info.get_buffer()
        self._demuxed = max(self._demuxed, _end(pad, buffer))
        return Gst.PadProbeReturn.OK

    def _on_decoded(self, pad, info):
        self._decoded = max(self._decoded, _end(pad, info.get_buffer()))
        return Gst.PadProbeReturn.OK


def _end(pad, buffer):
    """When a buffer ends, in seconds of the file; 0 if that is unknown."""
    event = pad.get_sticky_event(Gst.EventType.SEGMENT, 0)
    if not event or buffer.pts == Gst.CLOCK_TIME_NONE:
        return 0.0
    begin = event.parse_segment().to_stream_time(Gst.Format.TIME, buffer.pts)
    length = buffer.duration if buffer.duration != Gst.CLOCK_TIME_NONE else 0
    return (begin + length) / Gst.SECOND if begin != Gst.CLOCK_TIME_NONE else 0.0
