# SPDX-License-Identifier: LGPL-2.1-or-later
"""Batches of inverse-transcode under make and GNU parallel, and what may go wrong with them."""
import contextlib
import fcntl
import glob
import json
import os
import shutil
import signal
import subprocess
import unittest

from case import Case, Gst, LIMIT, SOUND, VIDEO, frames_of, streams_of


class Batch(Case):
    def long_clip(self, name="long.mkv", frames=120):
        return self.make(name, VIDEO.format(frames=frames, form="I420") + "vp8enc deadline=1 keyframe-max-dist=10 ! queue ! mux. " +
                         SOUND.format(buffers=frames * 1600 // 1024) + "opusenc ! queue ! mux. matroskamux name=mux")

    def work(self, batch, status=0):
        process = subprocess.run(["make", "-j2", "-C", self.path(batch)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                 errors="surrogateescape", timeout=300, check=False)
        self.assertEqual(process.returncode, status, process.stdout)
        return process.stdout

    def manifest(self, batch):
        with open(self.path(batch + "/manifest.json"), encoding="ascii") as read:
            return json.load(read)

    def same(self, one, other, but=()):
        """Whether two files have the same streams; those in `but` may have other pictures."""
        for k, (first, second) in enumerate(zip(streams_of(self.path(one))[0], streams_of(self.path(other))[0], strict=True)):
            self.assertEqual(first.name, second.name)
            self.assertEqual(first.packets, second.packets)
            self.assertTrue(k in but or first.hash.digest() == second.hash.digest(), f"stream {k}")

    def test_chunks_are_joined_to_the_whole(self):
        self.long_clip()
        words = ["--video", "ffv1", "--video-options", "gop-size=1", "long.mkv"]
        for name, chain in (("shown", ["identity"]), ("layers", ["--layers", "input,shading"])):
            with self.subTest(name):
                chain = ["--", "identity"] if name == "shown" else [*chain, "--", "intrinsicdecomp"]
                self.run_it("-o", f"{name}.mkv", *words, *chain)
                said = self.run_it("--batch", f"batch {name}", "--chunk", "1", "--divide-shots", "--overlap", "5", "-o", f"joined {name}.mkv", *words, *chain)
                self.assertIn("4 tasks to do, and 1 to join chunks", said)
                chunks = [task["chunk"] for task in self.manifest(f"batch {name}")["tasks"][:4]]
                self.assertEqual([round(c["start"] / 1e9) for c in chunks], [0, 1, 2, 3])
                self.assertEqual([c["end"] for c in chunks], [*[c["start"] for c in chunks[1:]], None])
                self.work(f"batch {name}")
                # Layers depend on frames before the overlap as well.
                self.same(f"{name}.mkv", f"joined {name}.mkv", but=(0, 1) if name == "layers" else ())
                self.assertEqual(os.listdir(self.path(f"batch {name}/parts")), [])

    def test_chunks_in_every_container(self):
        self.long_clip()
        for name, video, needs in (("mp4", "h264", ["mp4mux", "openh264enc"]), ("webm", "vp9", ["vp9enc"]), ("mov", "prores", ["avenc_prores_ks"])):
            with self.subTest(name):
                self.need(*needs)
                self.run_it("--batch", name, "--chunk", "1.5", "--divide-shots", "--video", video, "-o", f"out.{name}", "long.mkv", "--", "identity")
                self.run_it("--video", video, "-o", f"whole.{name}", "long.mkv", "--", "identity")
                self.assertNotIn("warning", self.work(name))
                self.same(f"whole.{name}", f"out.{name}", but=(0,))  # each chunk begins with a key frame
                self.assertEqual(streams_of(self.path(f"out.{name}"))[0][0].packets, 120)
        self.run_it("--batch", "png", "--chunk", "1.5", "--divide-shots", "-o", "frames", "--to", "png", "long.mkv", "--", "identity")
        self.work("png")
        self.assertEqual(len(os.listdir(self.path("frames"))), 120)

    def times_of(self, name):
        """Of the video packets of a file, in order, ns."""
        pipeline, times = Gst.parse_launch("filesrc name=in ! matroskademux name=d d.video_0 ! fakesink name=out signal-handoffs=true sync=false"), []
        pipeline.get_by_name("in").set_property("location", self.path(name))
        pipeline.get_by_name("out").connect("handoff", lambda _, buffer, pad: times.append(buffer.pts))
        pipeline.set_state(Gst.State.PLAYING)
        pipeline.get_bus().timed_pop_filtered(LIMIT * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
        pipeline.set_state(Gst.State.NULL)
        return sorted(times)

    def test_chunks_have_the_times_of_the_whole(self):
        """Of files that begin late, whose sound is longer or begins first, and of containers with an index in pieces."""
        video = "videotestsrc num-buffers=90 {} ! video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! "
        vp8, h264 = "vp8enc deadline=1 keyframe-max-dist=10 ! queue ! mux. ", "openh264enc gop-size=10 ! h264parse ! queue ! mux. "
        sound = "audiotestsrc num-buffers={} ! audio/x-raw,rate=48000,channels=2 ! opusenc ! queue ! mux. "
        late = "timestamp-offset=1300000000"
        for name, line in (
                ("tail.mkv", video.format("") + vp8 + sound.format(280) + "matroskamux name=mux"),
                ("late.mkv", video.format(late) + vp8 + sound.format(220) + "matroskamux name=mux"),
                ("late-alone.mkv", video.format(late) + vp8 + "matroskamux name=mux"),
                ("tail.mp4", video.format("") + h264 + sound.format(280) + "mp4mux name=mux"),
                ("late.mp4", video.format(late) + h264 + sound.format(220) + "mp4mux name=mux"),
                ("fragments.mp4", video.format("") + h264 + sound.format(140) + "mp4mux name=mux fragment-duration=700")):
            if name.endswith("mp4") and not (Gst.ElementFactory.find("openh264enc") and Gst.ElementFactory.find("mp4mux")):
                continue
            self.make(name, line)
            self.run_it("-o", f"whole {name}.mkv", name, "--", "identity")
            for seconds in ("0.5", "0.7", "1.3"):
                with self.subTest((name, seconds)):
                    batch, out = f"b {name} {seconds}", f"out {name} {seconds}.mkv"
                    said = self.run_it("--batch", batch, "--chunk", seconds, "--divide-shots", "--overlap", "4", "-o", out, name, "--", "identity")
                    self.assertEqual("not divided" in said, name == "fragments.mp4", said)
                    self.work(batch)
                    self.assertEqual(self.times_of(out), self.times_of(f"whole {name}.mkv"))

    def test_chunks_have_the_size_of_the_whole(self):
        """Of a file whose size changes, as browsers record calls."""
        parts = " ".join(f"videotestsrc num-buffers=45 pattern=ball ! video/x-raw,format=I420,width={width},height={height},framerate=30/1 ! "
                         "vp8enc deadline=1 keyframe-max-dist=10 ! c." for width, height in ((160, 120), (208, 160)))
        self.make("call.webm", f"{parts} concat name=c ! capssetter caps=video/x-vp8,width=160,height=120 ! webmmux")
        for ending, video in (("mkv", "vp8"), ("mp4", "h264")):
            with self.subTest(ending):
                words = ["--video", video, "call.webm", "--", "identity"]
                self.run_it("-o", f"whole.{ending}", *words)
                self.run_it("--batch", f"b {ending}", "--chunk", "1", "--divide-shots", "-o", f"out.{ending}", *words)
                self.work(f"b {ending}")
                self.same(f"whole.{ending}", f"out.{ending}", but=(0,))
                frames = [(caps.get_value("width"), caps.get_value("height")) for caps, _ in frames_of(self.path(f"out.{ending}"))]
                self.assertEqual(frames, [(160, 120)] * 90)

    def test_a_cover_before_the_video_is_not_what_is_transcoded(self):
        self.make("cover.mkv", "videotestsrc num-buffers=1 ! video/x-raw,width=64,height=48,framerate=1/1 ! jpegenc ! queue ! c. "
                  + VIDEO.format(frames=90, form="I420") + "vp8enc deadline=1 keyframe-max-dist=10 ! queue ! c. matroskamux name=c")
        words = ["--video", "ffv1", "--video-options", "gop-size=1", "cover.mkv", "--", "identity"]
        self.assertIn("90 frames", self.run_it("-o", "whole.mkv", *words))
        self.run_it("--batch", "b", "--chunk", "1", "--divide-shots", "-o", "out.mkv", *words)
        self.work("b")
        self.same("whole.mkv", "out.mkv")
        streams = [(stream.name, stream.packets) for stream in streams_of(self.path("out.mkv"))[0]]
        self.assertEqual(sorted(streams), [("image/jpeg", 1), ("video/x-ffv", 90)])

    def test_a_record_that_cannot_be_read_is_not_done(self):
        """As a power failure may leave it."""
        self.clip()
        self.run_it("--batch", "b", "-o", "out.mkv", "clip.mkv", "--", "identity")
        self.work("b")
        for text in ("", "{", "[]", "{}"):
            with open(self.path("b/done/0"), "w", encoding="ascii") as file:
                file.write(text)
            self.assertIn("1 waiting", self.run_it("--batch", "b", "--status", status=1))
        self.run_it("--batch", "b", "--task", "0")
        self.assertIn("1 done", self.run_it("--batch", "b", "--status"))

    def test_chunks_begin_at_cuts(self):
        # Three shots of 40 frames, at 30 a second.
        shots = " ".join(f"videotestsrc num-buffers=40 pattern={pattern} ! video/x-raw,width=160,height=120,framerate=30/1 ! c."
                         for pattern in ("smpte", "ball", "circular"))
        self.make("shots.mkv", f"{shots} concat name=c ! vp8enc deadline=1 ! matroskamux")
        self.run_it("--batch", "b", "--chunk", "1", "--out", "out", "shots.mkv", "--", "identity")
        chunks = [task["chunk"] for task in self.manifest("b")["tasks"][:-1]]
        self.assertEqual([round(c["start"] * 30 / 1e9 + 0.25) for c in chunks], [0, 40, 80])
        self.work("b")
        self.assertEqual(streams_of(self.path("out/shots.mkv"))[0][0].packets, 120)

    def test_what_cannot_be_divided_is_done_whole(self):
        self.make("long.avi", VIDEO.format(frames=90, form="I420") + "jpegenc ! avimux")
        self.clip("short.mkv")
        self.run_it("frames/%04d.png", status=1)
        said = self.run_it("--batch", "b", "--chunk", "1", "--out", "out", "long.avi", "short.mkv", "--", "identity")
        self.assertIn("long.avi: not divided", said)
        self.assertIn("2 tasks to do:", said)
        self.work("b")
        self.assertEqual(streams_of(self.path("out/long.mkv"))[0][0].packets, 90)

    def test_a_folder_is_worked_and_told_of(self):
        os.mkdir(self.path("in"))
        for name in ("a.mkv", "of two\nlines \u00fc.mkv", os.fsdecode(b"no \xff UTF-8.mkv")):
            shutil.copy(self.clip(), self.path("in/" + name))
        for name, text in (("broken.mp4", "this is no video"), ("empty.mp4", "")):
            with open(self.path("in/" + name), "w", encoding="utf-8") as file:
                file.write(text)
        self.clip("more/a.webm")
        shutil.copy(self.path("in/a.mkv"), self.path("more/a.mkv"))
        said = self.run_it("--batch", "b'1 $x", "--out", "out", "in", "more", "--", "identity")
        self.assertIn("empty.mp4: it is empty", said)
        self.assertIn("its output would replace that of", said)
        self.work("b'1 $x", status=2)  # one is no video
        said = self.run_it("--batch", "b'1 $x", "--status", "--report", "report.json", status=1)
        self.assertIn("4 done, 3 failed", said)
        with open(self.path("report.json"), encoding="utf-8") as read:
            report = json.load(read)
        self.assertEqual(report["counts"], {"done": 4, "failed": 3})
        self.assertEqual(sorted(os.listdir(self.path("out/in"))), sorted(n.replace("mp4", "mkv") for n in os.listdir(self.path("in")) if "mkv" in n))
        # What is done is not done again, and what is lost is.
        lost = self.path("out/in/a.mkv")
        os.unlink(lost)
        for result in report["files"]:
            if result["output"] == lost:
                self.assertIn("done", self.run_it("--batch", "b'1 $x", "--task", str(result["task"]), str(result["task"])))
        self.assertTrue(os.path.exists(lost))

    def test_parallel(self):
        if not shutil.which("parallel"):
            self.skipTest("there is no GNU parallel")
        self.long_clip()
        said = self.run_it("--batch", "b'1 $x", "--chunk", "1", "--divide-shots", "-o", "out.mkv", "long.mkv", "--", "identity")
        for name in ("tasks", "joins"):
            with open(self.path(f"b'1 $x/{name}"), encoding="ascii") as read:
                tasks = 2 * read.read()  # each twice: one waits for the other and finds it done
            subprocess.run(["parallel", "-q", "-j4", self.path("b'1 $x/run")], input=tasks, text=True, check=True, stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL, timeout=200)
        self.assertEqual(streams_of(self.path("out.mkv"))[0][0].packets, 120)
        self.assertIn("5 done", self.run_it("--batch", "b'1 $x", "--status"))
        line = next(line for line in said.splitlines() if line.startswith("  parallel"))
        subprocess.run(line, shell=True, cwd=self.folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=200)

    @staticmethod
    def processes(option, of):
        """Those that pgrep finds."""
        return [int(line) for line in subprocess.run(["pgrep", option, str(of)], check=False, stdout=subprocess.PIPE, text=True).stdout.split()]

    def test_a_killed_task_is_told_of_and_done_again(self):
        self.clip(frames=900)
        self.run_it("--batch", "b", "-o", "out.mkv", "clip.mkv")
        process = subprocess.Popen([self.path("b/run"), "0"], stderr=subprocess.DEVNULL, start_new_session=True)
        self.wait_for_part()
        self.assertIn("1 running", self.run_it("--batch", "b", "--status", status=1, parts=True))
        session = self.processes("-s", process.pid)
        for found in session + self.processes("-P", ",".join(map(str, session))):  # workers have sessions of their own
            with contextlib.suppress(ProcessLookupError):
                os.kill(found, signal.SIGKILL)
        process.wait()
        for lock in glob.glob(self.path(".*.lock")):  # a worker holds it until its threads have ended, too
            with open(lock, "rb") as held:
                fcntl.flock(held, fcntl.LOCK_EX)
        self.assertIn("ended without a result", self.run_it("--batch", "b", "--status", status=1, parts=True))
        os.unlink(self.path("b/manifest.json"))
        shutil.rmtree(self.path("b"))
        self.run_it("--batch", "b", "-o", "out.mkv", "clip.mkv", "--", "identity", parts=True)
        self.work("b")
        self.assertIn("1 done", self.run_it("--batch", "b", "--status"))

    def test_what_is_wrong_with_a_batch(self):
        self.long_clip()
        self.clip()
        self.run_it("--batch", "b", "--chunk", "1", "--divide-shots", "-o", "out.mkv", "long.mkv", "--", "identity")
        self.run_it("--batch", "edited", "--out", "results", "clip.mkv", "--", "identity")
        text = json.dumps(self.manifest("edited")).replace("identity", "fakesink")
        os.unlink(self.path("edited/manifest.json"))
        with open(self.path("edited/manifest.json"), "w", encoding="ascii") as file:
            file.write(text)
        os.mkdir(self.path("damaged"))
        with open(self.path("damaged/manifest.json"), "w", encoding="ascii") as file:
            file.write("{}")
        with open(self.path("file"), "w", encoding="ascii"):
            pass
        for words, text, status in (
            (["--status"], "--status needs --batch", 2),
            (["--chunk", "3", "clip.mkv"], "--chunk needs --batch", 2),
            ([], "name an input", 2),
            (["--batch", "b"], "name an input, --slurm, --status or --task", 2),
            (["--batch", "b", "--status", "clip.mkv"], "takes no inputs", 2),
            (["--batch", "b", "--status", "--task", "1"], "exclude each other", 2),
            (["--batch", "b", "clip.mkv"], "there is a batch in", 2),
            (["--batch", "none", "--status"], "there is no batch", 2),
            (["--batch", "damaged", "--status"], "is damaged", 2),
            (["--batch", "edited", "--status"], "was edited", 2),
            (["--batch", "edited", "--task", "0"], "was edited", 2),
            (["--batch", "b", "--task", "5"], "there is no task 5; the batch has 5, from 0", 2),
            (["--batch", "b", "--task", "4"], "of its 4 parts, 4 are not done, such as task 0", 1),
            (["--batch", "file", "clip.mkv"], "file", 1),
        ):
            with self.subTest(words):
                self.assertIn(text, self.run_it(*words, status=status))
        self.work("b")
        # A part that is lost after all is made again; the join says so.
        os.unlink(self.path("out.mkv"))
        self.assertIn("4 are not done", self.run_it("--batch", "b", "--task", "4", status=1))
        self.work("b")
        self.assertTrue(os.path.exists(self.path("out.mkv")))
        # An input that is another one by now.
        self.run_it("--batch", "other", "--out", "results", "clip.mkv", "--", "identity")
        self.clip(frames=13)
        self.assertIn("it is not the file that the manifest lists", self.work("other", status=2))
        self.assertEqual(os.path.exists(self.path("results")), False)

    def test_a_folder_with_files_of_somebody_is_no_batch(self):
        self.clip()
        for name in ("run", "Makefile", "tasks", "done/0"):
            with self.subTest(name):
                folder = self.path("of " + name.replace("/", " "))
                os.makedirs(os.path.dirname(os.path.join(folder, name)))
                with open(os.path.join(folder, name), "w", encoding="ascii") as file:
                    file.write("all: mine\n")
                self.assertIn("is in the place of a part of the batch", self.run_it("--batch", folder, "clip.mkv", "--", "identity", status=2))
                self.assertEqual([names for _, _, names in os.walk(folder) if names], [[os.path.basename(name)]])
        # What a run that was interrupted left is no hindrance.
        self.run_it("--batch", "b", "clip.mkv", "--", "identity")
        os.unlink(self.path("b/manifest.json"))
        self.run_it("--batch", "b", "clip.mkv", "--", "identity")
        self.assertIn("is no report", self.run_it("--batch", "b", "--status", "--report", "b/manifest.json", status=2))

    def test_a_full_disk(self):
        os.mkdir(self.path("small"))
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=200k", "none", self.path("small")], check=False, stderr=subprocess.DEVNULL).returncode:
            self.skipTest("no small file system can be mounted")
        self.addCleanup(subprocess.run, ["umount", self.path("small")], check=False)
        self.clip(frames=300)
        self.run_it("--batch", "b", "--video", "ffv1", "-o", "small/out.mkv", "clip.mkv", "--", "identity")
        self.assertIn("FAILED", self.work("b", status=2))
        self.assertEqual(os.listdir(self.path("small")), [])
        subprocess.run(["mount", "-o", "remount,size=9M", self.path("small")], check=True)
        self.work("b")
        self.assertEqual(os.listdir(self.path("small")), ["out.mkv"])

    def test_no_slurm(self):
        self.clip()
        tools = self.path("tools")
        os.mkdir(tools)
        for name in ("bash", "dirname", "realpath", "python3", "env"):
            os.symlink(shutil.which(name), os.path.join(tools, name))
        said = self.run_it("--batch", "b", "--slurm", "clip.mkv", status=2, env={**os.environ, "PATH": tools})
        self.assertIn("there is no sbatch on this host. Without Slurm: make -C", said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
