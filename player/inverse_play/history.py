# SPDX-License-Identifier: LGPL-2.1-or-later
"""Undo and redo over whole states."""
import time

MAX_STEPS = 500
SAME_STEP_SECONDS = 1.0


class History:
    """States in order, each with the label of the action that led to it."""

    def __init__(self, state, clock=time.monotonic):
        self._clock = clock
        self._states = [("", state)]
        self._at = 0
        self._key, self._time = None, 0.0

    @property
    def state(self):
        """The state now."""
        return self._states[self._at][1]

    def add(self, label, state, key=None):
        """A new state. Actions of one key that follow each other at once (a slider that moves) are one step."""
        now = self._clock()
        joins = key is not None and key == self._key and now - self._time < SAME_STEP_SECONDS
        self._key, self._time = key, now
        del self._states[self._at + 1:]
        if joins and self._at > 0:
            self._states[self._at] = (label, state)
        else:
            self._states.append((label, state))
            del self._states[:-MAX_STEPS]
            self._at = len(self._states) - 1

    def amend(self, change):
        """Changes all states, as what they have in common is described in another way now; no step."""
        self._states = [(label, change(state)) for label, state in self._states]

    def undo(self):
        """Steps back; returns the label of what was undone, or None."""
        if self._at == 0:
            return None
        self._key = None
        self._at -= 1
        return self._states[self._at + 1][0]

    def redo(self):
        """Steps forward; returns the label of what was done again, or None."""
        if self._at + 1 == len(self._states):
            return None
        self._key = None
        self._at += 1
        return self._states[self._at][0]
