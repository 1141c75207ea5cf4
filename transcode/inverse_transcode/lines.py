# SPDX-License-Identifier: LGPL-2.1-or-later
"""Lines of text for a terminal or a log."""
import re
import sys


def tell(text, stream=None):
    """Prints one line to stdout or `stream`. Control characters, which names of files may hold, are printed as \\n, \\x1b
    and so on."""
    print(re.sub(r"[\x00-\x1f\x7f]", lambda c: c[0].encode("unicode_escape").decode(), text), file=stream or sys.stdout, flush=True)


def warn(text):
    """The same, to stderr."""
    tell(text, sys.stderr)
