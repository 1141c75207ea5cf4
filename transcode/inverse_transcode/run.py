# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs tasks on this machine, some at a time, each in a process of its own: one that crashes fails alone."""
import json
import os
import selectors
import shutil
import signal
import subprocess
import sys
import time

from .lines import warn


class Progress:
    """One line on a terminal, rewritten; elsewhere nothing but what is done."""

    def __init__(self, count, quiet):
        self.count, self.ended, self.running, self.started = count, 0, {}, time.monotonic()
        self.show = not quiet and sys.stderr.isatty()
        self.quiet, self.frames = quiet, 0

    def say(self, text):
        """A line that stays."""
        if self.show:
            sys.stderr.write("\r\033[K")
        warn(text)
        self.draw()

    def draw(self):
        if not self.show:
            return
        elapsed = max(time.monotonic() - self.started, 1e-3)
        parts = [self._share(task) for task in self.running.values()]
        share = (self.ended + sum(parts)) / max(self.count, 1)
        frames = self.frames + sum(task.get("frames", 0) for task in self.running.values())
        left = elapsed * (1 - share) / share if share > 0.005 else None
        width = 24
        filled = int(width * share)
        text = (f"[{'#' * filled}{'.' * (width - filled)}] {100 * share:3.0f} %  {self.ended} of {self.count}  "
                f"{frames / elapsed:.1f} frames/s  {_clock(left)} left")
        sys.stderr.write("\r\033[K" + text[:max(shutil.get_terminal_size().columns - 1, 10)])
        sys.stderr.flush()

    def close(self):
        if self.show:
            sys.stderr.write("\r\033[K")
            sys.stderr.flush()

    @staticmethod
    def _share(said):
        if said.get("seconds", 0) > 0:
            return min(said["time"] / said["seconds"], 1)
        return 0


def _clock(seconds):
    if seconds is None:
        return "-:--"
    minutes, seconds = divmod(int(seconds + 0.5), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes}:{seconds:02}"


def _size(path):
    if not os.path.isdir(path):
        return os.path.getsize(path)
    return sum(os.path.getsize(os.path.join(base, name)) for base, _, names in os.walk(path) for name in names)


class Runner:
    """`run` returns a list of results, as they are in the report, in the order of the tasks."""

    def __init__(self, settings, jobs, quiet=False, verbose=False):
        self.settings, self.jobs, self.quiet, self.verbose = settings, jobs, quiet, verbose
        self.stopping, self.killing, self.stopped_at = False, False, None

    def run(self, tasks):
        results = {}
        todo = []
        for index, task in enumerate(tasks):
            base = {"input": task.input, "output": task.output}
            if task.problem:
                results[index] = {**base, "status": "failed", "error": task.problem}
            elif task.done:
                results[index] = {**base, "status": "present"}
                if not self.quiet:
                    warn(f"present {task.output}: newer than its input (--again makes it anew; settings are not compared)")
            else:
                todo.append((index, task))
        progress = Progress(len(todo), self.quiet)
        for index in sorted(results):
            if results[index]["status"] == "failed":
                progress.say(f"FAILED  {tasks[index].input}: {results[index]['error']}")
        previous = [(number, signal.signal(number, self._stop)) for number in (signal.SIGINT, signal.SIGTERM)]
        selector, workers = selectors.DefaultSelector(), {}
        try:
            while workers or (todo and not self.stopping):
                while todo and len(workers) < self.jobs and not self.stopping:
                    index, task = todo.pop(0)
                    try:
                        worker = self._start(task)
                    except OSError as error:
                        results[index] = {"input": task.input, "output": task.output, "status": "failed", "error": error.strerror}
                        progress.ended += 1
                        self._tell(progress, results[index])
                        continue
                    workers[index] = worker
                    progress.running[index] = {}
                    selector.register(worker.stdout, selectors.EVENT_READ, index)
                for key, _ in selector.select(timeout=0.5):
                    line = key.fileobj.readline()
                    if line:
                        progress.running[key.data].update(json.loads(line))
                        continue
                    selector.unregister(key.fileobj)
                    index, worker = key.data, workers.pop(key.data)
                    said = progress.running.pop(index)
                    results[index] = self._end(tasks[index], worker, said)
                    progress.ended += 1
                    progress.frames += results[index].get("frames", 0)
                    self._tell(progress, results[index])
                if self.stopping:
                    for worker in workers.values():
                        if self.killing:
                            worker.kill()
                        elif worker.stdin and not worker.stdin.closed:
                            worker.stdin.close()
                progress.draw()
        finally:
            for worker in workers.values():
                worker.kill()
            for number, handler in previous:
                signal.signal(number, handler)
            progress.close()
        for index, task in todo:
            results[index] = {"input": task.input, "output": task.output, "status": "not started"}
        return [results[index] for index in sorted(results)]

    def _stop(self, *_):
        now = time.monotonic()
        # One signal may come twice, to the process and to its group.
        if self.stopped_at and now - self.stopped_at > 1:
            self.killing = True
        self.stopped_at = self.stopped_at or now
        self.stopping = True

    def _start(self, task):
        errors = None if self.verbose else subprocess.DEVNULL
        worker = subprocess.Popen([sys.executable, "-m", __package__ + ".worker"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                  stderr=errors, start_new_session=True, text=True)
        try:
            worker.stdin.write(json.dumps(task.as_json(self.settings)) + "\n")
            worker.stdin.flush()
        except BrokenPipeError:
            pass  # its end is seen below
        return worker

    @staticmethod
    def _end(task, worker, said):
        if worker.stdin and not worker.stdin.closed:
            worker.stdin.close()
        code = worker.wait()
        result = {"input": task.input, "output": task.output, "warnings": []}
        if "status" not in said:
            cause = signal.Signals(-code).name if code < 0 else f"exit status {code}"
            return {**result, "status": "failed", "error": f"its process ended ({cause})"}
        kept = {key: said[key] for key in ("status", "error", "written", "frames", "elapsed", "copied", "warnings") if key in said}
        result.update(kept)
        if result.get("elapsed"):
            result["frames_per_second"] = round(result["frames"] / result["elapsed"], 2)
        if result["status"] == "done":
            result["bytes"] = _size(task.output)
        return result

    def _tell(self, progress, result):
        if result["status"] == "failed":
            progress.say(f"FAILED  {result['input']}: {result['error']}")
        elif result["status"] == "stopped":
            progress.say(f"stopped {result['input']}: " + (f"what was done, {result['frames']} frames, is in {result['written']}"
                                                          if "written" in result else "nothing was done yet"))
        elif not self.quiet:
            progress.say(f"done    {result['output']}: {result['frames']} frames, {result['frames_per_second']} a second")
        if not self.quiet or result["status"] != "done":
            for warning in result.get("warnings", []):
                progress.say(f"        warning: {warning}")
