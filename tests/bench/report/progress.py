# SPDX-License-Identifier: LGPL-2.1-or-later
"""A progress bar on the terminal; plain lines where there is none."""
import sys
import time


class Progress:
    """`weights` are how long parts take relative to each other, by the beginning of their names; `expected` parts come."""

    def __init__(self, weights, expected):
        self.weights = weights
        self.total = sum(self.weight(part) for part in expected)
        self.done = 0.0
        self.part = None
        self.start = time.monotonic()
        self.last_line = 0.0

    def weight(self, part):
        known = [name for name in self.weights if part.startswith(name)]
        return self.weights[max(known, key=len)] if known else 1

    def seconds(self):
        return time.monotonic() - self.start

    def begin(self, part):
        if self.part is not None:
            self.done += self.weight(self.part)
        self.part = part
        self.update(0, "")

    def update(self, share, text):
        """Shows that `share` (0..1) of the present part is done."""
        reached = min(1.0, (self.done + share * self.weight(self.part)) / self.total)
        seconds = self.seconds()
        line = f"{self.part}{': ' + text if text else ''}"
        if sys.stderr.isatty():
            width = 30
            bar = "█" * round(reached * width) + "░" * (width - round(reached * width))
            left = f"{seconds * (1 / reached - 1) / 60:3.0f} min left" if reached > 0.03 and seconds > 60 else " " * 12
            print(f"\r{bar} {100 * reached:3.0f} % {seconds:4.0f} s {left}  {line:60.60}", end="", file=sys.stderr, flush=True)
        elif share == 0 or seconds - self.last_line > 20:
            self.last_line = seconds
            print(f"{100 * reached:3.0f} % {seconds:4.0f} s  {line}", file=sys.stderr, flush=True)

    def end(self):
        if sys.stderr.isatty():
            print("\r" + " " * 125 + "\r", end="", file=sys.stderr)
        print(f"took {self.seconds():.0f} s", file=sys.stderr)
