"""A progress bar on the terminal; plain lines where there is none."""
import sys
import time


class Progress:
    """`parts` are (name, weight): how long each part takes relative to the others."""

    def __init__(self, parts):
        self.weights = dict(parts)
        self.total = sum(self.weights.values())
        self.done = 0.0
        self.part = None
        self.start = time.monotonic()
        self.last_line = 0.0

    def begin(self, part):
        if self.part is not None:
            self.done += self.weights[self.part]
        self.part = part
        self.update(0, "")

    def update(self, share, text):
        """Shows that `share` (0..1) of the present part is done."""
        reached = min(1.0, (self.done + share * self.weights[self.part]) / self.total)
        seconds = time.monotonic() - self.start
        line = f"{self.part}{': ' + text if text else ''}"
        if sys.stderr.isatty():
            width = 30
            bar = "█" * round(reached * width) + "░" * (width - round(reached * width))
            print(f"\r{bar} {100 * reached:3.0f} % {seconds:4.0f} s  {line:60.60}", end="", file=sys.stderr, flush=True)
        elif share == 0 or seconds - self.last_line > 20:
            self.last_line = seconds
            print(f"{100 * reached:3.0f} % {seconds:4.0f} s  {line}", file=sys.stderr, flush=True)

    def end(self):
        if sys.stderr.isatty():
            print("\r" + " " * 110 + "\r", end="", file=sys.stderr)
        print(f"took {time.monotonic() - self.start:.0f} s", file=sys.stderr)
