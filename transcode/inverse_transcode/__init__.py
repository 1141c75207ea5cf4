# SPDX-License-Identifier: LGPL-2.1-or-later
"""inverse-transcode: files in, files out, through elements of gst-inverse."""
