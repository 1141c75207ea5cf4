#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""latency_bench.py [--size WxH] [--seconds S] [-- ELEMENTS]: from picture to page, by a clock in the picture.

Each frame that is sent to pipelines/web/serve shows the time at which it was made as a row of black and white squares: two for reference, and 16
bits of milliseconds. The page, in headless Chromium on the same machine, reads it when a frame is shown. Prints milliseconds (median, 9 of 10
frames) and frames a second, of input and layer. ELEMENTS must leave the picture as it
is: intrinsicdecomp ! intrinsiccompose. Run it on an idle machine."""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import threading
import time

import numpy
import web_test

RATE = 25
BITS = 16
READ = """(() => {
  const W = %d, H = %d, side = W / 20, canvas = document.createElement("canvas"), told = window.told = [[], []];
  canvas.width = W; canvas.height = H;
  const context = canvas.getContext("2d", {willReadFrequently: true});
  document.querySelectorAll("video").forEach((video, k) => {
    const look = () => {
      const now = Date.now();
      context.drawImage(video, 0, 0, W, H);
      const row = context.getImageData(0, H / 2, W, 1).data, value = i => row[4 * Math.round((i + 1.5) * side) + 1];
      const middle = (value(0) + value(1)) / 2;
      let then = 0;
      for (let i = 0; i < %d; ++i) then = 2 * then + (value(2 + i) > middle ? 1 : 0);
      told[k].push((now - then) & 65535);
      video.requestVideoFrameCallback(look);
    };
    video.requestVideoFrameCallback(look);
  });
})()"""


def send(path, width, height, process):
    """Writes frames to a pipe at their times."""
    side = width // 20
    picture = numpy.empty((height, width, 3), numpy.uint8)
    picture[:] = numpy.linspace((200, 90, 60), (60, 120, 180), width)[None, :, :]
    rows = slice(height // 2 - side, height // 2 + side)
    try:
        with open(path, "wb", buffering=0) as pipe:
            end = time.monotonic()
            while process.poll() is None:
                end += 1 / RATE
                time.sleep(max(0, end - time.monotonic()))
                now = int(time.time() * 1000) & (1 << BITS) - 1
                for i, bit in enumerate([1, 0] + [now >> k & 1 for k in reversed(range(BITS))]):
                    picture[rows, (i + 1) * side:(i + 2) * side] = 235 if bit else 20
                pipe.write(picture.tobytes())
    except BrokenPipeError:
        pass


def main():
    at = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--seconds", type=int, default=30)
    arguments = parser.parse_args(sys.argv[1:at])
    width, height = map(int, arguments.size.split("x"))
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "frames")
        os.mkfifo(path)
        source = (f"filesrc location={path} blocksize={3 * width * height} do-timestamp=true ! rawvideoparse width={width} height={height} format=rgb "
                  f"framerate={RATE}/1")
        server = subprocess.Popen([web_test.SERVE, "--port", "0", "--report", *(sys.argv[at:] or ["--", "intrinsicdecomp", "!", "intrinsiccompose"])], env={**os.environ, "SOURCE": source}, stdout=subprocess.PIPE, text=True)
        threading.Thread(target=send, args=(path, width, height, server), daemon=True).start()
        browser = web_test.Browser(folder, server.stdout.readline().strip())
        try:
            while min(json.loads(server.stdout.readline())["frames"]) < 4:
                pass
            time.sleep(5)
            browser.evaluate(READ % (width, height, BITS))
            time.sleep(arguments.seconds)
            told = browser.evaluate("JSON.stringify(window.told)")
        finally:
            browser.close()
            server.kill()
    for name, values in zip(("input", "layer"), json.loads(told)):
        print(f"{name}: {numpy.median(values):.0f} ms, {numpy.quantile(values, 0.9):.0f} ms, {len(values) / arguments.seconds:.1f} frames/s")


main()
