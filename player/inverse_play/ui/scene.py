# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is done with the scene that is remembered of frames with depth."""
from gi.repository import Gtk

from .. import scene
from . import dialogs
from .keys import button_content, key_of
from .style import add_class, label

# (name of the action, words, hint)
SWITCHES = (("touch", "Touch", "A bare hand that touches the scene draws what the stroke tool draws. Look at the scene "
             "from all sides first: meanwhile it stays as it is"),
            ("freeze", "Freeze scene", "Add nothing to the scene, as while somebody works in it"))
BUTTONS = (("forget-scene", "Forget", "Remember the scene anew"),
           ("save-scene", "Save…", "Write the scene: for Load (.scene), or as a mesh with reflectance (.ply)"),
           ("load-scene", "Load…", "Begin with a scene that was saved; the camera is looked for in it"))
ACTIONS = {name for name, _, _ in SWITCHES + BUTTONS}


class SceneTools(Gtk.Box):
    """Shown once frames come with depth. `note`(text) tells something; `draw`() chooses a tool for strokes if there is
    none."""

    def __init__(self, session, note, draw):
        super().__init__(orientation=Gtk.Orientation.VERTICAL, spacing=2, no_show_all=True)
        self._session, self._note, self._draw, self._showing = session, note, draw, False
        self._stage = None  # whose frames came with depth
        self.buttons, row = {}, Gtk.Box(homogeneous=True)
        self.add(label("Scene", "heading"))
        for kind, box, rows in ((Gtk.ToggleButton, self, SWITCHES), (Gtk.Button, add_class(row, "linked"), BUTTONS)):
            for name, words, hint in rows:
                button = self.buttons[name] = kind(tooltip_text=hint, can_focus=False)
                button.add(button_content(words, key_of(name)) if box is self else Gtk.Label(label=words))
                button.connect("clicked", lambda _, name=name: self._showing or self.do(name))
                box.pack_start(button, True, True, 0)
        self.add(row)
        for child in self.get_children():
            child.show_all()

    def update(self):
        """Shows what is in force; hides all of it without a scene."""
        stage, decomposer = self._session.playback.stage, self._session.project.decomposer
        self._stage = stage if stage and (stage is self._stage or stage.scene()) else None
        offered = scene.is_offered(decomposer.factory)
        self.set_visible(offered and (self._stage is not None or decomposer.get(scene.TOUCH)))
        if offered:
            self._showing = True
            self.buttons["touch"].set_active(decomposer.get(scene.TOUCH))
            self.buttons["freeze"].set_active(not decomposer.get(scene.UPDATE))
            self._showing = False

    def do(self, action):
        """Does one of ACTIONS."""
        decomposer = self._session.project.decomposer
        if scene.is_offered(decomposer.factory):
            getattr(self, "_do_" + action.replace("-", "_"))(decomposer)
        else:
            self._note(f"{decomposer.factory} remembers no scene; intrinsicdecomp does.")

    def _do_touch(self, decomposer):
        touches = not decomposer.get(scene.TOUCH)
        self._session.set_touch(touches)
        if touches:
            self._draw()
            self._note("Touch things with a bare hand: it draws as the stroke tool does. The scene stays as it is.")

    def _do_freeze(self, decomposer):
        self._session.set_property("decomposer", scene.UPDATE, not decomposer.get(scene.UPDATE))

    def _do_forget_scene(self, _decomposer):
        self._session.forget_scene()

    def _do_save_scene(self, _decomposer):
        path = dialogs.file_to_save(self.get_toplevel(), "Save the scene", "room.scene")
        if path:
            self._session.save_scene(path)

    def _do_load_scene(self, _decomposer):
        path = dialogs.file_to_open(self.get_toplevel(), "Load a scene")
        if path:
            self._session.load_scene(path)
