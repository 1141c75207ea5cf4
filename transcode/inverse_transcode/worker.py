# SPDX-License-Identifier: LGPL-2.1-or-later
"""Transcodes one file: `python3 -m inverse_transcode.worker`, the task as a line of JSON on its input, what happens as lines of JSON on
its output. It stops as if the file ended there if its input is closed or SIGTERM comes. A result gets its name once it is complete."""
import json
import os
import signal
import sys
import time

import gi

gi.require_version("Gst", "1.0")
from gi.repository import GLib, Gst  # noqa: E402

from inverse_common.files import settle  # noqa: E402
from inverse_common.media import prefer_decoders  # noqa: E402
from inverse_common.probe import ProbeError  # noqa: E402

from .formats import MATROSKA, SEQUENCES, FormatError  # noqa: E402
from .marks import ends_inside, shown_seconds  # noqa: E402
from .matroska import mend_mastering, mend_tags  # noqa: E402
from .part import Part, is_marked, mark, partial_name, remove  # noqa: E402
from .pipeline import Transcode, TranscodeError, tolerance  # noqa: E402
from .plan import is_result_folder  # noqa: E402

CLOSING_SECONDS = 30
TICK_SECONDS = 0.5  # between reports
STILL_SECONDS = 300  # without a frame and without work, until a pipeline is given up
WORDS = os.fdopen(os.dup(1), "w", encoding="ascii")  # what an element prints goes elsewhere
os.dup2(2, 1)


def say(**what):
    WORDS.write(json.dumps(what) + "\n")
    WORDS.flush()


def _remove_partial(path):
    # Nothing of somebody else: a folder is removed only if it has nothing else.
    if os.path.isfile(path) and is_marked(path) or os.path.isdir(path) and is_result_folder(path):
        remove(path)


def work(task):
    """Returns the last words of the worker."""
    output = os.path.realpath(task["output"])
    try:
        part = Part(output, task["container"] in SEQUENCES or task["chunk"])
    except OSError as error:
        return {"status": "failed", "error": f"cannot write to {os.path.dirname(task['output']) or '.'}: {error.strerror}"}
    loop, started = GLib.MainLoop(), time.monotonic()
    try:
        run = Transcode(task, part.path, loop)

        def late():
            run.error = run.error or f"it could not be closed within {CLOSING_SECONDS} s"
            loop.quit()
            return GLib.SOURCE_REMOVE

        def stop(*_):
            if not run.stopping:
                run.finish()
                GLib.timeout_add_seconds(CLOSING_SECONDS, late)
            return GLib.SOURCE_REMOVE

        still = {"frames": 0, "work": 0.0, "ticks": 0}  # not by a clock: the process may be stopped meanwhile

        def tell():
            say(frames=run.frames, time=run.time, seconds=run.probe.seconds)
            frames, work = run.made + run.frames, time.process_time()
            still["ticks"] += 1
            if frames != still["frames"] or work - still["work"] > STILL_SECONDS / 20:  # telling takes a hundredth
                still.update(frames=frames, work=work, ticks=0)
            elif still["ticks"] > STILL_SECONDS / TICK_SECONDS:
                run.error = run.error or f"nothing has moved for {STILL_SECONDS} s, {run.made} frames out of the elements, {run.frames} out of the encoder"
                loop.quit()
            return GLib.SOURCE_CONTINUE

        for number in (signal.SIGTERM, signal.SIGINT):
            GLib.unix_signal_add(GLib.PRIORITY_HIGH, number, stop)
        GLib.io_add_watch(sys.stdin.fileno(), GLib.PRIORITY_DEFAULT, GLib.IOCondition.HUP | GLib.IOCondition.IN, stop)
        GLib.timeout_add(round(1000 * TICK_SECONDS), tell)
        run.start()
        loop.run()
        run.close()
        should, whole = run.should_last(), not run.error and not run.stopping
        if whole and should - run.time > tolerance(should):
            run.warnings.append(f"its pictures end {should - run.time:.1f} s before they should: it may be damaged")
        elif whole and not run.pictures and not task["chunk"] and ends_inside(task["input"]):
            run.warnings.append("it has no end: it may be damaged")
        if whole and (gap := run.gaps.warning()):
            run.warnings.append(gap)
        if whole and run.pictures not in (0, run.made):
            run.warnings.append(f"of {run.pictures} pictures, {run.made} came out of the elements")
        if whole and run.made not in (0, run.frames):
            run.warnings.append(f"of {run.made} frames, {run.frames} came out of the encoder")
        words = {"frames": run.frames, "elapsed": round(time.monotonic() - started, 3), "copied": run.copied, "warnings": run.warnings}
        if run.stopping and (run.frames == 0 or not task["keep_stopped"]):
            return {"status": "stopped", **words}
        if run.error:
            return {"status": "failed", "error": run.error, **words}
        target = partial_name(output) if run.stopping else output
        while run.stopping and os.path.isfile(target) and not is_marked(target):
            target = partial_name(target)
        if task["container"] in ("mp4", "mov") and not task["chunk"]:
            shown, longest = shown_seconds(part.path), max(run.probe.seconds, run.time, *run.reached.values(), 0)
            if shown - longest > tolerance(longest):
                run.warnings.append(f"players will show a length of {shown:.1f} s, not {longest:.1f}, since GStreamer makes subtitles too long: mkv is right")
        if task["container"] in MATROSKA and not task["chunk"]:
            mend_tags(part.path)
            if run.mastering:
                mend_mastering(part.path, run.mastering)
        if run.mux:
            mark(part.path, task["container"] in MATROSKA)
        settle(part.path, target)
        if target == output and not task["chunk"]:
            _remove_partial(partial_name(output))  # of a run before this one
        return {"status": "stopped" if run.stopping else "done", "written": target, **words}
    except (FormatError, ProbeError, TranscodeError) as error:
        return {"status": "failed", "error": str(error)}
    except OSError as error:
        return {"status": "failed", "error": f"{output}: {error.strerror}"}
    except Exception as error:  # so that it is told
        return {"status": "failed", "error": f"{type(error).__name__}: {error}"}
    finally:
        part.close()


def main():
    Gst.init(None)
    prefer_decoders()
    words = work(json.loads(sys.stdin.readline()))
    say(**words)
    return 0 if words["status"] == "done" else 1


if __name__ == "__main__":
    code = main()
    os._exit(code)  # nothing is left to close: threads of drivers may outlive the interpreter
