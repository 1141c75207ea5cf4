# SPDX-License-Identifier: LGPL-2.1-or-later
"""inverse-play: a window in which the layers of a video are seen and edited while it plays."""
import pathlib
import sys

import gi

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "common"))  # inverse_common
for name, version in (("Gst", "1.0"), ("GstVideo", "1.0"), ("GstPbutils", "1.0"), ("Gio", "2.0")):
    gi.require_version(name, version)
