#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""pipelines/rtsp with eight clients, of which one stops reading, and pipelines/hls: what players get."""
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

try:
    import gi

    gi.require_version("Gst", "1.0")
    gi.require_version("GstRtspServer", "1.0")
    from gi.repository import Gst
except (ImportError, ValueError) as problem:
    print(f"{problem}: install python3-gi, gir1.2-gst-rtsp-server-1.0")
    sys.exit(77)
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "common"), str(ROOT / "tests")]
from inverse_common import media  # noqa: E402
from inverse_common.gst import structure_of  # noqa: E402
from lists_in_files import Listed  # noqa: E402

Gst.init(None)
SCRIPTS = ROOT / "pipelines"
# Seconds until what has not happened is given up. Kernels are built within it, on a machine with other work to do: 35 s and more.
LIMIT = 300
CAMERA = "videotestsrc is-live=true pattern=ball ! video/x-raw,width=160,height=120,framerate=10/1"


class Client:
    """Counts the decoded frames of a server."""

    def __init__(self, uri, protocol):
        self.frames, self.size, self.sizes = 0, None, []
        # It waits for kernels, too: by default for 20 s, and for 5 s between packets of UDP.
        self.pipeline = Gst.parse_launch(f"rtspsrc location={uri} protocols={protocol} latency=0 timeout=0 tcp-timeout={LIMIT * 10 ** 6} ! "
                                         "rtpvp8depay ! vp8dec ! fakesink name=sink signal-handoffs=true sync=false")
        self.pipeline.get_bus().enable_sync_message_emission()
        self.pipeline.get_bus().connect("sync-message::error", lambda _, message: print(protocol, message.parse_error(), file=sys.stderr))
        self.pipeline.get_by_name("sink").connect("handoff", self._handoff)
        self.pipeline.set_state(Gst.State.PLAYING)

    def _handoff(self, _, __, pad):
        self.frames += 1
        structure = structure_of(pad.get_current_caps())
        self.size = structure.get_value("width"), structure.get_value("height")
        if self.sizes[-1:] != [self.size]:
            self.sizes.append(self.size)

    def close(self):
        self.pipeline.set_state(Gst.State.NULL)


class Case(unittest.TestCase):
    """A test that starts programs."""

    def start(self, *words, source=CAMERA, **options):
        process = subprocess.Popen(words, env={**os.environ, "SOURCE": source}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)

        def end():
            process.kill()
            process.communicate()

        self.addCleanup(end)
        return process

    def wait(self, until, seconds=LIMIT):
        end = time.monotonic() + seconds
        while not until():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)


class Serve(Case):
    def test_one_client(self):
        server = self.start(SCRIPTS / "rtsp", "--port", "0")
        client = Client(server.stdout.readline().strip(), "tcp")
        self.addCleanup(client.close)
        self.wait(lambda: client.frames > 2)
        self.assertEqual(client.size, (160, 120))

    def test_udp_listens_where_it_serves_alone(self):
        server = self.start(SCRIPTS / "rtsp", "--port", "0")
        client = Client(server.stdout.readline().strip(), "udp")
        self.addCleanup(client.close)
        self.wait(lambda: client.frames > 2)
        names = (os.path.join(f"/proc/{server.pid}/fd", name) for name in os.listdir(f"/proc/{server.pid}/fd"))
        open_ones = {os.readlink(name)[8:-1] for name in names if os.path.exists(name) or os.path.islink(name)}
        rows = [line.split() for kind in ("udp", "udp6") for line in pathlib.Path(f"/proc/{server.pid}/net/{kind}").read_text(encoding="ascii").splitlines()[1:]]
        bound = [row[1].split(":")[0] for row in rows if row[9] in open_ones]
        self.assertEqual(set(bound), {"0100007F"})

    def test_clients_that_ask_for_nothing_keep_nobody_out(self):
        server = self.start(SCRIPTS / "rtsp", "--port", "0")
        uri = server.stdout.readline().strip()
        silent = [socket.create_connection(("127.0.0.1", int(uri.split(":")[2].split("/")[0])), timeout=LIMIT) for _ in range(40)]
        for connection in silent:
            self.addCleanup(connection.close)
            connection.sendall(b"OPTIONS rtsp")
        self.assertEqual([connection.recv(1) for connection in silent[:8]], [b""] * 8)  # as new ones came
        client = Client(uri, "tcp")
        self.addCleanup(client.close)
        self.wait(lambda: client.frames > 2)

    def test_eight_clients_and_one_that_stops_reading(self):
        server = self.start(SCRIPTS / "rtsp", "--port", "0")
        uri = server.stdout.readline().strip()
        self.assertRegex(uri, "^rtsp://127.0.0.1:[0-9]+/live/[A-Za-z0-9_-]{22}$")
        stuck = self.start("gst-launch-1.0", "-q", "rtspsrc", f"location={uri}", "protocols=tcp", "!", "fakesink")
        clients = [Client(uri, "udp" if k % 2 else "tcp") for k in range(8)]
        for client in clients:
            self.addCleanup(client.close)
        self.wait(lambda: all(client.frames > 5 for client in clients))
        stuck.send_signal(signal.SIGSTOP)
        before = [client.frames for client in clients]
        # In less time than the server takes to give up a client: 60 s.
        self.wait(lambda: all(client.frames > count + 30 for client, count in zip(clients, before)), 45)
        self.assertEqual({client.size for client in clients}, {(160, 120)})
        clients[0].close()
        late = Client(uri, "tcp")
        self.addCleanup(late.close)
        self.wait(lambda: late.frames > 5)
        self.assertIsNone(server.poll())

    def test_what_is_wrong(self):
        server = self.start(SCRIPTS / "rtsp", "--port", "0")
        port = server.stdout.readline().strip().split(":")[2].split("/")[0]
        for words, text in ((["--port", port], "cannot be opened: the port may be in use"), (["--", "nosuchelement"], "nosuchelement"),
                            (["/none.mp4"], "there is no file /none.mp4"), (["/dev/video99"], "there is no camera /dev/video99")):
            with self.subTest(words):
                other = self.start(SCRIPTS / "rtsp", *words, source="" if words[0].startswith("/") else CAMERA)
                self.assertIn(text, other.communicate(timeout=LIMIT)[1])
                self.assertEqual(other.returncode, 1)
        self.assertIn("a port is a number from 0 to 65535, not 99999", self.start(SCRIPTS / "rtsp", "--port", "99999").communicate(timeout=LIMIT)[1])

    def test_a_source_that_fails_is_told_of(self):
        with tempfile.NamedTemporaryFile("w", suffix=".mp4") as text:
            text.write("no video\n" * 100)
            text.flush()
            server = self.start(SCRIPTS / "rtsp", text.name, "--port", "0", source="")
            client = Client(server.stdout.readline().strip(), "tcp")
            self.addCleanup(client.close)
            self.assertIn("rtsp: ", server.stderr.readline())

    def test_a_list_within_a_file_opens_no_connection(self):
        listed = Listed(self)
        environment = unittest.mock.patch.dict(os.environ, SINK="fakesink")
        environment.start()
        self.addCleanup(environment.stop)
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "plain.m3u8").write_bytes(listed.text)
            for name in ("plain.m3u8", *listed.write(folder)):
                path = pathlib.Path(folder, name)
                for words, source in ((("playbin", path, "identity"), ""), (("playbin", path.as_uri(), "identity"), ""), (("rtp-out", path), ""),
                                      (("rtsp", path, "--port", "0"), ""), (("webcam",), f"filesrc location={path}")):
                    with self.subTest(words):
                        process = self.start(SCRIPTS / words[0], *map(str, words[1:]), source=source)
                        _, errors = process.communicate(timeout=LIMIT)
                        self.assertNotEqual(process.returncode, 0)
                        if not source:
                            self.assertRegex(errors, f"{words[0]}: .*{name}.* list of streams")
        listed.expect_no_connection(self)
        playing = self.start(SCRIPTS / "playbin", f"{listed.address}/a.m3u8", "identity", source="")
        listed.listener.settimeout(LIMIT)
        connection, _ = listed.listener.accept()
        with connection:
            connection.recv(1 << 16)
            connection.sendall(b"HTTP/1.0 200 OK\r\nContent-Type: application/vnd.apple.mpegurl\r\n\r\n" + listed.text)
        connection, _ = listed.listener.accept()  # what the list names
        with connection:
            self.assertIn(b"a.", connection.recv(1 << 16))
        playing.kill()

    def test_every_element_that_plays_lists_is_left_out(self):
        media.allow_lists(False)
        self.addCleanup(media.allow_lists, True)
        named = re.search('lists="(.*)"', (SCRIPTS / "common.sh").read_text(encoding="utf-8"))[1].split()
        adaptive = [f for f in Gst.ElementFactory.list_get_elements(Gst.ELEMENT_FACTORY_TYPE_DEMUXER, Gst.Rank.NONE) if "Adaptive" in f.get_metadata("klass")]
        self.assertEqual([f.get_name() for f in adaptive if f.get_rank() > 0 or f.get_name() not in named], [])

    def test_hls_replaces_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("live.m3u8", "00000.ts"):
                mine = pathlib.Path(folder, name)
                mine.write_text("mine", encoding="ascii")
                writer = self.start(SCRIPTS / "hls", "unused", folder)
                self.assertIn(f"{name} is there already", writer.communicate(timeout=LIMIT)[1])
                self.assertEqual(mine.read_text(encoding="ascii"), "mine")
                mine.unlink()
            mine.write_text("mine", encoding="ascii")
            writer = self.start(SCRIPTS / "hls", mine, folder, "--overwrite", source="")
            self.assertIn("would replace the input", writer.communicate(timeout=LIMIT)[1])

    def test_hls(self):
        if not any(Gst.ElementFactory.find(name) for name in ("x264enc", "openh264enc")):
            self.skipTest("there is no encoder for H.264")
        with tempfile.TemporaryDirectory() as folder:
            writer = self.start(SCRIPTS / "hls", "unused", f"{folder}/a b", "--", "intrinsicdecomp", "show=shading")
            playlist = pathlib.Path(folder, "a b", "live.m3u8")
            self.wait(lambda: playlist.exists() and playlist.read_text(encoding="utf-8").count(".ts") > 1)
            writer.send_signal(signal.SIGINT)
            writer.communicate(timeout=LIMIT)
            self.assertIn("#EXT-X-ENDLIST", playlist.read_text(encoding="utf-8"))
            segments = sorted(playlist.parent.glob("*.ts"))
            player = Gst.parse_launch("filesrc name=in ! tsdemux ! h264parse ! decodebin ! fakesink name=sink sync=false")
            player.get_by_name("in").set_property("location", str(segments[0]))
            player.set_state(Gst.State.PLAYING)
            message = player.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
            self.assertEqual(message and message.type, Gst.MessageType.EOS)
            self.assertEqual(structure_of(player.get_by_name("sink").get_static_pad("sink").get_current_caps()).get_value("width"), 160)
            player.set_state(Gst.State.NULL)

    def test_hls_of_a_file(self):
        if not Gst.ElementFactory.find("openh264enc"):
            self.skipTest("there is no openh264enc")
        with tempfile.TemporaryDirectory() as folder:
            clip = f"{folder}/a clip.mp4"
            writer = Gst.parse_launch("videotestsrc num-buffers=700 ! video/x-raw,width=160,height=120 ! openh264enc gop-size=60 ! h264parse ! mp4mux ! filesink name=out")
            writer.get_by_name("out").set_property("location", clip)
            writer.set_state(Gst.State.PLAYING)
            writer.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
            writer.set_state(Gst.State.NULL)
            _, errors = self.start(SCRIPTS / "hls", clip, f"{folder}/out", source="").communicate(timeout=LIMIT)
            playlist = pathlib.Path(folder, "out", "live.m3u8").read_text(encoding="utf-8")
            self.assertIn("#EXT-X-ENDLIST", playlist, errors)
            names = [line for line in playlist.splitlines() if line.endswith(".ts")]
            self.assertGreater(len(names), 10)  # all of it, and not the last ten segments
            self.assertEqual(sorted(names), sorted(name.name for name in pathlib.Path(folder, "out").glob("*.ts")))


if __name__ == "__main__":
    unittest.main(verbosity=2)
