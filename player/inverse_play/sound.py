# SPDX-License-Identifier: LGPL-2.1-or-later
"""The sound of a file, piece by piece, for a recording of its video."""
from gi.repository import GLib, Gst

RATE, BYTES = 48000, 4  # samples a second; bytes of one, of both channels
CAPS = f"audio/x-raw,format=S16LE,layout=interleaved,rate={RATE},channels=2"
WAIT = 2 * Gst.SECOND  # for a piece that does not come; it is silent then
JUMP = 0.02  # seconds between pieces that follow each other, at most: times of frames are rounded


class Sound:
    """Decodes the sound of a file. Usable in any one thread."""

    def __init__(self, path):
        self._pipeline = Gst.parse_launch(f"uridecodebin name=in expose-all-streams=false caps=audio/x-raw ! audioconvert ! audioresample ! {CAPS} ! "
                                          "appsink name=out sync=false max-buffers=20")
        self._pipeline.get_by_name("in").set_property("uri", Gst.filename_to_uri(path))
        self._out = self._pipeline.get_by_name("out")
        self._at, self._rest = None, b""  # the time that comes next in seconds, and what was decoded of it
        self._pipeline.set_state(Gst.State.PLAYING)
        self._pipeline.get_state(WAIT)

    def take(self, start, samples):
        """That many samples from a time on, in seconds; silence where there are none."""
        if self._at is None or abs(start - self._at) > JUMP:
            self._seek(start)
        wanted = samples * BYTES
        while len(self._rest) < wanted:
            piece = self._pull()
            if piece is None:
                break
            self._rest += piece
        found, self._rest = self._rest[:wanted], self._rest[wanted:]
        self._at += samples / RATE
        return found.ljust(wanted, b"\0")

    def _seek(self, start):
        self._at, self._rest = start, b""
        flags = Gst.SeekFlags.FLUSH | Gst.SeekFlags.ACCURATE
        if not self._pipeline.seek_simple(Gst.Format.TIME, flags, round(start * Gst.SECOND)):
            return
        sample = self._out.emit("try-pull-sample", WAIT)
        if sample:  # which may begin later
            buffer = sample.get_buffer()
            off = round((buffer.pts / Gst.SECOND - start) * RATE) * BYTES
            data = buffer.extract_dup(0, buffer.get_size())
            self._rest = data[-off:] if off < 0 else bytes(off) + data

    def _pull(self):
        sample = self._out.emit("try-pull-sample", WAIT)
        buffer = sample.get_buffer() if sample else None
        return buffer.extract_dup(0, buffer.get_size()) if buffer else None

    def close(self):
        """Ends it; nothing is taken any more."""
        self._pipeline.set_state(Gst.State.NULL)


def encoder_for(muxer):
    """What brings sound into a file; empty if nothing here does."""
    lines = ("avenc_aac ! aacparse", "opusenc") if muxer == "mp4mux" else ("opusenc", "vorbisenc")
    return next((line for line in lines if all(Gst.ElementFactory.find(part) for part in line.split(" ! "))), "")


def open_file(path):
    """The Sound of a file; None if it cannot be decoded."""
    try:
        return Sound(path)
    except GLib.Error:
        return None
