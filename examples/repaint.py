#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Paints one object of a video file in another color.

  repaint.py IN X Y COLOR OUT.mkv     the object at (X, Y) of the first frame; COLOR is 0xAARRGGBB

Needs python3-gi and gir1.2-gstreamer-1.0.
"""
import json
import sys

import gi

gi.require_version("Gst", "1.0")
from gi.repository import GLib, Gst  # noqa: E402 (after the version)

LINE = """
    filesrc name=in ! decodebin ! videoconvert ! intrinsicdecomp ! intrinsicselect name=select !
    intrinsicrecolor name=recolor ! intrinsiccompose ! videoconvert !
    vp8enc deadline=1 cpu-used=8 end-usage=cq cq-level=16 target-bitrate=20000000 ! matroskamux ! filesink name=out
"""


def play(pipeline):
    """Plays to the end. Ctrl-C ends the file properly."""
    bus = pipeline.get_bus()
    wanted = Gst.MessageType.EOS | Gst.MessageType.ERROR | Gst.MessageType.WARNING
    pipeline.set_state(Gst.State.PLAYING)
    try:
        while True:
            try:
                message = bus.timed_pop_filtered(Gst.SECOND // 10, wanted)
            except KeyboardInterrupt:
                pipeline.send_event(Gst.Event.new_eos())
                continue
            if message is None:
                continue
            if message.type == Gst.MessageType.EOS:
                return
            if message.type == Gst.MessageType.ERROR:
                raise RuntimeError(message.parse_error()[0].message)
            print("repaint.py:", message.parse_warning()[0].message, file=sys.stderr)
    finally:
        pipeline.set_state(Gst.State.NULL)


def main(arguments):
    if len(arguments) != 5:
        print(__doc__, file=sys.stderr)
        return 2
    Gst.init(None)
    source, *numbers, target = arguments
    try:
        x, y, color = int(numbers[0]), int(numbers[1]), int(numbers[2], 0)
    except ValueError as error:
        print(f"repaint.py: X, Y and COLOR are numbers: {error}", file=sys.stderr)
        return 2
    try:
        open(source, "rb").close()  # before the other file is made
        pipeline = Gst.parse_launch(LINE)
        pipeline.get_by_name("in").props.location = source
        pipeline.get_by_name("out").props.location = target
        pipeline.get_by_name("select").props.strokes = json.dumps([{"kind": "add", "points": [[x, y]]}])
        pipeline.get_by_name("recolor").props.target = color
        play(pipeline)
    except (OSError, OverflowError, GLib.Error, RuntimeError) as error:
        print("repaint.py:", error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
