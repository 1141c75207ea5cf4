#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""pipelines/web in headless Chromium: both videos play, a control changes the layer. INVERSE_SCREENSHOTS: a folder for a picture."""
import asyncio
import base64
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import types
import unittest
import urllib.error
import urllib.request

try:
    import gi
    import websockets

    gi.require_version("Gst", "1.0")
    gi.require_version("GstWebRTC", "1.0")
    from gi.repository import Gst
except (ImportError, ValueError) as problem:
    print(f"{problem}: install python3-websockets, gir1.2-gst-plugins-bad-1.0")
    sys.exit(77)
Gst.init(None)
SERVE = pathlib.Path(__file__).resolve().parents[2] / "pipelines" / "web" / "serve"
# Seconds until what has not happened is given up. Kernels are built within it, on a machine with other work to do: 35 s and more.
LIMIT = 300
CAMERA = "videotestsrc is-live=true pattern=smpte ! video/x-raw,width={width},height={height},framerate={rate}/1"
# The mean of the layer's picture.
MEAN = """(() => { const c = document.createElement("canvas"), v = document.querySelectorAll("video")[1];
  c.width = 64; c.height = 48; c.getContext("2d").drawImage(v, 0, 0, 64, 48);
  const d = c.getContext("2d").getImageData(0, 0, 64, 48).data; let s = 0;
  for (let i = 0; i < d.length; i += 4) s += d[i] + d[i + 1] + d[i + 2]; return s / d.length * 4 / 3; })()"""
MOVE = """(() => { const i = document.querySelector("input[name=white-level]"); i.value = %s; i.dispatchEvent(new Event("input")); return 0; })()"""


class Browser:
    """A page in headless Chromium, driven by its protocol for developers."""

    def __init__(self, folder, uri):
        self.process = subprocess.Popen(
            ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", f"--user-data-dir={folder}", "--window-size=1000,800",
             "--autoplay-policy=no-user-gesture-required", uri], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        told, end = pathlib.Path(folder, "DevToolsActivePort"), time.monotonic() + LIMIT
        while not told.exists() or not told.read_text(encoding="ascii").strip():
            if time.monotonic() > end:
                raise AssertionError("Chromium does not start")
            time.sleep(0.1)
        port = told.read_text(encoding="ascii").split()[0]
        while True:
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json") as reply:
                pages = [page for page in json.load(reply) if page["type"] == "page"]
            if pages:
                break
            time.sleep(0.1)
        self.address = pages[0]["webSocketDebuggerUrl"]

    def call(self, method, **parameters):
        async def run():
            async with websockets.connect(self.address, max_size=None) as socket:
                await socket.send(json.dumps({"id": 1, "method": method, "params": parameters}))
                while True:
                    reply = json.loads(await socket.recv())
                    if reply.get("id") == 1:
                        return reply["result"]

        return asyncio.run(run())

    def evaluate(self, text):
        return self.call("Runtime.evaluate", expression=text)["result"].get("value")

    def screenshot(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("Page.captureScreenshot")["data"]))

    def close(self):
        self.process.kill()
        self.process.wait()


class Web(unittest.TestCase):
    def serve(self, *words, width=160, height=120, rate=10, source=None):
        source = CAMERA.format(width=width, height=height, rate=rate) if source is None else source
        process = subprocess.Popen([SERVE, "--port", "0", "--report", *words], env={**os.environ, "SOURCE": source}, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)

        def end():
            process.kill()
            process.communicate()

        self.addCleanup(end)
        return process

    def open(self, server):
        """A page of the server that plays, and what it told then."""
        uri = server.stdout.readline().strip()
        self.assertRegex(uri, "^http://127.0.0.1:[0-9]+/#[A-Za-z0-9_-]{22}$")
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        browser = Browser(folder, uri)
        self.addCleanup(browser.close)
        end = time.monotonic() + LIMIT
        while True:
            told = json.loads(server.stdout.readline())
            if min(told["frames"]) > 3:
                return browser, told
            self.assertLess(time.monotonic(), end, browser.evaluate("document.getElementById('state').textContent"))

    def test_both_videos_play_and_controls_work(self):
        browser, told = self.open(self.serve())
        self.assertEqual(told["sizes"], [[160, 120], [160, 120]])
        before = browser.evaluate(MEAN)
        self.assertGreater(before, 20)
        browser.evaluate(MOVE % 0.1)
        end = time.monotonic() + LIMIT
        while browser.evaluate(MEAN) > 0.8 * before:
            self.assertLess(time.monotonic(), end, "the control changes nothing")
            time.sleep(0.2)
        if os.environ.get("INVERSE_SCREENSHOTS"):
            browser.screenshot(os.path.join(os.environ["INVERSE_SCREENSHOTS"], "web.png"))

    def test_a_second_page_takes_over(self):
        server = self.serve()
        first, _ = self.open(server)
        uri, _, key = first.evaluate("location.href").partition("#")
        offer = json.loads(self.post(uri + "offer", Authorization=f"Bearer {key}"))
        self.assertIn("VP8/90000", offer["sdp"])
        self.assertEqual(offer["controls"][0]["name"], "show")
        self.assertIsNone(server.poll())

    @staticmethod
    def post(uri, data=b"", **headers):
        with urllib.request.urlopen(urllib.request.Request(uri, data, headers, method="POST"), timeout=LIMIT) as reply:
            return reply.read()

    def test_strangers_get_nothing(self):
        server = self.serve()
        uri, _, key = server.stdout.readline().strip().partition("#")
        self.addCleanup(server.kill)
        right = {"Authorization": f"Bearer {key}"}
        for headers, status in (({}, 403), ({"Authorization": "Bearer x"}, 403), ({**right, "Host": "evil.example"}, 403),
                                ({**right, "Host": "evil.example:" + uri.split(":")[2].strip("/")}, 403),
                                ({**right, "Origin": "http://evil.example"}, 403), ({**right, "Origin": "null"}, 403),
                                ({**right, "Content-Length": "-1"}, 413), ({**right, "Content-Length": "9" * 12}, 413)):
            with self.subTest(headers), self.assertRaises(urllib.error.HTTPError) as refused:
                self.post(uri + "offer", **headers)
            self.assertEqual(refused.exception.code, status)
            refused.exception.close()
        with self.assertRaises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(uri + "offer", timeout=LIMIT)  # a picture or a link of another page
        self.assertEqual(refused.exception.code, 404)
        refused.exception.close()
        # Connections that send nothing take no more than their share, and not for long.
        address = "127.0.0.1", int(uri.split(":")[2].strip("/"))
        idle = [socket.create_connection(address, timeout=LIMIT) for _ in range(40)]
        for connection in idle:
            self.addCleanup(connection.close)
        self.assertEqual([connection.recv(1) for connection in idle], [b""] * len(idle))
        self.assertIn("v=0", json.loads(self.post(uri + "offer", **right))["sdp"])

    def test_half_a_request_keeps_nobody_out(self):
        server = self.serve()
        uri = server.stdout.readline().strip().partition("#")[0]
        address = "127.0.0.1", int(uri.split(":")[2].strip("/"))
        halves = [socket.create_connection(address, timeout=LIMIT) for _ in range(16)]
        for half in halves:
            self.addCleanup(half.close)
            half.sendall(b"GET / HTTP/1.1\r\nX-")
        with urllib.request.urlopen(uri, timeout=LIMIT) as reply:
            self.assertEqual(reply.status, 200)
        # One that goes on byte by byte ends all the same.
        with self.assertRaises(OSError):
            for _ in range(60):
                halves[-1].sendall(b"x")
                time.sleep(0.5)

    def test_names_of_the_server(self):
        loader = importlib.machinery.SourceFileLoader("serve", str(SERVE))
        serve = importlib.util.module_from_spec(importlib.util.spec_from_loader("serve", loader))
        loader.exec_module(serve)
        for given, bound, host, named in (("127.0.0.1", ("127.0.0.1", 80), "127.0.0.1", True), ("127.0.0.1", ("127.0.0.1", 80), "localhost:80", True),
                                          ("127.0.0.1", ("127.0.0.1", 8080), "127.0.0.1", False), ("127.0.0.1", ("127.0.0.1", 80), "evil.example", False),
                                          ("a-host", ("127.0.1.1", 8080), "A-Host:8080", True), ("a-host", ("127.0.1.1", 8080), "b-host:8080", False),
                                          ("0.0.0.0", ("0.0.0.0", 80), "10.0.0.7", True), ("0.0.0.0", ("0.0.0.0", 80), "evil.example", False),
                                          ("::", ("::", 80), "[::1]", True), ("::", ("::", 81), "[::1]:81", True), ("::", ("::", 81), "[::1]", False)):
            server = types.SimpleNamespace(given=given, server_address=bound)
            self.assertEqual(serve.Server.is_named(server, host), named, (given, bound, host))

    def test_what_is_wrong(self):
        for words, source, text in ((["--controls", "nosuch"], None, "has no nosuch"), (["--controls", "strokes"], None, "strokes is no number and no choice"), (["/none.mp4"], "", "there is no file /none.mp4"),
                                    (["--", "intrinsicdecomp", "!", "nosuch"], None, "nosuch"), (["--port", "1", "--address", "203.0.113.1"], None, "cannot be opened")):
            with self.subTest(words):
                self.assertIn(text, self.serve(*words, source=source).communicate(timeout=LIMIT)[1])


if __name__ == "__main__":
    if not shutil.which("chromium"):
        print("Chromium is missing: install chromium")
        sys.exit(77)
    unittest.main(verbosity=2)
