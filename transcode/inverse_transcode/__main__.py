# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line."""
import argparse
import collections
import json
import os
import re
import shlex
import sys
import warnings

import gi

gi.require_version("Gst", "1.0")
from gi.repository import GLib, Gst  # noqa: E402

from inverse_common import files  # noqa: E402
from inverse_common.media import prefer_decoders  # noqa: E402
from inverse_common.probe import ProbeError, probe  # noqa: E402

from . import formats, slurm  # noqa: E402
from .batch import Batch, BatchError, make  # noqa: E402
from .lines import tell, warn  # noqa: E402
from .plan import PlanError, Settings, is_exr, is_numbered, is_pattern, numbered, picture, plan  # noqa: E402
from .run import Runner  # noqa: E402

OVERLAP = 16  # frames
REPORT_KEYS = {"version", "settings", "counts", "files"}
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
    parser.add_argument("inputs", nargs="*", metavar="INPUT", help="a video; a folder: all videos below it; frames/%%04d.png: numbered pictures (png, jpg, exr)")
    parser.add_argument("-o", "--output", metavar="FILE", help="the file to write, for one input; its ending names the container")
    parser.add_argument("--out", metavar="FOLDER", help="where results go, as they lie below the folders named (out/transcode)")
    parser.add_argument("--to", metavar="CONTAINER", choices=list(formats.CONTAINERS), help="mkv (default), webm, mp4, mov; png, jpg, exr: a folder of numbered pictures")
    parser.add_argument("--rate", metavar="N[/N]", default="25", help="frames a second of numbered pictures that are read (25)")
    parser.add_argument("--exposure", metavar="STOPS", type=float, default=0,
                        help="brighten EXR pictures by so many stops as they are read; EXR that is written is darkened by as many")
    parser.add_argument("--bits", metavar="N", type=int, default=0, choices=[8, 16],
                        help="8 or 16 bits a sample of png (16 for input of more than 8 bits)")
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
    parser.add_argument("--overwrite", action="store_true", help="also replace files that are no result, or no report, of this program")
    parser.add_argument("--dry-run", action="store_true", help="print what would be done")
    parser.add_argument("--report", metavar="FILE", help="write what was done as JSON; -: to stdout")
    parser.add_argument("--quiet", action="store_true", help="print failures only")
    parser.add_argument("--verbose", action="store_true", help="print what GStreamer says (GST_DEBUG)")
    many = parser.add_argument_group("many files, on one host or on many (docs/guides/cluster.md)")
    many.add_argument("--batch", metavar="FOLDER", help="with inputs: write a folder of numbered tasks there, for make, GNU parallel or Slurm")
    many.add_argument("--chunk", metavar="SECONDS", type=float, default=0, help="divide longer files in chunks of at least so many seconds, at cuts")
    many.add_argument("--divide-shots", action="store_true", help="also where there is no cut; brightness of layers may jump there")
    many.add_argument("--overlap", metavar="FRAMES", type=int, help=f"frames that the elements get before a chunk begins ({OVERLAP})")
    many.add_argument("--slurm", action="store_true", help="submit what is not done by sbatch, as job arrays")
    many.add_argument("--sbatch", metavar="OPTIONS", default="", help="of sbatch, such as \"--partition=video --mem=4G --time=2:00:00\"")
    many.add_argument("--status", action="store_true", help="print what is done, failed and running; --report writes it")
    many.add_argument("--task", metavar="N", type=int, nargs="+", help="run these tasks")
    parser.add_argument("--version", action="version", version=f"inverse-transcode {formats.version()}")
    words = list(words)
    for name in ("--sbatch", "--video-options"):  # whose values may begin with a dash
        if name in words[:-1]:
            place = words.index(name)
            words[place:place + 2] = [f"{name}={words[place + 1]}"]
    arguments, others = parser.parse_known_args(words)
    if others:
        parser.error(f"unrecognized arguments: {' '.join(others)} (elements go after --)")
    check_verbs(parser, arguments)
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


def check_verbs(parser, arguments):
    """Whether the options for batches and the inputs fit together; ends with a message if not."""
    verbs = [name for name in ("slurm", "status", "task") if getattr(arguments, name) not in (None, False)]
    for name in ("divide_shots", "overlap"):
        if getattr(arguments, name) not in (None, False) and not arguments.chunk:
            parser.error(f"--{name.replace('_', '-')} needs --chunk SECONDS")
    if arguments.overlap is None:
        arguments.overlap = OVERLAP
    if not arguments.batch:
        if verbs or arguments.chunk:
            parser.error(f"--{(verbs or ['chunk'])[0]} needs --batch FOLDER")
        if not arguments.inputs:
            parser.error("name an input")
        return
    if arguments.inputs and {"status", "task"} & set(verbs):
        parser.error(f"--{verbs[-1]} takes no inputs: those of the batch are known")
    if len(verbs) > 1:
        parser.error(f"--{verbs[0]} and --{verbs[1]} exclude each other")
    if not verbs and not arguments.inputs:
        parser.error("name an input, --slurm, --status or --task")
    if arguments.chunk < 0 or arguments.overlap < 0:
        parser.error("--chunk and --overlap take no negative numbers")


def check_sequence(settings, inputs):
    """Whether the options fit numbered pictures, read or written. Throws FormatError, PlanError."""
    exr, sequence = any(map(is_exr, inputs)), settings.container in formats.SEQUENCES
    for given, fits, what in (
        (settings.video, not sequence, "--video is for files of video"),
        (settings.hardware, not sequence, "--hardware is for files of video"),
        (settings.audio not in ("copy", "none"), not sequence, "--audio is for files with sound"),
        (settings.bits, settings.container == "png", "--bits is for png"),
    ):
        if given and not fits:
            raise PlanError(f"{what}, not for {settings.container}")
    if settings.exposure and not exr:
        raise PlanError("--exposure is for inputs of numbered EXR pictures, such as 'shot/%04d.exr'")
    if not -20 <= settings.exposure <= 20:
        raise PlanError("--exposure takes -20 to 20 stops")
    if exr:
        formats.own_pictures(exr=True)


def check(settings, inputs):
    """Throws FormatError, PlanError if nothing could be done with any file."""
    check_sequence(settings, inputs)
    for layer in settings.layers:
        if not formats.is_layer(layer):
            raise PlanError(f"there is no layer {layer!r}; choose of {', '.join(formats.layers())}")
    if len(set(settings.layers)) < len(settings.layers):
        raise PlanError("a layer is named twice")
    container = formats.container(settings.container)
    codec = "png16" if settings.bits == 16 else settings.video or container.video
    encoder = formats.video_encoder(codec, settings.hardware, settings.video_options)
    formats.check_fit(settings.container, "video", settings.video, encoder)
    if settings.audio not in ("copy", "none"):
        formats.check_fit(settings.container, "audio", settings.audio, formats.audio_encoder(settings.audio))
    check_line(f"identity ! {settings.chain} ! identity", "the elements after -- must take pictures and pass pictures on")
    check_line(encoder, f"--video-options takes properties of the encoder (gst-inspect-1.0 {encoder.split()[0]})")


def check_line(line, remedy):
    """Throws PlanError, with a remedy, if a part of a launch line does not parse, or a value is out of range, of which GLib only warns."""
    with warnings.catch_warnings(record=True) as ignored:
        warnings.simplefilter("always")
        try:
            Gst.parse_bin_from_description(line, False)
        except GLib.Error as error:
            raise PlanError(f"{error.message}: {remedy}") from error
    if ignored:
        raise PlanError(f"{ignored[0].message}: {remedy}")


def unreadable(path):
    """Why the beginning of an input cannot be decoded, or ""."""
    first = picture(path, numbered(path)[0]) if is_pattern(path) else path
    try:
        if not is_exr(path):
            probe(Gst.filename_to_uri(first))
    except ProbeError as error:
        return str(error)
    return ""


def count(results):
    """How many there are of each status."""
    return collections.Counter(result["status"] for result in results)


def _is_report(path):
    """Whether a file is a report of this program."""
    try:
        with open(path, encoding="ascii") as read:
            start = read.read(64)
            return start.startswith('{') and not REPORT_KEYS - set(json.loads(start + read.read()))
    except (ValueError, RecursionError):
        return False


def check_report(path, tasks, overwrite):
    """Whether a report may be written there. `tasks`: (input, output). Throws PlanError, OSError."""
    if path == "-":
        return
    place = os.path.realpath(path)
    folder = os.path.dirname(place)
    if os.path.isdir(place) or not os.path.exists(path) and not os.access(folder, os.W_OK):
        why = "it is a folder" if os.path.isdir(place) else f"{folder} {'is read-only' if os.path.isdir(folder) else 'is no folder'}"
        raise PlanError(f"the report cannot be written: {why}")
    for given, output in tasks:
        result = os.path.realpath(output)
        if place == result or folder == result or folder.startswith(result + os.sep):
            raise PlanError(f"the report would be in the place of a result: {path}; name another file")
        pictures = is_pattern(given) and folder == os.path.realpath(os.path.dirname(given) or ".") and is_numbered(given, os.path.basename(place))
        if pictures or place == os.path.realpath(given):
            raise PlanError(f"the report would replace an input: {path}; name another file")
    if os.path.isfile(place) and not overwrite and not _is_report(place):
        raise PlanError(f"there is a file that is no report at the place of the report: {path}; name another one, or --overwrite replaces it")


def write_report(path, settings, results):
    """Writes to a file, or to stdout for "-"."""
    text = json.dumps({"version": formats.version(), "settings": vars(settings), "counts": count(results), "files": results}, indent=1)
    if path == "-":
        print(text)
    else:
        files.write(path, text)


def print_status(results, quiet):
    """What became of a batch."""
    for result in results:
        if "error" in result:
            tell(f"{result['status']:8} {result.get('task', '-'):>6} {result['input']}: {result['error']}")
        elif result["status"] == "running":
            tell(f"running  {result['task']:>6} {result['input']}: on {result['begun']['host']}")
        if not quiet:
            for warning in result.get("warnings", []):
                tell(f"warning  {result.get('task', '-'):>6} {result['input']}: {warning}")
    counts = count(results)
    print(", ".join(f"{counts[status]} {status}" for status in sorted(counts)))


def make_batch(arguments, settings, tasks):
    """Plans a batch and tells of it."""
    batch = make(arguments.batch, settings, tasks, {"seconds": arguments.chunk, "overlap": arguments.overlap, "shots": arguments.divide_shots},
                 lambda text: arguments.quiet or warn(f"inverse-transcode: {text}"))
    for result in batch.manifest["others"]:
        if "error" in result:
            warn(f"FAILED  {result['input']}: {result['error']}")
    if not arguments.quiet:
        work, joins = batch.pending()
        folder = shlex.quote(batch.folder)
        print(f"{len(work)} task{'s' * (len(work) != 1)} to do" + (f", and {len(joins)} to join chunks" if joins else "") + f": {batch.folder}")
        print(f"  make -C {folder} -j 4\n  parallel -q {folder}/run :::: {folder}/tasks" + (f" && parallel -q {folder}/run :::: {folder}/joins" if joins else "") +
              f"\n  inverse-transcode --batch {folder} --slurm\n  inverse-transcode --batch {folder} --status")
    return batch


def batch_main(arguments, batch):
    """Does what is asked of a batch; returns the exit status."""
    if arguments.task:
        return batch.work(arguments.task, arguments.quiet, arguments.verbose)
    if arguments.slurm:
        jobs = slurm.submit(batch, shlex.split(arguments.sbatch))
        print(f"Slurm: {' and '.join(f'job {job}' for job in jobs)}" if jobs else "there is nothing to do")
        return 0
    if arguments.report:
        check_report(arguments.report, [(task["input"], task["output"]) for task in batch.tasks + batch.manifest["others"]], arguments.overwrite)
    results = batch.report()
    print_status(results, arguments.quiet)
    if arguments.report:
        write_report(arguments.report, batch.settings, results)
    return 0 if all(result["status"] in ("done", "present") for result in results) else 1


def main():
    for stream in (sys.stdout, sys.stderr):
        if stream:
            stream.reconfigure(errors="surrogateescape")  # names are bytes
    Gst.init(None)
    prefer_decoders()  # also for the caps of chunks
    arguments = parse(sys.argv[1:])
    try:
        if arguments.batch and not arguments.inputs:
            return batch_main(arguments, Batch(arguments.batch))
        return transcode_main(arguments)
    except (formats.FormatError, PlanError, BatchError) as error:
        warn(f"inverse-transcode: {error}")
        return 2
    except OSError as error:
        warn(f"inverse-transcode: {error.filename or 'it cannot be written'}: {error.strerror}")
        return 1


def transcode_main(arguments):
    """Transcodes the inputs, or plans a batch of them; returns the exit status."""
    ending = arguments.to or (os.path.splitext(arguments.output)[1][1:].lower() if arguments.output else "mkv")
    layers = [name.strip() for name in arguments.layers.split(",") if name.strip()]
    settings = Settings(arguments.chain, ending, arguments.rate, arguments.video, arguments.audio, arguments.hardware, arguments.video_options, layers,
                        arguments.bits, arguments.exposure)
    if arguments.output and arguments.to and arguments.to not in formats.SEQUENCES and not arguments.output.endswith("." + arguments.to):
        raise PlanError(f"{arguments.output} does not end in .{arguments.to}")
    if arguments.output and ending in formats.SEQUENCES and arguments.output.lower().endswith(f".{ending}"):
        raise PlanError(f"{ending} is written to a folder of numbered pictures: name one, such as {os.path.splitext(arguments.output)[0]}")
    check(settings, arguments.inputs)
    if arguments.chunk:
        formats.need(["gdppay", "gdpdepay", "scenechange"], "chunks")
    tasks = plan(arguments.inputs, arguments.output, arguments.out or "out/transcode", ending, arguments.again, arguments.overwrite)
    if arguments.report:
        check_report(arguments.report, [(task.input, task.output) for task in tasks], arguments.overwrite)
    if arguments.dry_run:
        for task in tasks:
            task.problem = task.problem or unreadable(task.input)
            tell(f"{task.input} -> {task.output}" + (f": {task.problem}" if task.problem else ": is there" if task.done else ""))
        return 1 if any(task.problem for task in tasks) else 0
    if arguments.batch:
        batch = make_batch(arguments, settings, tasks)
        return batch_main(arguments, batch) if arguments.slurm else 0
    runner = Runner(settings, arguments.jobs, arguments.quiet, arguments.verbose)
    results = runner.run(tasks)
    if arguments.report:
        write_report(arguments.report, settings, results)
    counts = count(results)
    if len(tasks) > 1 and (counts["failed"] or not arguments.quiet):
        rest = "".join(f", {counts[status]} {status}" for status in ("stopped", "not started") if counts[status])
        print(f"{counts['done']} done, {counts['present']} already there, {counts['failed']} failed{rest}", file=sys.stderr)
    if runner.stopping:
        return 130
    return 1 if counts["failed"] or counts["stopped"] else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
