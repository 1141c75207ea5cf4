# SPDX-License-Identifier: LGPL-2.1-or-later
"""Questions that the window asks: files, and a line of text."""
import datetime
import os

from gi.repository import GLib, Gtk

CANCEL, OK = Gtk.ResponseType.CANCEL, Gtk.ResponseType.OK


def file_to_open(parent, title, kinds=()):
    """The path of a file, or None. `kinds`: media types of the files to list; all without."""
    dialog = Gtk.FileChooserDialog(title=title, transient_for=parent, action=Gtk.FileChooserAction.OPEN)
    dialog.add_buttons("Cancel", CANCEL, "Open", OK)
    if kinds:
        listed = Gtk.FileFilter()
        for kind in kinds:
            listed.add_mime_type(kind)
        dialog.set_filter(listed)
    return _path(dialog)


def folder_to_open(parent, title):
    """The path of a folder, or None."""
    dialog = Gtk.FileChooserDialog(title=title, transient_for=parent, action=Gtk.FileChooserAction.SELECT_FOLDER)
    dialog.add_buttons("Cancel", CANCEL, "Open", OK)
    return _path(dialog)


def file_to_save(parent, title, name, folder=None):
    """The path of a file to write, or None."""
    dialog = Gtk.FileChooserDialog(title=title, transient_for=parent, action=Gtk.FileChooserAction.SAVE,
                                   do_overwrite_confirmation=True)
    dialog.add_buttons("Cancel", CANCEL, "Save", OK)
    if folder:
        dialog.set_current_folder(folder)
    dialog.set_current_name(name)
    return _path(dialog)


def _path(dialog):
    dialog.set_default_response(OK)
    path = dialog.get_filename() if dialog.run() == OK else None
    dialog.destroy()
    return path


def may_open(parent, name, demands):
    """Whether the user allows what a project demands (project.demands)."""
    dialog = Gtk.MessageDialog(transient_for=parent, modal=True, message_type=Gtk.MessageType.WARNING, buttons=Gtk.ButtonsType.NONE,
                               text=f"{name} does more than show a video")
    dialog.format_secondary_text("It " + "\nIt ".join(demands) + "\n\nOpen it only if it is yours, or of somebody you trust.")
    dialog.add_buttons("Do not open", CANCEL, "Open", OK)
    dialog.set_default_response(CANCEL)
    allowed = dialog.run() == OK
    dialog.destroy()
    return allowed


def keep_edits(parent):
    """Whether the edits go on with another video; None: it is not opened."""
    dialog = Gtk.MessageDialog(transient_for=parent, modal=True, message_type=Gtk.MessageType.QUESTION, buttons=Gtk.ButtonsType.NONE,
                               text="Keep the edits for the new video?")
    dialog.format_secondary_text("Selections and strokes lie where they were drawn. Undo brings back the video and its edits.")
    dialog.add_buttons("Do not open", CANCEL, "Begin anew", Gtk.ResponseType.NO, "Keep the edits", Gtk.ResponseType.YES)
    dialog.set_default_response(Gtk.ResponseType.YES)
    answer = {Gtk.ResponseType.YES: True, Gtk.ResponseType.NO: False}.get(dialog.run())
    dialog.destroy()
    return answer


def text(parent, title, about, before):
    """A line of text, or None."""
    dialog = Gtk.Dialog(title=title, transient_for=parent, modal=True)
    dialog.add_buttons("Cancel", CANCEL, "Open", OK)
    dialog.set_default_response(OK)
    entry = Gtk.Entry(text=before, width_chars=70, activates_default=True, margin=8)
    box = dialog.get_content_area()
    box.add(Gtk.Label(label=about, margin=8, xalign=0))
    box.add(entry)
    dialog.show_all()
    found = entry.get_text().strip() if dialog.run() == OK else None
    dialog.destroy()
    return found or None


def new_path(folder, ending):
    """A file that does not exist yet, named by the time: of videos and pictures that are written without a
    question. `folder`: None for the user's own."""
    kind = GLib.UserDirectory.DIRECTORY_PICTURES if ending == ".png" else GLib.UserDirectory.DIRECTORY_VIDEOS
    folder = folder or GLib.get_user_special_dir(kind) or os.getcwd()
    stem = os.path.join(folder, datetime.datetime.now().strftime("inverse-%Y%m%d-%H%M%S"))
    path, count = stem + ending, 1
    while os.path.exists(path):
        path, count = f"{stem}-{count}{ending}", count + 1
    return path
