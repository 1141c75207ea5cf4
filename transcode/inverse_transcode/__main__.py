# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line."""
import argparse
import json
import os
import re
import sys

import gi

gi.require_version("Gst", "1.0")
from gi.repository import GLib, Gst  # noqa: E402

from . import VERSION, formats  # noqa: E402
from .plan import SEQUENCES, PlanError, Settings, plan  # noqa: E402
from .run import Runner  # noqa: E402

DEFAULT_CHAIN = "intrinsicdecomp show=reflectance"
EPILOG = """
ELEMENTS are those of a launch line between the decoder and the encoder. Sound and subtitles are copied where the container takes
them. A result gets its name once it is complete; results that are newer than their input are left as they are, so that the same command
goes on where it was stopped. Ctrl-C closes what was done of a file as NAME.partial.ENDING.

examples:
  inverse-transcode clip.mp4 -o paint.mkv
  inverse-transcode clip.mp4 -o blue.mkv -- intrinsicdecomp ! intrinsicrecolor key=0xffc03020 target=0xff2040c0 ! intrinsiccompose
  inverse-transcode clip.mp4 -o layers.mkv --layers input,reflectance,shading -- intrinsicdecomp
  inverse-transcode --jobs 2 --out results --report report.json footage/
"""


def parse(words):
    words, chain = (words[:words.index("--")], words[words.index("--") + 1:]) if "--" in words else (words, [])
    parser = argparse.ArgumentParser(
        prog="inverse-transcode", usage="inverse-transcode [OPTIONS] INPUT... [-- ELEMENTS]",
        description="Sends videos through elements of gst-inverse and writes them to files.",
        epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("inputs", nargs="+", metavar="INPUT", help="a video; a folder: all videos below it; frames/%%04d.png: numbered pictures (png, jpg)")
    parser.add_argument("-o", "--output", metavar="FILE", help="the file to write, for one input; its ending names the container")
    parser.add_argument("--out", metavar="FOLDER", help="where results go, as they lie below the folders named (out/transcode)")
    parser.add_argument("--to", metavar="CONTAINER", choices=list(formats.CONTAINERS), help="mkv (default), webm, mp4, mov; png, jpg: a folder of numbered pictures")
    parser.add_argument("--rate", metavar="N[/N]", default="25", help="frames a second of numbered pictures that are read (25)")
    parser.add_argument("--video", metavar="CODEC", default="", choices=formats.VIDEO_CODECS,
                        help=f"{', '.join(formats.VIDEO_CODECS)}; default: vp8, for more than 8 bits vp9; in mp4 h264 and h265")
    parser.add_argument("--video-options", metavar="PROPERTIES", default="", help="of the encoder's element, such as \"cq-level=8\"")
    parser.add_argument("--hardware", action="store_true", help="encode by NVENC or VA-API, where there is one for the codec")
    parser.add_argument("--audio", metavar="CODEC", default="copy", choices=["copy", "none", *formats.AUDIO_CODECS],
                        help=f"copy (default), none, {', '.join(formats.AUDIO_CODECS)}")
    parser.add_argument("--layers", metavar="NAME,...", default="",
                        help="layers of intrinsicsplit that the end of the elements has, each a video stream of the file")
    parser.add_argument("--jobs", metavar="N", type=int, default=1, help="files at a time (1)")
    parser.add_argument("--again", action="store_true", help="also where there is a result that is newer than the input")
    parser.add_argument("--dry-run", action="store_true", help="print what would be done")
    parser.add_argument("--report", metavar="FILE", help="write what was done as JSON")
    parser.add_argument("--quiet", action="store_true", help="print failures only")
    parser.add_argument("--verbose", action="store_true", help="print what GStreamer says (GST_DEBUG)")
    parser.add_argument("--version", action="version", version=f"inverse-transcode {VERSION}")
    arguments = parser.parse_args(words)
    if arguments.output and arguments.out:
        parser.error("-o and --out exclude each other")
    if arguments.jobs < 1:
        parser.error("--jobs takes a number above 0")
    above, _, below = arguments.rate.partition("/")
    if not re.fullmatch("0*[1-9][0-9]*(/0*[1-9][0-9]*)?", arguments.rate, re.ASCII):
        parser.error(f"--rate takes frames a second, such as 24 or 30000/1001, not {arguments.rate}")
    arguments.rate = f"{above}/{below or 1}"
    arguments.chain = " ".join(chain) or DEFAULT_CHAIN
    return arguments


def check(settings):
    """Throws FormatError, PlanError if nothing could be done with any file."""
    for layer in settings.layers:
        if not formats.is_layer(layer):
            raise PlanError(f"there is no layer {layer!r}; choose of {', '.join(formats.layers())}")
    container = formats.container(settings.container)
    encoder = formats.video_encoder(settings.video or container.video, settings.hardware, settings.video_options)
    if settings.audio not in ("copy", "none"):
        formats.audio_encoder(settings.audio)
    try:
        Gst.parse_bin_from_description(f"identity ! {settings.chain} ! identity", False)
        Gst.parse_bin_from_description(encoder, False)
    except GLib.Error as error:
        raise PlanError(error.message) from error


def write_report(path, settings, results):
    counts = {}
    for result in results:
        counts[result["status"]] = counts.get(result["status"], 0) + 1
    report = {"version": VERSION, "settings": vars(settings), "counts": counts, "files": results}
    part = path + ".part"
    with open(part, "w", encoding="utf-8") as written:
        json.dump(report, written, indent=1)
    os.replace(part, path)


def main():
    for stream in (sys.stdout, sys.stderr):
        if stream:
            stream.reconfigure(errors="surrogateescape")  # names are bytes
    Gst.init(None)
    arguments = parse(sys.argv[1:])
    ending = arguments.to or (os.path.splitext(arguments.output)[1][1:].lower() if arguments.output else "mkv")
    layers = [name.strip() for name in arguments.layers.split(",") if name.strip()]
    settings = Settings(arguments.chain, ending, arguments.rate, arguments.video, arguments.audio, arguments.hardware, arguments.video_options, layers)
    try:
        if arguments.output and arguments.to and arguments.to not in SEQUENCES and not arguments.output.endswith("." + arguments.to):
            raise PlanError(f"{arguments.output} does not end in .{arguments.to}")
        if arguments.report and not os.access(os.path.dirname(os.path.abspath(arguments.report)), os.W_OK):
            raise PlanError(f"there is no folder for the report: {arguments.report}")
        check(settings)
        tasks = plan(arguments.inputs, arguments.output, arguments.out or "out/transcode", ending, arguments.again)
    except (formats.FormatError, PlanError) as error:
        print(f"inverse-transcode: {error}", file=sys.stderr)
        return 2
    if arguments.dry_run:
        for task in tasks:
            print(f"{task.input} -> {task.output}" + (f": {task.problem}" if task.problem else ": is there" if task.done else ""))
        return 1 if any(task.problem for task in tasks) else 0
    runner = Runner(settings, arguments.jobs, arguments.quiet, arguments.verbose)
    results = runner.run(tasks)
    if arguments.report:
        try:
            write_report(arguments.report, settings, results)
        except OSError as error:
            print(f"inverse-transcode: the report cannot be written: {arguments.report}: {error.strerror}", file=sys.stderr)
            return 1
    count = {status: sum(r["status"] == status for r in results) for status in ("done", "present", "failed", "stopped", "not started")}
    if len(tasks) > 1 and not arguments.quiet or count["failed"]:
        print(f"{count['done']} done, {count['present']} already there, {count['failed']} failed", file=sys.stderr)
    if runner.stopping:
        return 130
    return 1 if count["failed"] or count["stopped"] else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
