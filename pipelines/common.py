# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the scripts in Python share, as common.sh for the others."""
import argparse
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "common"))


def split(words, chain):
    """Options, and the elements of a launch line after --, or `chain`."""
    if "--" not in words:
        return words, chain
    return words[:words.index("--")], " ".join(words[words.index("--") + 1:]) or chain


def quoted(text):
    """A value for a launch line."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def port(text):
    """The number of a TCP port, 0: any that is free; a type of argparse."""
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"a port is a number from 0 to 65535, not {text}")
    return int(text)


def source_of(program, given, after_camera="", after_file=""):
    """The first elements of a launch line for a camera, a file or a URI, or SOURCE of the environment; ends the program if there is none. After
    Gst.init: from then on lists of streams are played only if the user typed an address."""
    from inverse_common import media, probe  # here: the scripts say what to install if gi is missing

    text = os.environ.get("SOURCE") or given
    media.allow_lists(media.names_address(text))
    media.prefer_decoders()
    if os.environ.get("SOURCE"):
        return os.environ["SOURCE"]
    if given.startswith("/dev/video"):
        if not os.path.exists(given):
            sys.exit(f"{program}: there is no camera {given}")
        return f"v4l2src device={quoted(given)} ! decodebin{after_camera}"
    if "://" not in given:
        if not os.path.isfile(given):
            sys.exit(f"{program}: there is no file {given}")
        given = pathlib.Path(os.path.abspath(given)).as_uri()
    if given.lower().startswith("file://"):
        try:
            probe.probe(given)
        except probe.ListError as error:
            sys.exit(f"{program}: {given}: {error}")
        except probe.ProbeError:
            pass  # playing it says why
    return f"uridecodebin uri={quoted(given)} caps=video/x-raw(ANY) expose-all-streams=false{after_file}"
