# SPDX-License-Identifier: LGPL-2.1-or-later
"""Frames of videos in memory, for the benchmarks of inverse-transcode."""
import numpy

from case import Gst, structure_of


def frames(path, layer):
    """Times and pictures (h, w, 3; 0…255) of one of a file's streams."""
    pipeline = Gst.parse_launch(f"filesrc name=in ! matroskademux name=d  d.video_{layer} ! decodebin ! videoconvert ! "
                                "video/x-raw,format=BGRx ! appsink name=out sync=false max-buffers=4")
    pipeline.get_by_name("in").set_property("location", path)
    pipeline.set_state(Gst.State.PLAYING)
    try:
        while sample := pipeline.get_by_name("out").emit("pull-sample"):
            size, buffer = structure_of(sample.get_caps()), sample.get_buffer()
            data = numpy.frombuffer(buffer.extract_dup(0, buffer.get_size()), numpy.uint8)
            yield buffer.pts, data.reshape(size.get_value("height"), size.get_value("width"), 4)[:, :, :3]
    finally:
        pipeline.set_state(Gst.State.NULL)


def read_raw(path, form):
    """Frames of a video as bytes, I420, and their caps."""
    reader = Gst.parse_launch(f"filesrc name=in ! decodebin ! videoconvert ! videoscale ! videorate ! {form} ! appsink name=out sync=false")
    reader.get_by_name("in").set_property("location", path)
    reader.set_state(Gst.State.PLAYING)
    try:
        while sample := reader.get_by_name("out").emit("pull-sample"):
            yield sample.get_buffer().extract_dup(0, sample.get_buffer().get_size()), sample.get_caps()
    finally:
        reader.set_state(Gst.State.NULL)


def write_raw(path, found):
    """Writes such frames without loss, at 30 a second."""
    writer = Gst.parse_launch("appsrc name=in format=time ! avenc_ffv1 ! matroskamux ! filesink name=out")
    writer.get_by_name("out").set_property("location", path)
    writer.get_by_name("in").set_property("caps", found[0][1])
    writer.set_state(Gst.State.PLAYING)
    for k, (data, _) in enumerate(found):
        buffer = Gst.Buffer.new_wrapped(data)
        buffer.pts, buffer.duration = k * Gst.SECOND // 30, Gst.SECOND // 30
        writer.get_by_name("in").emit("push-buffer", buffer)
    writer.get_by_name("in").emit("end-of-stream")
    writer.get_bus().timed_pop_filtered(Gst.CLOCK_TIME_NONE, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    writer.set_state(Gst.State.NULL)
