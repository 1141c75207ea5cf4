# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the tests of inverse-play share: reasons to skip, files, and a display with a real mouse and keyboard."""
import array
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CLIP = ROOT / "media" / "clip.webm"
LINEAR = "colorimetry=1:4:1:1"  # as pictures of depth are
SKIPPED = 77  # the exit status by which meson knows a skipped test
# Seconds until what has not happened is given up. Kernels are built within it, on a machine with other work to do: 35 s and more.
LIMIT = 300
PLAYER = os.environ.get("INVERSE_PLAY", str(ROOT / "player"))  # the folder of the package
sys.path[:0] = [PLAYER, str(ROOT / "tests")]


def skip(reason):
    """Ends the program; meson counts it as skipped."""
    print(reason)
    sys.exit(SKIPPED)


try:
    import inverse_play  # noqa: F401
    from gi.repository import GLib, Gst
    from inverse_common.gst import structure_of
except (ImportError, ValueError) as error:
    skip(f"GStreamer for Python is missing ({error}): install python3-gi, gir1.2-gst-plugins-base-1.0")
Gst.init(None)
if not Gst.ElementFactory.find("intrinsicdecomp"):
    print("intrinsicdecomp is missing: GST_PLUGIN_PATH names no build")
    sys.exit(1)


def pump(seconds, until=lambda: False):
    """Runs the main loop until something is true; returns whether it became so within that time."""
    context, end = GLib.MainContext.default(), time.monotonic() + seconds
    while True:
        while context.pending():
            context.iteration(False)
        if until():
            return True
        if time.monotonic() >= end:
            return False
        time.sleep(0.005)


class Case(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        self.folder, state = tempfile.mkdtemp(), tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.addCleanup(shutil.rmtree, state, ignore_errors=True)
        os.environ["XDG_STATE_HOME"] = state  # what the program remembers between runs

    def path(self, name):
        """A file in the folder."""
        return os.path.join(self.folder, name)

    def clip(self, frames, name="clip.mkv", pattern="smpte", size=(160, 120), rate=10):
        """A video file of a pattern, `rate` frames a second."""
        path = self.path(name)
        run_line(f"videotestsrc num-buffers={frames} pattern={pattern} ! "
                 f"video/x-raw,width={size[0]},height={size[1]},framerate={rate}/1 ! vp8enc deadline=1 ! matroskamux ! "
                 f"filesink location={self.path('made.mkv')}")
        os.rename(self.path("made.mkv"), path)
        return path

    def recording(self, name="room"):
        """A folder of four frames of the virtual room, 30 a second: color/ and depth/."""
        folder = self.path(name)
        for part, show, form in (("color", "", "RGB"), ("depth", "show=depth max-depth=60", f"GRAY16_LE,{LINEAR}")):
            os.makedirs(os.path.join(folder, part))
            run_line(f"rgbdtestsrc is-live=false samples=1 num-buffers=4 {show} ! video/x-raw,format={form},"
                     "width=160,height=120 ! videoconvert ! pngenc ! "
                     f"multifilesink location=\"{folder}/{part}/%04d.png\"")
        return folder


def run_line(line):
    """Runs a launch line to its end."""
    pipeline = Gst.parse_launch(line)
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    if message is None or message.type == Gst.MessageType.ERROR:
        raise RuntimeError(f"{line}: {message.parse_error() if message else 'does not end'}")


def count_frames(path):
    """How many frames of a file can be read, whether it is whole or not."""
    return len(read_video(path, whole=False))


def read_video(path, whole=True):
    """(time in seconds, caps, bytes as RGB) of each frame of a file; raises if it is to be whole and cannot be read to its end."""
    pipeline = Gst.parse_launch(f"filesrc location={path} ! decodebin ! videoconvert ! video/x-raw,format=RGB ! "
                                "fakesink name=out signal-handoffs=true sync=false")
    frames = []
    pipeline.get_by_name("out").connect("handoff", lambda _, buffer, pad: frames.append(
        (buffer.pts / Gst.SECOND, structure_of(pad.get_current_caps()), buffer.extract_dup(0, buffer.get_size()))))
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    if message is None or whole and message.type == Gst.MessageType.ERROR:
        raise RuntimeError(f"{path} cannot be read")
    return frames


def read_sound(path):
    """The loudness, 0 to 1, of each tenth of a second of a file's sound."""
    pipeline = Gst.parse_launch(f"filesrc location={path} ! decodebin ! audioconvert ! audioresample ! audio/x-raw,format=S16LE,rate=8000,channels=1 ! "
                                "fakesink name=out signal-handoffs=true sync=false")
    data = []
    pipeline.get_by_name("out").connect("handoff", lambda _, buffer, pad: data.append(buffer.extract_dup(0, buffer.get_size())))
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    if message is None or message.type == Gst.MessageType.ERROR:
        raise RuntimeError(f"the sound of {path} cannot be read")
    samples = array.array("h", b"".join(data))
    return [max(map(abs, samples[at:at + 800])) / 32768 for at in range(0, len(samples), 800)]


def color(frame, x, y):
    """(red, green, blue) of a pixel of what read_video returned."""
    _, caps, data = frame
    stride = len(data) // caps.get_value("height")
    at = y * stride + 3 * x
    return tuple(data[at:at + 3])


class Display:
    """A display without a screen; the tests' own windows appear there."""

    def __init__(self, width=1440, height=900):
        if not shutil.which("Xvfb") or not shutil.which("xdotool"):
            skip("a display is missing: install xvfb, xdotool")
        read, write = os.pipe()
        # Without -noreset the server resets when its last window closes, and refuses clients meanwhile. -r: a key that comes up
        # late, on a busy machine, is not repeated.
        self._server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-noreset", "-r", "-screen", "0",
                                         f"{width}x{height}x24", "-nolisten", "tcp"],
                                        pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            self.name = ":" + number.readline().strip()
        if self.name == ":":
            raise RuntimeError("Xvfb does not start")
        os.environ.update(DISPLAY=self.name, GDK_BACKEND="x11", NO_AT_BRIDGE="1", GSETTINGS_BACKEND="memory",
                          LIBCAMERA_LOG_LEVELS="*:ERROR")
        os.environ.pop("WAYLAND_DISPLAY", None)

    def close(self):
        """Ends it."""
        self._server.terminate()
        self._server.wait()


def need_gtk():
    """The module Gtk; ends the program where it or the sink is missing. Needs a display."""
    import gi
    try:
        gi.require_version("Gtk", "3.0")
        gi.require_foreign("cairo")
        from gi.repository import Gtk
    except (ImportError, ValueError) as error:
        skip(f"GTK 3 is missing ({error}): install gir1.2-gtk-3.0, python3-gi-cairo")
    if not Gst.ElementFactory.find("gtksink"):
        skip("gtksink is missing: install gstreamer1.0-gtk3")
    return Gtk
