#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""An effect written in Python, on one layer. Exits with 77, which meson takes for skipped, where
GStreamer has no Python here."""
import sys

try:
    import gi
    gi.require_version('Gst', '1.0')
    gi.require_version('GstBase', '1.0')
    gi.require_version('GstApp', '1.0')
    from gi.repository import GObject, Gst, GstApp, GstBase  # noqa: F401 (GstApp: its methods)
except (ImportError, ValueError) as error:
    print('skipped:', error)
    sys.exit(77)

Gst.init(None)
CAPS = Gst.Caps.from_string('video/x-raw,format={RGBA,RGB,GRAY8}')
INVERTED = bytes(255 - code for code in range(256))


class Effect(GstBase.BaseTransform):
    """Inverts pictures, or passes them on as new buffers that have lost all metas."""
    __gstmetadata__ = ('Python effect', 'Filter/Effect/Video', 'Inverts pictures', 'gst-inverse')
    __gsttemplates__ = (
        Gst.PadTemplate.new('sink', Gst.PadDirection.SINK, Gst.PadPresence.ALWAYS, CAPS),
        Gst.PadTemplate.new('src', Gst.PadDirection.SRC, Gst.PadPresence.ALWAYS, CAPS))
    invert = GObject.Property(type=bool, default=True)

    def do_transform_ip(self, buffer):
        pixels = buffer.extract_dup(0, buffer.get_size())
        buffer.fill(0, pixels.translate(INVERTED) if self.invert else pixels)
        return Gst.FlowReturn.OK


GObject.type_register(Effect)
Gst.Element.register(None, 'pythoneffect', 0, Effect)


def frames_of(effect):
    pipeline = Gst.parse_launch(
        'videotestsrc num-buffers=4 ! video/x-raw,format=RGBA,width=64,height=48,framerate=25/1 ! '
        f'{effect} ! video/x-raw,format=RGBA ! appsink name=out sync=false')
    pipeline.set_state(Gst.State.PLAYING)
    out = pipeline.get_by_name('out')
    frames = []
    while sample := out.try_pull_sample(60 * Gst.SECOND):
        buffer = sample.get_buffer()
        frames.append(buffer.extract_dup(0, buffer.get_size()))
    message = pipeline.get_bus().pop_filtered(Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    if message:
        sys.exit(f'{effect}: {message.parse_error()[0].message}')
    return frames


plain = frames_of('intrinsicdecomp ! intrinsiccompose')
same = frames_of('intrinsicedit layer=shading effect="pythoneffect invert=false"')
inverted = frames_of('intrinsicedit layer=shading effect=pythoneffect')
assert len(plain) == len(same) == len(inverted) == 4, [len(plain), len(same), len(inverted)]
assert same == plain, 'an effect that does nothing changed the frame'
assert all(a != b for a, b in zip(plain, inverted)), 'the effect did nothing'
print('4 frames, as they should be')
