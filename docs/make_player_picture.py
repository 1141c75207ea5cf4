#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The picture of docs/guides/player.md, docs/images/player.jpg: inverse-play on a display without a screen.

docs/make_player_picture.py [BUILD]     (default build, which ./dev build-only build makes)
"""
import os
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / (sys.argv[1] if len(sys.argv) > 1 else "build")
os.environ.update(GST_PLUGIN_PATH=str(BUILD / "gst"), GST_REGISTRY=str(BUILD / "registry.bin"),
                  INVERSE_MODELS=str(BUILD / "models"))
sys.path.insert(0, str(ROOT / "tests" / "player"))
import support  # noqa: E402

RED_BALL = (385, 303)  # in the bundled clip


def main():
    """Paints a ball of the clip, and saves what the display shows."""
    display = support.Display(1440, 900)
    support.need_gtk()
    from gi.repository import Gdk
    from inverse_play import tools
    from inverse_play.project import Project
    from inverse_play.session import Session
    from inverse_play.ui import style
    from inverse_play.ui.window import Window
    style.apply()
    window = Window(lambda first, second: Session(first, second, Project()))
    window.show()
    session = window.session
    session.open(str(support.CLIP))
    support.pump(20, lambda: session.playback.seekable)
    session.toggle_playing()
    session.playback.seek(2)
    window.choose_tool(tools.RECOLOR)
    support.pump(2)
    for kind in ("mouse-button-press", "mouse-button-release"):
        session.playback.on_mouse(kind, *RED_BALL, False)
    support.pump(2, lambda: session.project.editors)
    session.set_property("recolor1", "target", "0xff40a040")
    session.set_split(0.35)
    support.pump(4)
    root = Gdk.get_default_root_window()
    corner, area = window.get_window().get_origin(), window.get_allocation()
    picture = Gdk.pixbuf_get_from_window(root, corner[1], corner[2], area.width, area.height)
    picture.savev(str(ROOT / "docs" / "images" / "player.jpg"), "jpeg", ["quality"], ["88"])
    session.close()
    display.close()


main()
