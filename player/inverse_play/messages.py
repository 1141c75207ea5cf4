# SPDX-License-Identifier: LGPL-2.1-or-later
"""Errors and warnings of a pipeline in words, with what to do."""
import dataclasses
import re

from gi.repository import Gst
from inverse_common import media


@dataclasses.dataclass(frozen=True)
class Trouble:
    """What is shown to the user. `fatal`: the video cannot go on. `of_edits`: because of how it is edited."""
    text: str
    advice: str = ""
    fatal: bool = True
    of_edits: bool = False


RESOURCE, STREAM, CORE = "gst-resource-error-quark", "gst-stream-error-quark", "gst-core-error-quark"
NO_DECODER = "Install its decoder: sudo apt install gstreamer1.0-libav gstreamer1.0-plugins-bad."
ADVICE = {
    (RESOURCE, Gst.ResourceError.NOT_FOUND): "Check that it exists, then try again.",
    (RESOURCE, Gst.ResourceError.OPEN_READ): "Check its permissions, then try again.",
    (RESOURCE, Gst.ResourceError.BUSY): "Another program uses it: close that one, then try again.",
    (RESOURCE, Gst.ResourceError.READ): "If it is a camera, plug it in again; then try again.",
    (STREAM, Gst.StreamError.TYPE_NOT_FOUND): "It is no video, or its beginning is damaged. Choose another file.",
    (STREAM, Gst.StreamError.WRONG_TYPE): "It is no video. Choose another file.",
    (STREAM, Gst.StreamError.CODEC_NOT_FOUND): NO_DECODER,
    (STREAM, Gst.StreamError.DECODE): "The file is damaged here. What comes before can be played.",
    (STREAM, Gst.StreamError.DEMUX): "The file is damaged or cut off. What comes before can be played.",
    (CORE, Gst.CoreError.MISSING_PLUGIN): NO_DECODER,
}


def _is_ours(message):
    """Whether the text is by an element of gst-inverse: those say themselves what to do."""
    factory = message.src.get_factory() if isinstance(message.src, Gst.Element) else None
    plugin = factory.get_plugin_name() if factory else ""
    return (plugin or "").startswith("inverse")


def _source_of(message):
    factory = message.src.get_factory() if isinstance(message.src, Gst.Element) else None
    return factory.get_name() if factory else message.src.get_name()


def describe(message):
    """The Trouble in an error or warning message."""
    fatal = message.type == Gst.MessageType.ERROR
    error, debug = message.parse_error() if fatal else message.parse_warning()
    if _is_ours(message):
        return Trouble(f"{_source_of(message)}: {error.message}", "", fatal, of_edits=True)
    if "elayed linking failed" in error.message + (debug or ""):
        return Trouble("There is no video in it.", "Choose a file that has one.")  # a warning, then nothing comes
    advice = ADVICE.get((error.domain, error.code), "")
    if advice is NO_DECODER and media.names_list(debug or ""):
        return Trouble("It is a list of streams, which may be on other hosts.", "Open one of them by its address, if you trust it.", fatal)
    if not advice and fatal:
        advice = "Try again; GST_DEBUG=3 in the environment prints more."
    stopped = re.search("streaming stopped, reason ([a-z-]+)", debug or "")  # a flow: not-linked, not-negotiated, error
    reason = f" ({stopped[1]})" if stopped else ""
    return Trouble(f"{_source_of(message)}: {error.message}{reason}", advice, fatal)
