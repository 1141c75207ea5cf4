# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a person names as input, as the beginning of a launch line."""
import dataclasses
import os

from gi.repository import Gio, GLib, Gst
from inverse_common import media
from inverse_common.media import deinterlace_line, upright
from inverse_common.probe import DIRECTIONS, ListError, ProbeError, jpeg_orientation, probe

TEST_LINE = "videotestsrc is-live=true ! video/x-raw,width=640,height=480,framerate=30/1"
ROOM_LINE = "rgbdtestsrc samples=1 ! video/x-raw,width=640,height=480,framerate=15/1"
DISCOVER_SECONDS = 5


class SourceError(Exception):
    """An input that cannot be opened. Says what to do."""


@dataclasses.dataclass(frozen=True)
class Source:
    """`line` outputs decoded video, among other streams; `live` frames cannot wait; `sound`: the file `text` has some; `remote`: it names an
    address, so that connections may be opened."""
    text: str  # as it was named
    title: str
    line: str
    live: bool = False
    sound: bool = False
    remote: bool = False


def quoted(text):
    """A value for a launch line."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _camera(text):
    if not os.path.exists(text):
        raise SourceError(f"there is no camera {text}; plug it in, or choose one that `ls /dev/video*` lists")
    if not os.access(text, os.R_OK | os.W_OK):
        raise SourceError(f"no permission to open {text}; join the group video: "
                          "sudo adduser $USER video, then log in again")
    return Source(text, text, f"v4l2src device={quoted(text)} ! decodebin", live=True)


def _libcamera(text):
    if not Gst.ElementFactory.find("libcamerasrc"):
        raise SourceError("libcamerasrc is missing; install gstreamer1.0-libcamera")
    name = text.partition(":")[2]
    camera = f"libcamerasrc camera-name={quoted(name)}" if name else "libcamerasrc"
    return Source(text, name or "libcamera", camera, live=True)


def _uri(text):
    protocol = text.partition(":")[0]
    if not Gst.uri_protocol_is_supported(Gst.URIType.SRC, protocol):
        raise SourceError(f'nothing installed here opens "{protocol}://"; install gstreamer1.0-plugins-good '
                          "for http://, https:// and rtsp://")
    return Source(text, text, f"uridecodebin uri={quoted(text)}", live=protocol in ("rtsp", "rtp", "udp", "srt"), remote=True)


def unreadable(path):
    """Why a file cannot be read; None if it can."""
    if not os.path.exists(path):
        return f"there is no file {path}"
    if os.path.isdir(path):
        return f"{path} is a folder; choose a file in it"
    if not os.access(path, os.R_OK):
        return f"no permission to read {path}"
    return f"{path} is empty" if os.path.getsize(path) == 0 else None


def _recording(path):
    """A folder that rgbdsrc plays; it says itself what is missing in one."""
    element = Gst.ElementFactory.make("rgbdsrc", None)
    if not element:
        raise SourceError(f"{path} is a folder; choose a file in it")
    bus = Gst.Bus()
    element.set_bus(bus)
    element.set_property("location", path)
    opened = element.set_state(Gst.State.PAUSED) != Gst.StateChangeReturn.FAILURE
    message = None if opened else bus.pop_filtered(Gst.MessageType.ERROR)
    element.set_state(Gst.State.NULL)
    if not opened:
        reason = message.parse_error()[0].message if message else f"{path} cannot be opened"
        raise SourceError(f"{path} is a folder without a recording that can be played: {reason}")
    return Source(path, os.path.basename(path), f"rgbdsrc location={quoted(path)}")


def _with_depth(path, depth):
    """How rgbdmerge plays a file with depth in its video stream of that number."""
    return (f"filesrc location={quoted(path)} ! matroskademux name=demux "
            f"demux.video_{depth} ! queue ! decodebin ! video/x-raw,format=GRAY16_LE ! merge.depth "
            f"demux.video_{1 - depth} ! queue ! decodebin ! merge.sink rgbdmerge name=merge")


def _video(path, kind):
    """The line that decodes a file, upright and without fields, and whether it has sound."""
    line = f"filesrc location={quoted(path)} ! decodebin"
    if kind == "image/jpeg":
        return upright(line, DIRECTIONS[jpeg_orientation(path) - 1]), False
    if kind.startswith("image/"):
        return line, False
    try:
        found = probe(Gst.filename_to_uri(path), DISCOVER_SECONDS)
    except ListError:
        raise SourceError(f"{path} {media.LIST_ADVICE}") from None
    except ProbeError:
        return line, False  # playing it says why
    if kind == "video/x-matroska" and found.depth_stream is not None and Gst.ElementFactory.find("rgbdmerge"):
        return _with_depth(path, found.depth_stream), found.sound
    if found.behind:
        line = f"filesrc location={quoted(path)} ! parsebin ! {found.behind} ! decodebin"
    if found.interlaced:
        line += f" ! {deinterlace_line()}"
    return upright(line, "auto" if found.turned else "identity"), found.sound


def _file(text):
    if text.startswith("file:") and not os.path.exists(text):
        text = Gio.File.new_for_uri(text).get_path() or ""
    path = os.path.abspath(text)
    if os.path.isdir(path):
        return _recording(path)
    reason = unreadable(path)
    if reason:
        raise SourceError(reason)
    if media.is_list(path):
        raise SourceError(f"{path} {media.LIST_ADVICE}")
    kind = Gio.content_type_guess(path, None)[0] or ""
    line, sound = _video(path, kind)
    if kind.startswith("image/"):
        # A still picture goes on as live video, so that it can be edited.
        return Source(text, os.path.basename(path), f"{line} ! imagefreeze is-live=true ! "
                      "video/x-raw,framerate=15/1", live=True)
    return Source(path, os.path.basename(path), line, sound=sound)


def _is_live(pipeline):
    """Whether one of its sources says that it is live."""
    found = pipeline.iterate_sources()
    while (step := found.next())[0] == Gst.IteratorResult.OK:
        if step[1].find_property("is-live") and step[1].get_property("is-live"):
            return True
    return False


def _line(text):
    try:
        pipeline = Gst.parse_launch(f"{text} ! identity")
    except GLib.Error as error:
        raise SourceError(f"this is no launch line: {error.message}") from None
    return Source(text, text.partition(" ")[0], text, live=_is_live(pipeline) or "v4l2src" in text, remote=media.names_address(text))


def kind_of(text):
    """What a text names: "file" (also a folder), "test", "room", "camera", "libcamera", "line" (a piece of a launch line) or "uri". What exists
    as a file is one."""
    if os.path.isfile(text):
        return "file"
    if text in ("test", "room"):
        return text
    if text.startswith("/dev/video"):
        return "camera"
    if text == "libcamera" or text.startswith("libcamera:"):
        return "libcamera"
    if " ! " in text or (" " in text and Gst.ElementFactory.find(text.partition(" ")[0])):
        return "line"
    return "uri" if Gst.uri_is_valid(text) and not text.startswith("file:") else "file"


def parse(text):
    """The Source for a file, the folder of a recording, a URI, /dev/videoN, "libcamera[:NAME]", "test", "room", or a
    piece of a launch line."""
    kinds = {"test": lambda _: Source(text, "Test picture", TEST_LINE, live=True),
             "room": lambda _: Source(text, "Virtual room", ROOM_LINE, live=True),
             "camera": _camera, "libcamera": _libcamera, "line": _line, "uri": _uri, "file": _file}
    return kinds[kind_of(text)](text)


def cameras():
    """(name for people, text for `parse`) of the cameras that are plugged in."""
    monitor = Gst.DeviceMonitor()
    monitor.add_filter("Video/Source", None)
    monitor.start()
    found = [_of_device(device) for device in monitor.get_devices() or []]
    monitor.stop()
    return [camera for camera in found if camera]


def _of_device(device):
    element = device.create_element(None)
    kind = element.get_factory().get_name() if element else ""
    if kind == "v4l2src":
        return device.get_display_name(), element.get_property("device")
    if kind == "libcamerasrc":
        return device.get_display_name(), "libcamera:" + (element.get_property("camera-name") or "")
    return None
