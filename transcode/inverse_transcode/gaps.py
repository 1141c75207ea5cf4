# SPDX-License-Identifier: LGPL-2.1-or-later
"""Gaps in a video of a steady rate: damaged bytes, which demuxers and decoders skip without an error, or frames that a recorder dropped."""
import collections
import heapq

_STEADY, _ALIKE = 0.9, 1.25  # share of the steps that are no longer than this many usual ones, in a video of a steady rate
_GAP = 2.5  # usual steps
_KEPT = 1000  # of the longest steps


class Gaps:
    """Takes the times of pictures in order, in nanoseconds."""

    def __init__(self):
        self._last, self._steps, self._longest = None, collections.Counter(), []

    def add(self, time):
        if self._last is not None and time > self._last:
            step = time - self._last
            self._steps[round(step / 1e6)] += 1  # files count milliseconds
            (heapq.heappush if len(self._longest) < _KEPT else heapq.heappushpop)(self._longest, (step, self._last))
        self._last = time

    def found(self):
        """(begin, end) of each in seconds, in order; none if there is no steady rate."""
        count, seen, usual = sum(self._steps.values()), 0, 0
        for usual in sorted(self._steps):
            seen += self._steps[usual]
            if 2 * seen >= count:
                break
        if sum(n for step, n in self._steps.items() if step <= _ALIKE * usual + 1) < _STEADY * count:
            return []
        return sorted((begin / 1e9, (begin + step) / 1e9) for step, begin in self._longest if step > _GAP * usual * 1e6)

    def warning(self):
        """In words, or "" if there is none."""
        found = self.found()
        if not found:
            return ""
        begin, end = max(found, key=lambda gap: gap[1] - gap[0])
        more = f", and {len(found) - 1} shorter gaps" if len(found) > 1 else ""
        return f"it has no pictures from {begin:.2f} to {end:.2f} s{more}: it may be damaged, or frames were dropped when it was recorded"
