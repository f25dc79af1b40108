"""Runs ivory commands once, writes down what they cost, and goes on where an earlier run stopped.

A Step (steps.py) is one command. Its key is a hash of its arguments, of what the files it reads hold, of the steps whose outputs
it reads, of ivory's version and, where its time counts, of the machine; a record of that key in results.jsonl, by the same build of
ivory, means that it need not run again. A Point is what a chart plots: a few steps, and figures taken from their results, kept in
results.jsonl under the hash of all their keys and of the code that takes the figures. Files in FOLDER/work serve steps only and may be
deleted at any time: what a missing one is needed for is made again.
"""
import os
import platform
import shlex
import subprocess
import sys
import time

import process
from hashing import code_hash, digest, file_hash, input_hash
from process import Failure, Stop
from results import Results, lock
from steps import File, Out, Step

SEED = 1
# Shorter commands are run again, as often as this: the least time counts, and all are written down.
SHORT_S, REPEATS = 1.0, 3
# Where others took more than this share of a core, a timed command is run again, at most so often.
DISTURBED, MORE_REPEATS = 0.1, 2
START_UP_REPEATS = 7
LEAST_S = 0.001
# Raise it where point() below takes its figures in another way: points are then made again from the records of their steps.
POINT_VERSION = 2


class Missing(Failure):
    """Was never measured, and now is not the time to."""


def machine():
    model = "unknown"
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                model = line.split(":", 1)[1].strip()
                break
    return {"cpu": model, "cores": os.cpu_count(), "memory_gib": round(
        os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30, 1), "system": platform.platform()}


def worst(shares):
    return max((s for s in shares if s is not None), default=None)


class Runner:
    def __init__(self, ivory, folder, threads, any_build=False, quiet=False, reading=False):
        """reading: nothing is measured, nor anything written into the folder."""
        self.ivory, self.folder, self.threads, self.any_build, self.quiet = ivory, folder, threads, any_build, quiet
        self.reading = reading
        self.work = os.path.join(folder, "work")
        if not reading:
            self._take_folder()
        self._identity = self._binary()
        self.build = file_hash(ivory)
        self.version = subprocess.run([ivory, "--version"], capture_output=True, text=True, check=True).stdout.strip()
        self.machine = machine()
        self.failed = []  # (point's name, why)
        self._broken = {}  # keys of steps that failed, and why
        self._hashes, self._code = {}, {}
        self.results = Results(folder)
        if not reading:
            self.results.trim()

    def _take_folder(self):
        try:
            os.makedirs(self.work, exist_ok=True)
        except OSError as error:
            raise Failure(f"{error.filename}: cannot be made: {error.strerror}; choose another folder") from error
        self._lock = lock(self.folder)
        for name in os.listdir(self.work):  # what a run that was killed left half written
            if ".part" in name:
                os.remove(os.path.join(self.work, name))

    def _binary(self):
        status = os.stat(self.ivory)
        return status.st_ino, status.st_mtime_ns, status.st_size

    def _check_build(self):
        try:
            same = self._binary() == self._identity
        except OSError:  # just being linked
            same = False
        if not same:
            raise Stop(f"{self.ivory}: was built anew while it was being measured; the same command starts over with the new build")

    def file_hash(self, file):
        if file.path not in self._hashes:
            if file.make:
                file.make()
            self._hashes[file.path] = input_hash(file.path)
        return self._hashes[file.path]

    def valid(self, key):
        """The record of that key, unless another build of ivory made it."""
        record = self.results.records.get(key)
        return record if record and (self.any_build or record["build"] == self.build) else None

    def key(self, step):
        # Threads and the machine change times, nothing else.
        parts = [self.version, 0]
        if step.depends_on_machine():
            parts = [self.version, step.threads or self.threads, self.machine["cpu"], self.machine["cores"]]
        for a in step.arguments:
            if isinstance(a, File):
                parts.append("file:" + self.file_hash(a))
            elif isinstance(a, Step):
                parts.append("step:" + self.key(a))
            elif isinstance(a, tuple):
                parts.append(f"{a[0]}step:{self.key(a[1])}")
            elif isinstance(a, Out):
                parts.append("out:" + a.extension)
            else:
                parts.append(str(a))
        return digest(*parts)

    def output(self, step):
        extension = next((a.extension for a in step.arguments if isinstance(a, Out)), None)
        return extension and os.path.join(self.work, f"{self.key(step)}.{extension}")

    def command(self, step):
        words = [self.ivory]
        for a in step.arguments:
            if isinstance(a, File):
                words.append(a.path)
            elif isinstance(a, Step):
                words.append(self.output(a))
            elif isinstance(a, tuple):
                words.append(a[0] + self.output(a[1]))
            elif isinstance(a, Out):
                words += ["-o", self.output(step), "--force"]
            else:
                words.append(str(a))
        return [*words, "--threads", str(step.threads or self.threads), "--json"]

    def _outcome(self, words):
        self._check_build()
        outcome = process.run(words)
        self._check_build()
        return outcome

    def _again(self, step, runs, best):
        if not step.timed or step.seconds == "once":
            return False
        wanted = REPEATS if best.wall_s <= SHORT_S else 1
        return len(runs) < wanted + (MORE_REPEATS if (best.foreign or 0) > DISTURBED else 0)

    def _run(self, step):
        for a in step.arguments:
            needed = a if isinstance(a, Step) else a[1] if isinstance(a, tuple) else None
            if needed is not None:
                self.result(needed, need_output=True)
        words, runs = self.command(step), []

        def seconds(outcome):
            return outcome.result()[step.seconds] if step.reports_time() else outcome.wall_s

        while True:
            runs.append(self._outcome(words))
            best = min(runs, key=seconds)
            if not self._again(step, runs, best):
                break
        seed = next((b for a, b in zip(step.arguments, step.arguments[1:]) if a == "--seed"), SEED)
        result = best.result()
        return {"key": self.key(step), "kind": "step", "command": words, "seed": seed, "machine": self.machine,
                "version": self.version, "build": self.build, "wall_s": best.wall_s, "walls_s": [r.wall_s for r in runs],
                "foreign": best.foreign, "foreigns": [r.foreign for r in runs], "cpu_s": best.cpu_s,
                "seconds": seconds(best), "peak_memory_bytes": max(r.peak_memory_bytes for r in runs),
                "complaint": best.complaint, "result": result}

    def result(self, step, need_output=False):
        """The step's record; runs it where there is none, or where its output is wanted and gone."""
        key, output = self.key(step), self.output(step)
        record = self.valid(key)
        if record is not None and not (need_output and output and not os.path.exists(output)):
            return record
        if key in self._broken:
            raise Failure(self._broken[key])
        if self.reading and step.arguments[0] != "info":
            raise Missing("not measured")
        try:
            record = self._run(step)
        except Failure as failure:
            self._broken[key] = str(failure)
            raise
        if self.reading:
            self.results.records[key] = record
        else:
            self.results.append(record)
        return record

    def _start_up(self, record):
        """Seconds that the program takes to begin, its libraries linked, in every command of that record's build and machine."""
        def key(build, machine):
            return digest("start-up", build, machine["cpu"], machine["cores"])

        records = self.results.records
        found = records.get(key(record["build"], record["machine"])) or records.get(key(self.build, self.machine))
        if found is None:
            if self.reading:
                raise Missing("the program's start was not measured")
            words, runs = [self.ivory, "--version"], []
            for _ in range(2):
                runs += [self._outcome(words) for _ in range(START_UP_REPEATS)]
                best = min(runs, key=lambda r: r.wall_s)
                if (best.foreign or 0) <= DISTURBED:
                    break
            found = {"key": key(self.build, self.machine), "kind": "start_up", "command": words, "machine": self.machine,
                     "version": self.version, "build": self.build, "wall_s": best.wall_s, "walls_s": [r.wall_s for r in runs],
                     "foreign": best.foreign, "foreigns": [r.foreign for r in runs]}
            self.results.append(found)
        return found["wall_s"]

    def seconds(self, step, record):
        """A step's time: what it reports itself, or all of it but the program's start."""
        if step.reports_time():
            return record["result"][step.seconds]
        return max(LEAST_S, record["wall_s"] - self._start_up(record))

    def point_key(self, point):
        if point.curve not in self._code:
            self._code[point.curve] = code_hash(point.curve)
        return digest("point", POINT_VERSION, point.name, self._code[point.curve], *(self.key(s) for s in point.steps))

    def point(self, point):
        """The point's record."""
        key = self.point_key(point)
        record = self.valid(key)
        if record is None:
            record = self._make_point(point, key)
            if self.reading:
                self.results.records[key] = record
            else:
                self.results.append(record)
        return record

    def _make_point(self, point, key):
        steps = [self.result(s) for s in point.steps]
        figures = point.measure(Run(self, point, steps))
        timed = [(s, r) for s, r in zip(point.steps, steps) if s.timed]
        timing = [r for s, r in zip(point.steps, steps) if s.depends_on_machine()]
        whole = [r for s, r in timed if not s.reports_time()]
        return {"key": key, "kind": "point", "curve": point.curve, "panel": point.panel, "series": point.series,
                "label": point.label, "join": point.join, "name": point.name, "version": self.version,
                "build": next((r["build"] for r in steps if r["build"] != self.build), self.build), "machine": self.machine,
                "steps": [r["key"] for r in steps],
                # Records of an older kind hold commands in one string.
                "commands": [c if isinstance(c, str) else shlex.join(c) for c in
                             ([r["command"] for _, r in timed] or [r["command"] for r in steps])],
                "time_s": sum(self.seconds(s, r) for s, r in timed), "start_up_s": self._start_up(whole[0]) if whole else 0.0,
                "peak_memory_bytes": max((r["peak_memory_bytes"] for _, r in timed), default=0),
                "foreign": worst(r.get("foreign") for r in timing), **figures}

    def known(self, point):
        return self.valid(self.point_key(point)) is not None

    def is_done(self, point):
        try:
            return self.known(point)
        except Exception:  # said where the point is made
            return False

    def points(self, points):
        """Records of all points that could be measured; where only reading, of those that were."""
        done, start = [], time.monotonic()
        new = 0 if self.reading else sum(not self.is_done(p) for p in points)
        count = 0
        for p in points:
            try:
                if not self.reading and not self.known(p):
                    count += 1
                    if not self.quiet:
                        print(f"[{count}/{new}, {time.monotonic() - start:.0f} s] {p.name}", file=sys.stderr, flush=True)
                done.append(self.point(p))
            except Missing:
                pass
            except Stop:
                raise
            except Exception as error:  # whatever a command's output or a file did to what reads it: the other points go on
                self.fail(p.name, error)
        return done

    def fail(self, name, error):
        why = str(error) if isinstance(error, Failure) else f"{type(error).__name__}: {error}"
        self.failed.append((name, why))
        print(f"failed: {name}: {why}", file=sys.stderr, flush=True)


class Run:
    """What a point's measure() may ask."""

    def __init__(self, runner, point, records):
        self.runner, self.point, self.records = runner, point, records

    def result(self, step):
        return self.runner.result(step)["result"]

    def seconds(self, step):
        return self.runner.seconds(step, self.runner.result(step))

    def output(self, step):
        self.runner.result(step, need_output=True)
        return self.runner.output(step)
