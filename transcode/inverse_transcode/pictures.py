# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures that GStreamer 1.22 does not read or write with all that they hold: OpenEXR, through the C interface of its library
(ImfCRgbaFile.h: red, green, blue and alpha as half floats), and PNG of 16 bits. Frames of EXR are RGB of 16 bits on the PQ curve: 1 is
white, up to PEAK, in steps finer than those of a half float."""
import ctypes
import fractions
import functools
import os
import struct
import zlib

import gi
import numpy

gi.require_version("Gst", "1.0")
gi.require_version("GstVideo", "1.0")
from gi.repository import Gst, GstVideo  # noqa: E402

from inverse_common.gst import without  # noqa: E402

from .formats import FormatError  # noqa: E402

PEAK = 10000 / 203  # of PQ, in units of white: docs/reference/color.md
FRAMES = "video/x-raw,format=RGBA64_LE,colorimetry=1:1:14:1"  # full range, RGB, PQ, primaries of BT.709, which are OpenEXR's too
MAX_SIDE = 32767  # of the elements
_LIBRARIES = ("libOpenEXR-3_1.so.30", "libOpenEXR-3_2.so.31", "libOpenEXR-3_3.so.32", "libOpenEXR-3_4.so.33")
_R, _RGB, _A, _Y, _ZIP = 1, 7, 8, 16, 3  # of ImfCRgbaFile.h
_ONE = 0x3C00  # as a half float
_CURVE = GstVideo.VideoTransferFunction
_WIDE = tuple(getattr(GstVideo.VideoColorPrimaries, name) for name in ("BT2020", "ADOBERGB", "SMPTEST428", "SMPTERP431", "SMPTEEG432"))
_REC709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)


def _cause(error):
    return str(error) if isinstance(error, FormatError) else f"{type(error).__name__}: {error}"


@functools.cache
def openexr():
    """The library. Throws FormatError."""
    for name in _LIBRARIES:
        try:
            library = ctypes.CDLL(name)
            break
        except OSError:
            pass
    else:
        raise FormatError("there is no OpenEXR: install gstreamer1.0-inverse-extra, which brings its library (libopenexr-3-1-30)")
    pointer, number, text = ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p
    for name, result, *arguments in (
        ("OpenInputFile", pointer, text), ("CloseInputFile", number, pointer), ("InputHeader", pointer, pointer), ("InputChannels", number, pointer),
        ("InputSetFrameBuffer", number, pointer, pointer, ctypes.c_size_t, ctypes.c_size_t), ("InputReadPixels", number, pointer, number, number),
        ("HeaderDisplayWindow", None, pointer, *[pointer] * 4), ("HeaderDataWindow", None, pointer, *[pointer] * 4),
        ("NewHeader", pointer), ("DeleteHeader", None, pointer), ("HeaderSetCompression", None, pointer, number), ("HeaderSetPixelAspectRatio", None, pointer, ctypes.c_float),
        ("HeaderSetDisplayWindow", None, pointer, *[number] * 4), ("HeaderSetDataWindow", None, pointer, *[number] * 4),
        ("OpenOutputFile", pointer, text, pointer, number), ("CloseOutputFile", number, pointer),
        ("OutputSetFrameBuffer", number, pointer, pointer, ctypes.c_size_t, ctypes.c_size_t), ("OutputWritePixels", number, pointer, number),
        ("ErrorMessage", text),
    ):
        function = getattr(library, f"Imf{name}")
        function.restype, function.argtypes = result, arguments
    return library


def _attributes(path):
    """The header of an EXR file that the library takes, of several the first: values as bytes, by name."""
    found = {}
    with open(path, "rb") as file:
        rest = file.read(1 << 20)[8:]
    while rest and rest[0]:
        name, _, rest = rest.partition(b"\0")
        _, _, rest = rest.partition(b"\0")
        size = struct.unpack_from("<i", rest)[0]
        found[name], rest = rest[4:4 + size], rest[4 + size:]
    return found


def _channel_names(listed):
    while listed and listed[0]:
        name, _, listed = listed.partition(b"\0")
        yield name.decode(errors="replace")
        listed = listed[16:]


def pixel_aspect(path):
    """Of the pixels of an EXR file: width / height."""
    stored = _attributes(path).get(b"pixelAspectRatio", b"")
    value = struct.unpack("<f", stored)[0] if len(stored) == 4 else 1
    return fractions.Fraction(value).limit_denominator(1000) if 0.001 <= value <= 1000 else fractions.Fraction(1)


def has_other_primaries(path):
    """Whether an EXR file has the chromaticities of other primaries than BT.709's."""
    stored = _attributes(path).get(b"chromaticities", b"")
    return len(stored) == 32 and not numpy.allclose(struct.unpack("<8f", stored), _REC709, atol=0.002)


def _window(get, header):
    box = (ctypes.c_int * 4)()
    get(header, *(ctypes.byref(box, 4 * k) for k in range(4)))
    left, top, right, bottom = box
    return left, top, right + 1, bottom + 1


def read_exr(path):
    """The display window of an EXR file, as an array of rows of pixels of red, green, blue and alpha, which are the bits of half floats.
    What its data window does not cover is black, and transparent if the file has alpha. Throws FormatError."""
    library = openexr()
    file = library.ImfOpenInputFile(os.fsencode(path))
    if not file:
        raise _unreadable(path)
    try:
        header, channels = library.ImfInputHeader(file), library.ImfInputChannels(file)
        shown, stored = _window(library.ImfHeaderDisplayWindow, header), _window(library.ImfHeaderDataWindow, header)
        for left, top, right, bottom in (shown, stored):
            if not (0 < right - left <= MAX_SIDE and 0 < bottom - top <= MAX_SIDE):
                raise FormatError(f"{path} is {right - left}x{bottom - top}; pictures have up to {MAX_SIDE} pixels a side")
        if channels & _RGB != _RGB and not channels & _Y:
            names = ", ".join(_channel_names(_attributes(path).get(b"channels", b"")))
            raise FormatError(f"{path} has no channels R, G and B, or Y, but {names}: store what is to be read under these names")
        width, height = stored[2] - stored[0], stored[3] - stored[1]
        pixels = numpy.zeros((height, width, 4), "<u2")
        origin = pixels.ctypes.data - 8 * (stored[0] + stored[1] * width)  # where pixel (0, 0) would be
        if not library.ImfInputSetFrameBuffer(file, origin, 1, width) or not library.ImfInputReadPixels(file, stored[1], stored[3] - 1):
            raise _unreadable(path)
    finally:
        library.ImfCloseInputFile(file)
    if shown == stored:
        return pixels
    whole = numpy.zeros((shown[3] - shown[1], shown[2] - shown[0], 4), "<u2")
    whole[..., 3] = 0 if channels & _A else _ONE
    left, top, right, bottom = (*map(max, shown[:2], stored[:2]), *map(min, shown[2:], stored[2:]))
    if left < right and top < bottom:
        whole[top - shown[1]:bottom - shown[1], left - shown[0]:right - shown[0]] = pixels[top - stored[1]:bottom - stored[1],
                                                                                          left - stored[0]:right - stored[0]]
    return whole


def _words():
    return openexr().ImfErrorMessage().decode(errors="replace").strip().rpartition("\n")[2]


def _unreadable(path):
    return FormatError(f"{path} cannot be read as OpenEXR: {_words()}")


def _halfs():
    """All half floats, by their bits."""
    return numpy.arange(1 << 16, dtype=numpy.uint16).view(numpy.float16).astype(float)


class ExrSource:
    """Frames of EXR files; `element` outputs them. What a frame cannot hold is counted: `lost`."""

    def __init__(self, paths, rate, stops, failed):
        """`paths`: the files, in order; `rate`: frames a second, as a fraction in text; `stops`: each doubles the light; `failed` is called
        with the cause. Throws FormatError."""
        self.paths, self.stops, self.failed, self.next = paths, stops, failed, 0
        self.first = read_exr(paths[0])
        light = _halfs() * 2.0 ** stops
        self.limit = numpy.float16(min(PEAK / 2.0 ** stops, 65504)).view(numpy.uint16)
        inside = numpy.clip(numpy.nan_to_num(light, nan=0, posinf=PEAK), 0, PEAK)
        self.codes = numpy.array([round(65535 * GstVideo.video_transfer_function_encode(_CURVE.SMPTE2084, value / PEAK)) for value in inside], "<u2")
        self.alpha = numpy.round(65535 * numpy.clip(numpy.nan_to_num(_halfs()), 0, 1)).astype("<u2")
        self.bright = self.negative = self.no_number = 0
        self.step = [int(n) for n in rate.split("/")]
        self.element = Gst.ElementFactory.make("appsrc")
        height, width, _ = self.first.shape
        aspect = pixel_aspect(paths[0])
        self.element.set_property("format", Gst.Format.TIME)
        self.element.set_property("caps", Gst.Caps.from_string(f"{FRAMES},width={width},height={height},framerate={rate},pixel-aspect-ratio={aspect.numerator}/{aspect.denominator}"))
        self.element.connect("need-data", self._push)

    def _push(self, *_):
        if self.next == len(self.paths):
            self.element.emit("end-of-stream")
            return
        try:
            pixels = read_exr(self.paths[self.next]) if self.next else self.first
            if pixels.shape != self.first.shape:
                pairs = (self.paths[self.next], pixels), (self.paths[0], self.first)
                raise FormatError("; ".join(f"{path} is {picture.shape[1]}x{picture.shape[0]}" for path, picture in pairs))
            buffer = Gst.Buffer.new_wrapped(self._frame(pixels).tobytes())
        except Exception as error:  # a thread of GStreamer would ignore it
            self.failed(_cause(error))
            return
        above, below = self.step
        buffer.pts = self.next * below * Gst.SECOND // above
        buffer.duration = (self.next + 1) * below * Gst.SECOND // above - buffer.pts
        self.next += 1
        self.element.emit("push-buffer", buffer)

    def _frame(self, pixels):
        color = pixels[..., :3]
        if color.max(initial=0) > self.limit:  # bits of negative and infinite ones are above those of the others
            number = color & 0x7FFF
            self.no_number += int((number > 0x7C00).any(-1).sum())
            self.bright += int(((color > self.limit) & (color <= 0x7C00)).any(-1).sum())
            self.negative += int(((color > 0x8000) & (number <= 0x7C00)).any(-1).sum())
        frame = numpy.empty_like(pixels)
        frame[..., :3], frame[..., 3] = self.codes[color], self.alpha[pixels[..., 3]]
        return frame

    def warnings(self):
        """What the frames did not hold, in words."""
        for count, what in (
            (self.bright, f"brighter than {PEAK / 2 ** self.stops:.3g} (infinity too) and clipped: a lower --exposure keeps more"),
            (self.negative, "negative and became black"), (self.no_number, "no number and became black")):
            if count:
                yield f"{count} pixels of its pictures were {what}"
        if has_other_primaries(self.paths[0]):
            yield "its primaries are not those of BT.709: its numbers are taken as they are, and as those of BT.709"


def _linear(info):
    """The light that each code of 16 bits stands for, 1 = white."""
    curve = info.colorimetry.transfer
    white = {_CURVE.SMPTE2084: 1 / PEAK, _CURVE.ARIB_STD_B67: GstVideo.video_transfer_function_decode(_CURVE.ARIB_STD_B67, 0.75)}.get(curve, 1)
    return numpy.array([GstVideo.video_transfer_function_decode(curve, code / 65535) for code in range(1 << 16)]) / white


class ExrEncoder:
    """Of OpenEXR: half floats of light, 1 = white; with alpha where a frame has any; ZIP."""

    frames, file = "video/x-raw,format=RGBA64_LE", "image/x-exr"

    def __init__(self, info, stops):
        """`info`: of the frames; `stops`: each doubles the light. Throws FormatError."""
        if info.colorimetry.primaries in _WIDE:
            raise FormatError(f"EXR is written with primaries of BT.709, not {info.colorimetry.primaries.value_nick}: end the elements with one of "
                              "gst-inverse, which converts them")
        self.aspect = info.par_n / info.par_d
        self.light = (_linear(info) * 2.0 ** stops).clip(max=65504).astype("<f2").view("<u2")
        self.alpha = (numpy.arange(1 << 16) / 65535).astype("<f2").view("<u2")

    def encode(self, pixels, _buffer=None):
        """The file of a frame. Throws FormatError, OSError."""
        height, width, _ = pixels.shape
        halfs = numpy.empty(pixels.shape, "<u2")
        halfs[..., :3], halfs[..., 3] = self.light[pixels[..., :3]], self.alpha[pixels[..., 3]]
        library, channels = openexr(), _RGB if (pixels[..., 3] == 65535).all() else _RGB | _A
        header, memory = library.ImfNewHeader(), os.memfd_create("picture.exr")  # the library writes to a name
        try:
            for set_window in (library.ImfHeaderSetDisplayWindow, library.ImfHeaderSetDataWindow):
                set_window(header, 0, 0, width - 1, height - 1)
            library.ImfHeaderSetCompression(header, _ZIP)
            library.ImfHeaderSetPixelAspectRatio(header, self.aspect)
            file = library.ImfOpenOutputFile(f"/proc/self/fd/{memory}".encode(), header, channels)
            done = file and library.ImfOutputSetFrameBuffer(file, halfs.ctypes.data, 1, width) and library.ImfOutputWritePixels(file, height)
            if not (file and library.ImfCloseOutputFile(file) and done):
                raise FormatError(f"OpenEXR: {_words()}")
            return os.pread(memory, os.fstat(memory).st_size, 0)
        finally:
            os.close(memory)
            library.ImfDeleteHeader(header)


class Png16Encoder:
    """Of PNG of 16 bits: gray or color, with alpha where a frame has any (https://www.w3.org/TR/png-3/)."""

    frames, file = "video/x-raw,format=(string){RGBA64_LE,GRAY16_LE}", "image/png"

    def __init__(self, _info, _stops):
        pass

    @staticmethod
    def encode(pixels, _buffer=None):
        """The file of a frame."""
        if pixels.shape[2] == 4 and (pixels[..., 3] == 65535).all():
            pixels = pixels[..., :3]
        height, width, samples = pixels.shape
        rows = pixels.astype(">u2").view(numpy.uint8).reshape(height, -1)
        filtered = numpy.full((height, 1 + rows.shape[1]), 2, numpy.uint8)  # 2: each row without the one above it
        filtered[0, 1:] = rows[0]
        numpy.subtract(rows[1:], rows[:-1], out=filtered[1:, 1:])
        head = struct.pack(">IIBBBBB", width, height, 16, {1: 0, 3: 2, 4: 6}[samples], 0, 0, 0)
        chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(filtered, 4)), (b"IEND", b""))
        return b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
                                               for kind, data in chunks)


class PngMender:
    """What a pngdec that `is_late` makes of PNG of 16 bits of color, as it should be. The last sample of a picture went beyond its frame:
    that of the pixel before takes its place."""

    frames = "video/x-raw,format=ARGB64"

    def __init__(self, _info, path):
        with open(path, "rb") as file:
            alpha = file.read(26)[25] == 6  # the type of color
        self.file = f"video/x-raw,format={'RGBA64_LE' if alpha else 'ARGB64'},colorimetry=sRGB"

    @staticmethod
    def encode(pixels, _buffer=None):
        """A frame as it should be."""
        samples = pixels.ravel()
        return samples[1:].tobytes() + samples[-4:-3].tobytes()


class FieldEncoder:
    """The top field of interlaced frames: lines of the other one become means of those around them, as by `deinterlace fields=top`."""

    frames = "video/x-raw,format=AYUV64"

    def __init__(self, info, _):
        self.mixed = info.interlace_mode == GstVideo.VideoInterlaceMode.MIXED

    @staticmethod
    def caps(given):
        """Of what `encode` makes."""
        made = without(given, "field-order")
        made.set_value("interlace-mode", "progressive")
        return made

    def encode(self, pixels, buffer):
        """A frame without the lines of its bottom field."""
        if self.mixed and not buffer.has_flags(GstVideo.VideoBufferFlags.INTERLACED):
            return pixels.tobytes()
        top, whole = pixels[0::2].astype(numpy.uint32), pixels.copy()
        below = numpy.concatenate([top[1:], top[-1:]])[:len(pixels[1::2])]
        whole[1::2] = (top[:len(below)] + below + 1) // 2
        return whole.tobytes()


@functools.cache
def pngdec_is_late():
    """Whether pngdec writes 16 bits of color one sample late, and alpha last, though it names it first, as that of GStreamer 1.22 does."""
    pipeline = Gst.parse_launch("appsrc name=give caps=image/png,framerate=1/1 ! pngdec ! appsink name=take")
    give = pipeline.get_by_name("give")
    give.emit("push-buffer", Gst.Buffer.new_wrapped(Png16Encoder.encode(numpy.array([[[1, 2, 3, 4], [5, 6, 7, 8]]]))))
    give.emit("end-of-stream")
    pipeline.set_state(Gst.State.PLAYING)
    sample = pipeline.get_by_name("take").emit("try-pull-sample", 5 * Gst.SECOND)
    found = numpy.frombuffer(sample.get_buffer().extract_dup(0, 16), "<u2") if sample else []
    pipeline.set_state(Gst.State.NULL)
    return list(found[1:]) == [1, 2, 3, 4, 5, 6, 7]


CODECS = {"exr": ExrEncoder, "png16": Png16Encoder, "png16 in": PngMender, "fields": FieldEncoder}


def pixels_of(info, buffer):
    """A frame's rows of pixels of 16-bit codes: gray, or red, green, blue and alpha."""
    samples = 1 if info.finfo.flags & GstVideo.VideoFormatFlags.GRAY else 4
    plane = GstVideo.buffer_get_video_meta(buffer) or info
    return numpy.ndarray((info.height, info.width, samples), "<u2", buffer.extract_dup(0, buffer.get_size()), plane.offset[0],
                         (plane.stride[0], 2 * samples, 2))


def connect(take, give, codec, setting, failed):
    """Gives by an appsrc what one of CODECS makes of the frames that an appsink takes. `setting`: of the codec; `failed` is called with the
    cause."""
    state = {}

    def encode(_):
        sample = take.emit("pull-sample")
        buffer = sample.get_buffer()
        try:
            if state.get("caps") is None or not state["caps"].is_equal(sample.get_caps()):
                state["caps"], state["info"] = sample.get_caps(), GstVideo.VideoInfo.new_from_caps(sample.get_caps())
                state["encoder"] = CODECS[codec](state["info"], setting)
            packet = Gst.Buffer.new_wrapped(state["encoder"].encode(pixels_of(state["info"], buffer), buffer))
        except Exception as error:  # a thread of GStreamer would ignore it
            failed(_cause(error))
            return Gst.FlowReturn.ERROR
        packet.pts, packet.dts, packet.duration = buffer.pts, buffer.dts, buffer.duration
        info = state["info"]
        if hasattr(state["encoder"], "caps"):
            caps = state["encoder"].caps(state["caps"])
        else:
            caps = Gst.Caps.from_string(f"{state['encoder'].file},width={info.width},height={info.height},framerate={info.fps_n}/{info.fps_d}")
        return give.emit("push-sample", Gst.Sample.new(packet, caps, sample.get_segment(), None))

    take.connect("new-sample", encode)
    take.connect("eos", lambda _: give.emit("end-of-stream"))
