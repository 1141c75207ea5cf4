# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a person names as input, as the beginning of a launch line."""
import dataclasses
import os

from gi.repository import Gio, GLib, Gst

TEST_LINE = "videotestsrc is-live=true ! video/x-raw,width=640,height=480,framerate=30/1"


class SourceError(Exception):
    """An input that cannot be opened. Says what to do."""


@dataclasses.dataclass(frozen=True)
class Source:
    """`line` outputs decoded video, among other streams; `live` frames cannot wait."""
    text: str  # as it was named
    title: str
    line: str
    live: bool = False


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
    if protocol == "file":
        return _file(Gio.File.new_for_uri(text).get_path() or "")
    if not Gst.uri_protocol_is_supported(Gst.URIType.SRC, protocol):
        raise SourceError(f'nothing installed here opens "{protocol}://"; install gstreamer1.0-plugins-good '
                          "for http://, https:// and rtsp://")
    return Source(text, text, f"uridecodebin uri={quoted(text)}", live=protocol in ("rtsp", "rtp", "udp", "srt"))


def unreadable(path):
    """Why a file cannot be read; None if it can."""
    if not os.path.exists(path):
        return f"there is no file {path}"
    if os.path.isdir(path):
        return f"{path} is a folder; choose a file in it"
    if not os.access(path, os.R_OK):
        return f"no permission to read {path}"
    return f"{path} is empty" if os.path.getsize(path) == 0 else None


def _file(text):
    reason = unreadable(text)
    if reason:
        raise SourceError(reason)
    path = os.path.abspath(text)
    line = f"filesrc location={quoted(path)} ! decodebin"
    if (Gio.content_type_guess(path, None)[0] or "").startswith("image/"):
        # A still picture goes on as live video, so that it can be edited.
        return Source(text, os.path.basename(path), f"{line} ! imagefreeze is-live=true ! "
                      "video/x-raw,framerate=15/1", live=True)
    return Source(path, os.path.basename(path), line)


def _line(text):
    try:
        Gst.parse_launch(f"{text} ! identity")
    except GLib.Error as error:
        raise SourceError(f"this is no launch line: {error.message}") from None
    return Source(text, text.partition(" ")[0], text, live="is-live=true" in text or "v4l2src" in text)


def parse(text):
    """The Source for a file, a URI, /dev/videoN, "libcamera[:NAME]", "test", or a piece of a launch line."""
    if text == "test":
        return Source(text, "Test picture", TEST_LINE, live=True)
    if text.startswith("/dev/video"):
        return _camera(text)
    if text == "libcamera" or text.startswith("libcamera:"):
        return _libcamera(text)
    if " ! " in text or (" " in text and Gst.ElementFactory.find(text.partition(" ")[0])):
        return _line(text)
    return _uri(text) if Gst.uri_is_valid(text) else _file(text)


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
