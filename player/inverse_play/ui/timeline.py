# SPDX-License-Identifier: LGPL-2.1-or-later
"""Play, seek, and what is known of the video: the row below the picture."""
import time

from gi.repository import Gtk

from .. import scene
from ..playback import CLOSED, ENDED, PLAYING
from .style import add_class, label

RATE_HINT = ("Frames that are edited each second, of those that the source has; time that the elements take for one. "
             "If that is longer than a frame of the source lasts, the elements limit the rate")
SCENE_HINT = ("What is remembered of frames with depth. While the camera is lost, frames are edited without it, and "
              "nothing is added to it")


def clock(seconds):
    """Minutes and seconds, with tenths."""
    return f"{int(seconds) // 60}:{seconds % 60:04.1f}"


class Timeline(Gtk.Box):
    """Follows a Playback: `update` is to be called some times a second."""

    def __init__(self, playback, on_play):
        super().__init__(spacing=10, margin=6)
        self._playback, self._showing = playback, False
        self._frames, self._time, self._milliseconds = 0, time.monotonic(), []
        self.play = Gtk.Button(label="Play", width_request=64, tooltip_text="Play or pause (Space)")
        self.play.connect("clicked", lambda _: on_play())
        self.scale = Gtk.Scale(adjustment=Gtk.Adjustment(upper=1, step_increment=5), draw_value=False, can_focus=False)
        self.scale.connect("value-changed", self._on_value)
        self.time = label("", width_chars=14)
        self.rate = add_class(Gtk.Label(width_chars=44, xalign=1, tooltip_text=RATE_HINT), "faint")
        self.pack_start(self.play, False, False, 0)
        self.pack_start(self.scale, True, True, 0)
        self.pack_start(self.time, False, False, 0)
        self.scene = add_class(label("", tooltip_text=SCENE_HINT), "faint")
        self.pack_end(self.rate, False, False, 0)
        self.pack_end(self.scene, False, False, 0)

    def _on_value(self, scale):
        if not self._showing:
            self._playback.seek(scale.get_value())

    def update(self):
        """Shows where the video is."""
        playback = self._playback
        self.play.set_label({PLAYING: "Pause", ENDED: "Again"}.get(playback.state, "Play"))
        self._showing = True
        self.scale.set_sensitive(playback.seekable)
        self.scale.set_range(0, max(playback.duration, 0.1))
        self.scale.set_value(playback.clock if playback.seekable else 0)
        self._showing = False
        self.time.set_text(self._time_text(playback))
        if playback.stage:
            self._milliseconds.append(playback.stage.milliseconds())

    @staticmethod
    def _time_text(playback):
        if playback.seekable:
            return f"{clock(playback.clock)} / {clock(playback.duration)}"
        return "" if playback.state == CLOSED else "live" if playback.source.live else clock(playback.position)

    def update_rate(self):
        """Shows how fast it is; is to be called about once a second."""
        playback, now = self._playback, time.monotonic()
        if not playback.stage or not playback.width:
            self.rate.set_text("")
            self.scene.set_text("")
            return
        frames = playback.stage.frames()
        new = frames - self._frames if frames >= self._frames else frames
        rate = new / max(now - self._time, 1e-3)
        self._frames, self._time = frames, now
        sampled, self._milliseconds = self._milliseconds, []
        moving = f" · {self._rate_text(rate, sampled)}" if playback.state == PLAYING and sampled else ""
        self.rate.set_text(f"{playback.width}×{playback.height}{moving}")
        self.scene.set_text(scene.text(playback.stage.scene()))

    def _rate_text(self, rate, milliseconds):
        """How fast it is, and what each frame takes."""
        of = f" of {self._playback.frame_rate:.3g}" if self._playback.frame_rate else ""
        return f"{rate:.1f}{of} frames/s · elements {sum(milliseconds) / len(milliseconds):.0f} ms a frame"
