# SPDX-License-Identifier: LGPL-2.1-or-later
"""inverse-transcode: files in, files out, through elements of gst-inverse."""
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "common"))  # inverse_common
