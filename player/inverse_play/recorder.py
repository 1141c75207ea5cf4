# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes what a pad outputs to a file, in a pipeline of its own: if that fails, the video goes on."""
import os

from gi.repository import GLib, Gst
from inverse_common import files, media
from inverse_common.gst import size_of, without

from . import sound

# (encoder with settings, muxers that take it); the first one that is installed is used.
VP8 = "vp8enc deadline=1 cpu-used=8 threads=4 end-usage=cq cq-level=10 target-bitrate=20000000 keyframe-max-dist=60"
ENCODERS = ((VP8, ("matroskamux", "webmmux")),
            ("x264enc speed-preset=veryfast quantizer=18 pass=qual ! h264parse", ("matroskamux", "mp4mux")),
            ("openh264enc bitrate=20000000 ! h264parse", ("matroskamux", "mp4mux")),
            ("jpegenc quality=92", ("matroskamux",)))
MUXERS = {".mkv": "matroskamux", ".webm": "webmmux", ".mp4": "mp4mux"}
# So that what was written before a crash can be played.
SETTINGS = {"mp4mux": "fragment-mode=first-moov-then-finalise fragment-duration=1000"}
MAX_WAITING = 4  # frames that wait for the encoder
LONGEST_GAP = Gst.SECOND
COPY_ALL = (Gst.BufferCopyFlags.FLAGS | Gst.BufferCopyFlags.TIMESTAMPS | Gst.BufferCopyFlags.META |
            Gst.BufferCopyFlags.MEMORY)  # the memory is shared


class RecorderError(Exception):
    """A file that cannot be written. Says what to do."""


def line_for(path, has_sound=False):
    """The end of the launch line that writes such a file; with an appsrc for its sound, if there is some and an encoder."""
    ending = os.path.splitext(path)[1].lower() or ".mkv"
    muxer = MUXERS.get(ending)
    if not muxer:
        raise RecorderError(f"{path} ends in none of {', '.join(MUXERS)}; choose another name")
    for encoder, muxers in ENCODERS:
        if muxer in muxers and all(Gst.ElementFactory.find(part.split()[0]) for part in (*encoder.split(" ! "), muxer)):
            spoken = has_sound and sound.encoder_for(muxer)
            heard = f" appsrc name=sound format=time caps={sound.CAPS} ! audioconvert ! {spoken} ! queue ! mux." if spoken else ""
            return (f"queue max-size-buffers={MAX_WAITING} ! videoconvert ! {media.LIKE_FIRST} ! capsfilter name=same ! {encoder} ! queue ! {muxer} name=mux {SETTINGS.get(muxer, '')} ! "
                    f"filesink name=file{heard}")
    raise RecorderError(f"no encoder for {ending} is installed; install gstreamer1.0-plugins-good, or record .mkv")


def _draft(path, overwrite, source):
    """The file that a recording is written to before it has its name; `path` itself if that is a device or a pipe."""
    if os.path.exists(path):
        if source and os.path.exists(source) and os.path.samefile(source, path):
            raise RecorderError(f"{path} is the video that is played; choose another name")
        if not os.path.isfile(path):
            return path
        if not overwrite:
            raise RecorderError(f"{path} exists; choose another name, or add --overwrite")
    stem, ending = os.path.splitext(path)
    count = 0
    while True:
        draft = f"{stem}.part{count or ''}{ending}"  # a recording that a crash ended stays
        try:
            os.close(os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
            return draft
        except FileExistsError:
            count += 1
        except OSError as error:
            raise RecorderError(f"{path} cannot be written ({error.strerror}); choose another folder") from None


class Recorder:
    """Records from the first frame after it was made until `stop`. Times are those of playing: a pause leaves no
    gap, and a seek goes on where the recording was. All frames get the size and format of the first one, which a muxer needs. The file gets its name at `stop`, STEM.part.ENDING until then.
    `overwrite`: what has that name now is replaced then. `source`: the file that is played, which is never replaced.
    `has_sound`: it has sound, which is recorded, too."""

    def __init__(self, path, pad, on_failure, overwrite=False, source=None, has_sound=False):
        self.path, self.failure, self.frames, self.note = path, None, 0, ""
        self._broken = False  # so that the file cannot be finished
        self._on_failure = on_failure
        self._pad, self._caps, self._size, self._segment = pad, None, None, None
        self._shift, self._last, self._first = 0, None, None
        line_for(path)
        self._draft = _draft(path, overwrite, source)
        self._sound = sound.open_file(source) if has_sound else None
        self._heard, self._frame = 0, None  # samples that were written; (time in the video, duration) of the last frame
        self._pipeline = Gst.parse_launch(f"appsrc name=in format=time block=true max-bytes=0 "
                                          f"max-buffers={MAX_WAITING} ! {line_for(path, self._sound)}")
        self._in, self._sound_in = self._pipeline.get_by_name("in"), self._pipeline.get_by_name("sound")
        self._pipeline.get_by_name("file").set_property("location", self._draft)
        self._same = self._pipeline.get_by_name("same")
        self._same.get_static_pad("src").add_probe(Gst.PadProbeType.BUFFER, self._keep_format)
        media.give_lengths(next(pad for pad in self._pipeline.get_by_name("mux").sinkpads if pad.get_name().startswith("video")))
        bus = self._pipeline.get_bus()
        bus.add_signal_watch()
        bus.connect("message::error", self._on_error)
        if self._pipeline.set_state(Gst.State.PLAYING) == Gst.StateChangeReturn.FAILURE:
            error = bus.pop_filtered(Gst.MessageType.ERROR)
            self._end(bus)
            self._discard()
            raise RecorderError(_reason(error, path))
        kinds = Gst.PadProbeType.BUFFER | Gst.PadProbeType.EVENT_DOWNSTREAM
        self._probe = pad.add_probe(kinds, self._on_data)

    def _on_data(self, pad, info):
        if info.type & Gst.PadProbeType.BUFFER:
            self._push(pad, info.get_buffer())
        elif info.get_event().type == Gst.EventType.SEGMENT:
            self._segment = None
        return Gst.PadProbeReturn.OK

    def _push(self, pad, buffer):
        if self.failure:
            return
        if self._segment is None:
            self._segment = pad.get_sticky_event(Gst.EventType.SEGMENT, 0).parse_segment()
        caps = pad.get_current_caps()
        if self._caps is None or not caps.is_equal(self._caps):
            self._take_caps(caps)
        copy = buffer.copy_region(COPY_ALL, 0, buffer.get_size())
        copy.pts = self._time(buffer)
        copy.dts = Gst.CLOCK_TIME_NONE
        self._add_sound(self._last)
        if self._in.emit("push-buffer", copy) == Gst.FlowReturn.OK:
            self.frames += 1
        self._frame = self._segment.to_stream_time(Gst.Format.TIME, buffer.pts) / Gst.SECOND, self._length(buffer)

    def _take_caps(self, caps):
        size = size_of(caps)
        if self._caps is None:
            self._size = size
            media.keep_first(self._pipeline, caps)
        elif size != self._size and not self.note:
            self.note = (f"The video changes from {self._size[0]}x{self._size[1]} to {size[0]}x{size[1]} after "
                         f"{self._last / Gst.SECOND:.1f} s of the recording: it is scaled to the first size.")
        self._caps = caps
        self._in.set_property("caps", caps)

    def _keep_format(self, pad, _):
        self._same.set_property("caps", without(pad.get_current_caps(), "framerate"))
        return Gst.PadProbeReturn.REMOVE

    @staticmethod
    def _length(buffer):
        return buffer.duration if buffer.duration != Gst.CLOCK_TIME_NONE else Gst.SECOND // 30

    def _add_sound(self, until):
        """Writes the sound of the last frame, up to a time of the file."""
        if not self._sound_in or not self._frame:
            return
        samples = until * sound.RATE // Gst.SECOND - self._heard
        data = Gst.Buffer.new_wrapped(self._sound.take(self._frame[0], samples))
        data.pts = self._heard * Gst.SECOND // sound.RATE
        self._heard += samples
        data.duration = self._heard * Gst.SECOND // sound.RATE - data.pts
        self._sound_in.emit("push-buffer", data)

    def _time(self, buffer):
        """The frame's time in the file: that of playing, without jumps."""
        running = self._segment.to_running_time(Gst.Format.TIME, buffer.pts)
        if self._last is None:
            self._shift = -running
        elif not self._last < running + self._shift <= self._last + LONGEST_GAP:
            self._shift = self._last + self._length(buffer) - running
        self._last = running + self._shift
        return self._last

    def _on_error(self, _bus, message):
        self._broken = True
        self._fail(_reason(message, self.path))

    def _fail(self, reason):
        if not self.failure:
            self.failure = reason
            GLib.idle_add(self._on_failure, self)

    def stop(self, seconds=10):
        """Writes what was recorded to its end and closes the file. Returns whether the file is complete."""
        self._pad.remove_probe(self._probe)
        bus = self._pipeline.get_bus()
        if self._caps is not None and not self._broken:
            if self._sound_in:
                self._add_sound(self._last + self._frame[1])
                self._sound_in.emit("end-of-stream")
            self._in.emit("end-of-stream")
            done = bus.timed_pop_filtered(seconds * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
            if not done or done.type == Gst.MessageType.ERROR:
                self.failure = self.failure or _reason(done, self.path)
        self._end(bus)
        if self.frames == 0:
            self.failure = self.failure or f"no frame came while {self.path} was to be recorded; nothing is written"
            self._discard()
        else:
            self._settle()
        return self.failure is None

    def _end(self, bus):
        self._pipeline.set_state(Gst.State.NULL)
        if self._sound:
            self._sound.close()
        bus.remove_signal_watch()

    def _discard(self):
        if self._draft != self.path:
            os.unlink(self._draft)

    def _settle(self):
        """Gives the file its name. A recording that failed does not replace a file."""
        if self._draft == self.path:
            return
        if self.failure and os.path.exists(self.path):
            self.failure += f". What was recorded is in {self._draft}"
            return
        try:
            files.settle(self._draft, self.path)
        except OSError as error:
            self.failure = self.failure or f"{self._draft} cannot get the name {self.path}: {error.strerror}"


def _reason(message, path):
    if not message:
        return f"{path} could not be finished in time; its end may be missing"
    error = message.parse_error()[0]
    if error.matches(Gst.resource_error_quark(), Gst.ResourceError.NO_SPACE_LEFT):
        return f"the disk is full: {path} ends here; free space, or record to another folder"
    if error.matches(Gst.resource_error_quark(), Gst.ResourceError.OPEN_WRITE):
        return f"{path} cannot be written; choose another folder"
    return f"{path} could not be recorded: {error.message}"
