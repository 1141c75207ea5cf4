# SPDX-License-Identifier: LGPL-2.1-or-later
"""Elements in a row that are exchanged while data flows, without losing any of it."""
import threading

from gi.repository import GLib, Gst


class Chain:
    """The elements between the source pad `entry` and the sink pad `exit` of a pipeline's bin. Each has the pads
    sink and src, and hands on what it gets in the thread that brought it: so while `entry` pushes nothing,
    nothing is under way in the chain, and it can be linked in another order."""

    def __init__(self, parent, entry, leave):
        self._parent, self._entry, self._exit = parent, entry, leave
        self._lock = threading.Lock()
        self._linked, self._wanted, self._gone, self._then = [], [], [], []
        self._waiting = False  # for a probe, of which there is never more than one

    def set(self, wanted, gone=(), then=lambda: None):
        """Links these elements, in this order, and calls `then`, both between two frames. `gone` are stopped and
        removed once they are out of the chain."""
        with self._lock:
            self._wanted = list(wanted)
            self._gone.extend(gone)
            self._then.append(then)
            if self._waiting:
                return
            self._waiting = True
        self._entry.add_probe(Gst.PadProbeType.IDLE, self._exchange)

    @property
    def pending(self):
        """Whether the last `set` has not taken place yet: it does with the next frame."""
        with self._lock:
            return self._waiting

    def _exchange(self, _pad, _info):
        """Called while the entry pushes nothing, by its thread or by that of `set`."""
        while True:
            with self._lock:
                wanted, gone, then = self._wanted, self._gone, self._then
                self._gone, self._then = [], []
                if wanted == self._linked and not then:
                    self._waiting = False
                    return Gst.PadProbeReturn.REMOVE
            self._relink(wanted)
            for call in then:
                call()
            for element in gone:
                GLib.idle_add(self._dispose, element)

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

    def _dispose(self, element):
        element.set_locked_state(True)
        element.set_state(Gst.State.NULL)
        if element.get_parent():
            self._parent.remove(element)
        return GLib.SOURCE_REMOVE
