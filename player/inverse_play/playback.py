# SPDX-License-Identifier: LGPL-2.1-or-later
"""Plays a source through a project's elements: states, seeks, the end, and what goes wrong."""
from gi.repository import GLib, Gst, GstVideo
from inverse_common import media
from inverse_common.gst import size_of, structure_of

from . import messages, source
from .chain import discard
from .messages import Trouble
from .reach import Reach
from .stage import Stage

CLOSED, PLAYING, PAUSED, ENDED, FAILED = "closed", "playing", "paused", "ended", "failed"
DRAIN_MS = 400  # between looks at whether frames still come after an error


class Playback:
    """One source at a time. `make_sink()` returns the element that shows pictures. Calls of `listener`, in the main
    thread: on_state(), on_trouble(Trouble), on_stopping() before frames end, on_finished() after the last one,
    on_property(element, name, value), on_event(structure) with an element message.
    `on_mouse`(kind, x, y, shift) gets the mouse over the picture, in pixels of the frame, and whether Shift is down,
    in the thread of the sink's events; elements get it as well unless it returns True."""

    def __init__(self, make_sink, listener):
        self._make_sink, self._listener = make_sink, listener
        self.on_mouse = lambda kind, x, y, shift: False
        self.source, self.stage, self.state = None, None, CLOSED
        self.seekable, self.duration, self.position = False, 0.0, 0.0
        self.width = self.height = 0
        self.presses = 0  # of the mouse so far, and touches of a hand
        self.sink = None
        self._pipeline, self._branch = None, None
        self._seeking, self._next_seek = False, None
        self._sought = self._inside = 0.0  # times: of the last seek, and inside of the frame that is shown
        self._shown = 0
        self._reach, self._missing = None, 0.0

    def open(self, opened, project):
        """Plays from the beginning. Raises SourceError or ElementError."""
        self.close()
        self.source = opened
        media.allow_lists(opened.remote)
        self._pipeline = _parse(opened)
        self._pipeline.get_bus().add_signal_watch()
        try:
            self._assemble(opened, project)
        except BaseException:
            self.close()
            raise
        self._set_state(PLAYING)
        self._pipeline.set_state(Gst.State.PLAYING)

    def _assemble(self, opened, project):
        self.sink = self._make_sink()
        self.sink.set_property("sync", not opened.live)
        self._pipeline.add(self.sink)
        queue = self._pipeline.get_by_name("inverse-entry")
        entry = queue.get_static_pad("src")
        self._entry, self._missing = entry, 0.0
        self._reach = Reach(self._pipeline, queue.get_static_pad("sink"))
        self.stage = Stage(self._pipeline, entry, self.sink, project, self._on_property)
        self.sink.get_static_pad("sink").add_probe(Gst.PadProbeType.BUFFER, self._on_buffer)
        self.stage.mouse_pad.add_probe(Gst.PadProbeType.EVENT_UPSTREAM, self._on_event)
        self._pipeline.get_bus().connect("message", self._on_message)

    def close(self):
        """Stops and releases everything."""
        if not self._pipeline:
            return
        self._listener.on_stopping()
        self.hide_original()
        self._pipeline.get_bus().remove_signal_watch()
        self._pipeline.set_state(Gst.State.NULL)
        self._pipeline = self.stage = self.sink = self._entry = self._reach = None
        self._seeking, self._next_seek = False, None
        self.seekable, self.duration, self.position, self._shown = False, 0.0, 0.0, 0
        self.width = self.height = 0
        self._set_state(CLOSED)

    @property
    def clock(self):
        """The time to show: of the frame that is shown; of the end if it is reached, though the last frame begins
        before it and may be left out."""
        return self.duration if self.state == ENDED and not self._missing and self.duration else self.position

    @property
    def waits(self):
        """Whether a frame is on its way that was asked for: the first one, or that of a seek or of a step on a picture that stands."""
        return self.state not in (CLOSED, FAILED) and (self._shown == 0 or self._seeking)

    @property
    def goal(self):
        """The time that the last seek leads to, which may wait for the one under way; else the position."""
        return self.position if self._next_seek is None else self._next_seek[0]

    @property
    def frame_rate(self):
        """Frames a second that the source has; 0 if unknown."""
        caps = self._entry.get_current_caps() if self._entry else None
        found, rate, of = structure_of(caps).get_fraction("framerate") if caps else (False, 0, 1)
        return rate / of if found else 0.0

    def _set_state(self, state):
        self.state = state
        self._listener.on_state()

    def play(self):
        """Plays on; from the beginning if the end is reached. True unless the source has to be opened again."""
        if self.state in (CLOSED, FAILED):
            return False
        if self.state == ENDED:
            if not self.seekable:
                return False
            self._set_state(PLAYING)
            self.seek(0)
        self._set_state(PLAYING)
        self._pipeline.set_state(Gst.State.PLAYING)
        return True

    def pause(self):
        """Stays on this frame."""
        if self.state == PLAYING:
            self._set_state(PAUSED)
            self._pipeline.set_state(Gst.State.PAUSED)

    def seek(self, seconds):
        """Goes to a time of a file. While one seek runs, only the last of others is kept."""
        seconds = min(max(seconds, 0.0), self.duration)
        self._seek(seconds, seconds)

    def _seek(self, seconds, inside):
        """Goes to the frame at the time `inside`, and calls that time `seconds`."""
        if not self.seekable or self.state in (CLOSED, FAILED):
            return
        if self._seeking:
            self._next_seek = seconds, inside
            return
        if self.state == ENDED:
            self._set_state(PAUSED)
        self._seeking = True
        self.position, self._sought = seconds, inside
        # By the element, not by the pipeline, which would seek once for each of its sinks.
        event = Gst.Event.new_seek(1.0, Gst.Format.TIME, Gst.SeekFlags.FLUSH | Gst.SeekFlags.ACCURATE,
                                   Gst.SeekType.SET, round(inside * Gst.SECOND), Gst.SeekType.NONE, 0)
        if not self.stage.compose.send_event(event):
            self._seeking = False

    def apply(self, project):
        """Shows the project; a frame that stands still is edited again."""
        if self.stage and self.stage.project.elements() != project.elements():
            self.stage.apply(project)
            self.refresh()

    def refresh(self):
        """Edits the frame again that stands still."""
        ended = self.state == ENDED
        if self.state in (PAUSED, ENDED) and self.seekable:
            self._seek(*self._next_seek or (self.position, self._sought if self._seeking else self._inside))
            if ended:
                self._set_state(ENDED)

    def show_original(self, make_sink):
        """Shows the unedited frames as well, in another sink."""
        if self._branch or not self._pipeline:
            return
        sink = make_sink()
        self._branch = Gst.parse_bin_from_description(
            "queue name=in max-size-buffers=2 max-size-bytes=0 max-size-time=0 leaky=downstream ! "
            "intrinsiccompose show=input ! videoconvert name=out", False)
        self._branch.add_pad(Gst.GhostPad.new("sink", self._branch.get_by_name("in").get_static_pad("sink")))
        self._branch.add(sink)
        self._branch.get_by_name("out").link(sink)
        sink.get_static_pad("sink").get_peer().add_probe(Gst.PadProbeType.EVENT_UPSTREAM, self._on_event)
        for name, value in (("qos", False), ("sync", not self.source.live)):
            sink.set_property(name, value)
        self._pipeline.add(self._branch)
        self._branch.sync_state_with_parent()
        self.stage.branch_pad.link(self._branch.get_static_pad("sink"))
        self._seeking = False  # a seek under way does not end before the new sink has a frame: by another seek
        self.refresh()

    def hide_original(self):
        """Ends `show_original`."""
        if not self._branch:
            return
        branch, self._branch = self._branch, None
        self.stage.branch_pad.add_probe(Gst.PadProbeType.IDLE, self._unlink, branch)

    def _unlink(self, pad, _info, branch):
        pad.unlink(branch.get_static_pad("sink"))
        GLib.idle_add(discard, branch)
        return Gst.PadProbeReturn.REMOVE

    def every_frame(self, wanted):
        """Shows every frame, however late, or drops late ones. Live video always drops."""
        if self.sink and self.sink.find_property("max-lateness"):
            self.sink.set_property("qos", not wanted)

    def _on_property(self, element, name, value):
        GLib.idle_add(self._listener.on_property, element, name, value)

    def _on_buffer(self, pad, info):
        buffer = info.get_buffer()
        self._shown += 1
        segment = pad.get_sticky_event(Gst.EventType.SEGMENT, 0)
        if segment and buffer.pts != Gst.CLOCK_TIME_NONE:
            time = segment.parse_segment().to_stream_time(Gst.Format.TIME, buffer.pts)
            if time != Gst.CLOCK_TIME_NONE:
                self._find(time / Gst.SECOND, buffer)
        self.width, self.height = size_of(pad.get_current_caps())
        return Gst.PadProbeReturn.OK

    def _find(self, time, buffer):
        """Takes the time of a frame that is shown."""
        if abs(time - self._sought) < 1e-6:  # a decoder begins the frame in which a seek ends there
            self._inside = time
            return
        # At its own beginning the one before may be found: Matroska's times are rounded to milliseconds.
        length = buffer.duration / Gst.SECOND if buffer.duration != Gst.CLOCK_TIME_NONE else 0.0
        self.position, self._inside = time, time + length / 2

    def _on_event(self, _pad, info):
        event = info.get_event()
        if event.type != Gst.EventType.NAVIGATION:
            return Gst.PadProbeReturn.OK
        fields = structure_of(event)
        kind = fields.get_string("event") or ""
        if not kind.startswith("mouse-button") and kind != "mouse-move":
            return Gst.PadProbeReturn.OK
        self.presses += kind == "mouse-button-press"
        held = fields.get_value("state") if fields.has_field("state") else 0
        shift = bool(held & GstVideo.NavigationModifierType.SHIFT_MASK)
        used = self.on_mouse(kind, fields.get_value("pointer_x"), fields.get_value("pointer_y"), shift)
        return Gst.PadProbeReturn.DROP if used else Gst.PadProbeReturn.OK

    def _on_message(self, _bus, message):
        handler = {Gst.MessageType.ERROR: self._on_failure, Gst.MessageType.WARNING: self._on_failure,
                   Gst.MessageType.EOS: self._on_end, Gst.MessageType.ASYNC_DONE: self._on_ready,
                   Gst.MessageType.LATENCY: self._on_latency,
                   Gst.MessageType.ELEMENT: self._on_element}.get(message.type)
        if handler and self._pipeline:
            handler(message)

    def _on_latency(self, _message):
        self._pipeline.recalculate_latency()

    def _on_element(self, message):
        structure = structure_of(message)
        if structure:
            self.presses += structure.has_name("inverse-touch-began")
            self._listener.on_event(structure)

    def _on_ready(self, _message):
        query = Gst.Query.new_seeking(Gst.Format.TIME)
        self.seekable = bool(not self.source.live and self._pipeline.query(query) and query.parse_seeking()[1])
        self._read_duration()
        self._seeking = False
        if self._next_seek is not None:
            following, self._next_seek = self._next_seek, None
            self._seek(*following)
        self._listener.on_state()

    def _read_duration(self):
        found, duration = self._pipeline.query_duration(Gst.Format.TIME)
        if found and duration > 0:
            self.duration = duration / Gst.SECOND

    def _on_end(self, _message):
        """The last frame stays."""
        if self.state == FAILED:
            return
        first = self.state != ENDED
        self._read_duration()  # some parsers only estimate it at the beginning
        self._missing = self._reach.missing(self.duration, self.frame_rate)
        self._seeking = False
        self._listener.on_stopping()
        self._pipeline.set_state(Gst.State.PAUSED)
        self._set_state(ENDED)
        if first and self._missing:
            self._listener.on_trouble(Trouble(
                f"The file ends at {self.duration - self._missing:.1f} s of {self.duration:.1f} s: it is cut off.",
                "Copy or download it again to have the rest.", True))
        self._listener.on_finished()

    def _on_failure(self, message):
        if self.state == FAILED:
            return
        trouble = messages.describe(message)
        if trouble.fatal:
            self._set_state(FAILED)
            GLib.timeout_add(DRAIN_MS, self._drain, self._pipeline, self._shown)
        self._listener.on_trouble(trouble)

    def _drain(self, pipeline, shown):
        """Frames that were decoded before the error are still shown and recorded; then it stops."""
        if pipeline is not self._pipeline:
            return GLib.SOURCE_REMOVE
        if shown != self._shown or self._is_working():
            GLib.timeout_add(DRAIN_MS, self._drain, pipeline, self._shown)
            return GLib.SOURCE_REMOVE
        self._listener.on_stopping()
        self._pipeline.set_state(Gst.State.PAUSED)
        self._listener.on_finished()
        return GLib.SOURCE_REMOVE

    def _is_working(self):
        """Whether frames wait while another is edited, as the second one does while kernels are built for the first."""
        return Gst.State.PLAYING in self._pipeline.get_state(0)[1:] and \
            self._entry.get_task_state() == Gst.TaskState.STARTED and \
            self._pipeline.get_by_name("inverse-entry").get_property("current-level-buffers") > 0


def _parse(opened):
    size = "leaky=downstream max-size-buffers=1" if opened.live else "max-size-buffers=4"
    try:
        return Gst.parse_launch(f"{opened.line} ! videoconvert ! queue name=inverse-entry {size} "
                                "max-size-bytes=0 max-size-time=0")
    except GLib.Error as error:
        raise source.SourceError(f"{opened.text} cannot be opened: {error.message}") from None
