# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line."""
import argparse
import dataclasses
import os

from . import elements, layers, project, source

EPILOG = """SOURCE is a file, the folder of a recording with depth, a URI, /dev/videoN, "libcamera" or
"libcamera:NAME", "test" for a test picture, "room" for a virtual room with a depth camera, or a piece of a launch
line that outputs video ("videotestsrc pattern=ball ! video/x-raw,width=320"). Without one the window asks.
Exit status: 0; 1 if something went wrong, as an input that is cut off or a full disk; 2 for wrong arguments."""


def parser():
    """The ArgumentParser."""
    made = argparse.ArgumentParser(prog="inverse-play", epilog=EPILOG,
                                   description="Shows and edits the layers of a video while it plays.",
                                   formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("source", metavar="SOURCE", nargs="?", help="what to play")
    made.add_argument("--project", metavar="FILE", help="load a project that was saved; asks before it runs elements, "
                      "opens connections or writes files")
    made.add_argument("--allow", action="store_true", help="let the project do so without a question")
    made.add_argument("--decomposer", metavar="ELEMENT", help="decompose by it (intrinsicdecomp)")
    made.add_argument("--edit", metavar="EDITOR", action="append", default=[],
                      help='add an editor, as in "intrinsicrecolor key=0xffc03020"; several are a chain')
    made.add_argument("--show", metavar="LAYER", help="show a layer: a value of show of intrinsiccompose")
    made.add_argument("--split", metavar="SHARE", type=float,
                      help="show the original at the left, up to this share of the width: 0 to 1")
    made.add_argument("--record", metavar="FILE", help="record from the first frame on: .mkv, .webm or .mp4")
    made.add_argument("--overwrite", action="store_true", help="let --record replace a file")
    made.add_argument("--close-at-end", action="store_true", help="close the window after the last frame")
    made.add_argument("--folder", metavar="FOLDER", help="where recordings and snapshots go, instead of your own")
    made.add_argument("--launch-line", action="store_true", help="print the line for gst-launch-1.0, and end")
    made.add_argument("--version", action="version", version=f"inverse-play {elements.version()}")
    return made


def demands_of(options):
    """What the project file that was named demands, less what other arguments take the place of. Raises as `project_of`."""
    if not options.project or options.allow:
        return []
    loaded = project.load(options.project)
    return project.demands(dataclasses.replace(loaded, source="") if options.source else loaded)


def project_of(options):
    """The Project that the arguments describe. Raises ElementError, SourceError or OSError."""
    made = project.load(options.project) if options.project else project.Project()
    if options.source:
        made = dataclasses.replace(made, source=source.parse(options.source).text)
    if options.decomposer:
        if options.decomposer not in elements.decomposers():
            raise elements.ElementError(f"{options.decomposer} is no decomposer of this installation: "
                                        f"{', '.join(elements.decomposers())}")
        made = dataclasses.replace(made, decomposer=project.Element("decomposer", options.decomposer))
    for text in options.edit:
        made = project.parse_editor(text, made)
    if options.show:
        made = made.with_element(made.compose.with_property("show", options.show))
        missing = layers.missing(options.show, made)
        if missing:
            raise elements.ElementError(" ".join(missing))
    if options.split is not None:
        if not 0 <= options.split <= 1:
            raise elements.ElementError("--split takes a number from 0 to 1")
        made = dataclasses.replace(made, split=options.split)
    if options.folder and not os.path.isdir(options.folder):
        raise elements.ElementError(f"there is no folder {options.folder}")
    return made
