# SPDX-License-Identifier: LGPL-2.1-or-later
"""Elements in a row that are exchanged while data flows, without losing any of it."""
import threading

from gi.repository import GLib, Gst


DRAIN = "inverse-play-drain"
DRAIN_SECONDS = 2  # of waiting for a queue whose frames stand still, as those of a pipeline that is paused
DRAIN_TIMES = 10  # that it waits for in a pipeline that plays, where a frame may take long: kernels are built for the first one


class Chain:
    """The elements between the source pad `entry` and the sink pad `leave` of a pipeline's bin. Each has the pads
    sink and src. They are linked in another order while `entry` pushes nothing and nothing is under way in the
    chain: an event follows the last frame through it, also through queues. `entry` must have no other probes: GStreamer
    takes a pad for idle while a probe looks at what it is about to push."""

    def __init__(self, parent, entry, leave):
        self._parent, self._entry, self._exit = parent, entry, leave
        self._lock, self._exchanging = threading.Lock(), threading.Lock()
        self._linked, self._wanted, self._gone, self._then = [], [], [], []
        self._probe = None  # identifies the one that waits for the entry, of which there is never more than one
        self._drained = threading.Event()
        leave.add_probe(Gst.PadProbeType.EVENT_DOWNSTREAM, self._on_event)

    def set(self, wanted, gone=(), then=lambda: None):
        """Links these elements, in this order, and calls `then`, both between two frames. `gone` are stopped and
        removed once they are out of the chain."""
        with self._lock:
            self._wanted = list(wanted)
            self._gone.extend(gone)
            self._then.append(then)
            if self._probe:
                return
            self._probe = probe = object()
        self._entry.add_probe(Gst.PadProbeType.IDLE, self._exchange, probe)

    def _exchange(self, _pad, _info, probe):
        """Called while the entry pushes nothing, by its thread, by that of `set`, or by both: then the first to
        come removes the probe, as GStreamer may only be told so once."""
        with self._exchanging:
            while True:
                with self._lock:
                    if self._probe is not probe:
                        return Gst.PadProbeReturn.OK
                    wanted, gone, then = self._wanted, self._gone, self._then
                    self._gone, self._then = [], []
                    if wanted == self._linked and not then:
                        self._probe = None
                        return Gst.PadProbeReturn.REMOVE
                self._drain()
                self._relink(wanted)
                for call in then:
                    call()
                for element in gone:
                    GLib.idle_add(discard, element)

    def _drain(self):
        """Waits until all frames have left the chain."""
        first = self._entry.get_peer()
        self._drained.clear()
        if first and (first.send_event(Gst.Event.new_custom(Gst.EventType.CUSTOM_DOWNSTREAM,
                                                            Gst.Structure.new_empty(DRAIN))) or self._is_ending()):
            for _ in range(DRAIN_TIMES):
                if self._drained.wait(DRAIN_SECONDS) or self._parent.get_state(0).state != Gst.State.PLAYING:
                    break

    def _is_ending(self):
        """Whether the end of the stream, behind which there are no more events, is under way in the chain."""
        entered, left = (pad.get_sticky_event(Gst.EventType.EOS, 0) for pad in (self._entry, self._exit))
        return entered and not left

    def _on_event(self, _pad, info):
        event = info.get_event()
        drained = event.type == Gst.EventType.CUSTOM_DOWNSTREAM and event.has_name(DRAIN)
        if drained or event.type == Gst.EventType.EOS:
            self._drained.set()
        return Gst.PadProbeReturn.DROP if drained else Gst.PadProbeReturn.OK

    def _links(self, elements):
        sources = [self._entry] + [e.get_static_pad("src") for e in elements]
        sinks = [e.get_static_pad("sink") for e in elements] + [self._exit]
        return zip(sources, sinks)

    def _relink(self, wanted):
        if wanted == self._linked:
            return
        for source, sink in self._links(self._linked):
            source.unlink(sink)
        fresh = [e for e in wanted if e not in self._linked]
        for element in fresh:
            if not element.get_parent():
                self._parent.add(element)
            element.set_state(Gst.State.READY)  # forgets an end of stream from when it was linked before
        for source, sink in self._links(wanted):
            source.link(sink)
        for element in fresh:
            element.sync_state_with_parent()
        self._linked = wanted


def discard(element):
    """Stops an element that is linked no more. It leaves its bin first: a warning of something in it that was at work
    concerns nobody."""
    parent = element.get_parent()
    if parent:
        parent.remove(element)
    element.set_state(Gst.State.NULL)
    return GLib.SOURCE_REMOVE
