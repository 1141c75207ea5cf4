# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is in a file."""
from dataclasses import dataclass

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstPbutils", "1.0")
from gi.repository import GLib, Gst, GstPbutils  # noqa: E402


class ProbeError(Exception):
    """A file that cannot be transcoded, and why."""


@dataclass
class Probe:
    """Of the video stream that is transcoded."""

    seconds: float  # of the file; 0: not known
    turned: bool  # whether a player is to turn it
    still: bool  # its pictures are compressed one by one
    rate: float = 25  # frames a second; 25 where the file has none
    placed: bool = False  # whether it says where it was recorded


def probe(uri):
    """Throws ProbeError."""
    try:
        info = GstPbutils.Discoverer.new(60 * Gst.SECOND).discover_uri(uri)
    except GLib.Error as error:
        raise ProbeError(error.message) from error
    result = info.get_result()
    if result == GstPbutils.DiscovererResult.MISSING_PLUGINS:
        missing = [details.split("|")[-2] for details in info.get_missing_elements_installer_details()]
        raise ProbeError(f"a plugin is missing: {', '.join(missing)}")
    if result != GstPbutils.DiscovererResult.OK:
        raise ProbeError(f"it cannot be read ({result.value_nick})")
    videos = info.get_video_streams()
    if not videos:
        raise ProbeError("it has no video")
    video = next((v for v in videos if not v.is_image()), videos[0])
    seconds = info.get_duration() / Gst.SECOND if 0 < info.get_duration() < Gst.CLOCK_TIME_NONE else 0
    general = info.get_tags()
    tags, turned = video.get_tags() or general, False
    if tags:
        found, orientation = tags.get_string("image-orientation")
        turned = found and orientation != "rotate-0"
    caps = video.get_caps()
    if caps and caps.get_structure(0).get_name() == "image/gst-libav-gif":
        raise ProbeError("it is a GIF, whose frames GStreamer reads without their times; make a video of it, as by ffmpeg -i IN.gif OUT.mkv")
    placed = bool(general) and general.get_double("geo-location-latitude")[0]
    still = bool(caps) and caps.get_structure(0).get_name().startswith("image/")
    rate = video.get_framerate_num() / max(video.get_framerate_denom(), 1)
    return Probe(seconds, turned, still, rate or Probe.rate, placed)
