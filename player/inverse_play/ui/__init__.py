# SPDX-License-Identifier: LGPL-2.1-or-later
"""The window of inverse-play, in GTK 3."""
import gi

for name, version in (("Gtk", "3.0"), ("Gdk", "3.0"), ("Pango", "1.0")):
    gi.require_version(name, version)
