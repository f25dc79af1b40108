"""Runs ivory commands once, writes down what they cost, and goes on where an earlier run stopped.

A Step is one command. Its key is a hash of its arguments, of what the files it reads hold, of the steps whose outputs
it reads, and of ivory's version; a record of that key in results.jsonl, by the same build of ivory, means that it need not run again. A Point is what
a chart plots: a few steps, and figures taken from their results, kept in results.jsonl under the hash of all their keys. Files in
FOLDER/work serve steps only and may be deleted at any time: what a missing one is needed for is made again.
"""
import dataclasses
import hashlib
import json
import os
import platform
import re
import subprocess
import sys
import tempfile
import time

SEED = 1
# Shorter commands are run again, as often as this: the least time counts, and all are written down.
SHORT_S, REPEATS = 1.0, 3


class Failure(Exception):
    """What went wrong, in a line."""


@dataclasses.dataclass(frozen=True)
class File:
    """An input; `make` writes it where it is not there when first used."""
    path: str
    make: object = None


@dataclasses.dataclass(frozen=True)
class Out:
    """The step's own output, by its extension."""
    extension: str


@dataclasses.dataclass(eq=False)
class Step:
    arguments: tuple  # strings and numbers, File, Out, Steps whose outputs are read; NAME=OUTPUT as ("NAME=", Step)
    timed: bool = False  # does its time count for the point?
    seconds: str = "wall"  # the command's whole time; "once": the same, never repeated; "result": what it reports itself
    threads: int = 0  # 0: as the suite says


@dataclasses.dataclass(eq=False)
class Point:
    curve: str
    panel: str  # which chart, mostly the scene
    series: str  # which line
    label: str  # beside the mark
    steps: list
    measure: object  # function(run: Run) -> dict of figures; "nrmse", "memory_bytes" ...
    join: bool = True  # is the series a curve, or just marks?
    name: str = ""

    def __post_init__(self):
        words = (re.sub("[^a-z0-9.]+", "_", w.lower()).strip("_") for w in (self.curve, self.panel, self.series, self.label))
        self.name = self.name or "/".join(words)


def digest(*parts):
    return hashlib.sha256("\0".join(str(p) for p in parts).encode()).hexdigest()[:20]


def machine():
    model = "unknown"
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                model = line.split(":", 1)[1].strip()
                break
    return {"cpu": model, "cores": os.cpu_count(), "memory_gib": round(
        os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30, 1), "system": platform.platform()}


class Runner:
    def __init__(self, ivory, folder, threads, any_build=False, quiet=False):
        self.ivory, self.folder, self.threads, self.any_build, self.quiet = ivory, folder, threads, any_build, quiet
        self.work = os.path.join(folder, "work")
        os.makedirs(self.work, exist_ok=True)
        self.log = os.path.join(folder, "results.jsonl")
        self.version = subprocess.run([ivory, "--version"], capture_output=True, text=True, check=True).stdout.strip()
        self.build = self._file_hash(ivory)
        self.machine = machine()
        self.failed = []  # (point's name, why)
        self._hashes = {}
        self.records = {}
        for record in self._read_log():
            self.records[record["key"]] = record  # the last one counts

    @staticmethod
    def _file_hash(path):
        h = hashlib.sha256()
        with open(path, "rb") as file:
            for block in iter(lambda: file.read(1 << 20), b""):
                h.update(block)
        return h.hexdigest()[:16]

    def _read_log(self):
        """Whole lines only: the last one may have been cut short."""
        if not os.path.exists(self.log):
            return
        with open(self.log, "rb") as file:
            data = file.read()
        whole = data[:data.rfind(b"\n") + 1]
        if len(whole) != len(data):
            with open(self.log, "r+b") as file:
                file.truncate(len(whole))
        for line in whole.splitlines():
            yield json.loads(line)

    def _write(self, record):
        self.records[record["key"]] = record
        with open(self.log, "a", encoding="utf-8") as file:
            file.write(json.dumps(record) + "\n")
            file.flush()
            os.fsync(file.fileno())

    def file_hash(self, file):
        if file.path not in self._hashes:
            if file.make and not os.path.exists(file.path):
                file.make()
            self._hashes[file.path] = self._file_hash(file.path)
        return self._hashes[file.path]

    def valid(self, key):
        """The record of that key, unless another build of ivory made it."""
        record = self.records.get(key)
        return record if record and (self.any_build or record["build"] == self.build) else None

    def key(self, step):
        # Threads change times, nothing else.
        parts = [self.version, step.threads or self.threads if step.timed else 0]
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

    def _once(self, words):
        """Result, wall seconds, CPU seconds and peak memory of one command."""
        with tempfile.TemporaryFile("w+") as errors:
            start = time.monotonic()
            process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=errors, text=True)
            try:
                out = process.stdout.read()
                _, status, usage = os.wait4(process.pid, 0)  # this child's own peak memory
                wall = time.monotonic() - start
                process.returncode = os.waitstatus_to_exitcode(status)
            except BaseException:
                process.kill()
                process.wait()
                raise
            if process.returncode != 0:
                errors.seek(0)
                raise Failure(f"{' '.join(words)}: {errors.read().strip() or f'ended with {process.returncode}'}")
        lines = [line for line in out.splitlines() if line.strip()]
        if lines and all(line.startswith("{") and line.endswith("}") for line in lines) and len(lines) > 1:
            return {"lines": [json.loads(line) for line in lines]}, wall, usage
        return (json.loads(out) if lines else {}), wall, usage

    def _run(self, step):
        for a in step.arguments:
            needed = a if isinstance(a, Step) else a[1] if isinstance(a, tuple) else None
            if needed is not None:
                self.result(needed, need_output=True)
        words = self.command(step)
        walls, seconds, cpu, peak, load = [], [], [], 0, os.getloadavg()[0]
        while True:
            result, wall, usage = self._once(words)
            walls.append(wall)
            cpu.append(usage.ru_utime + usage.ru_stime)
            seconds.append(result.get("seconds", wall))
            peak = max(peak, usage.ru_maxrss)
            if not step.timed or step.seconds == "once" or len(walls) == REPEATS or min(walls) > SHORT_S:
                break
        seed = next((b for a, b in zip(step.arguments, step.arguments[1:]) if a == "--seed"), SEED)
        return {"key": self.key(step), "kind": "step", "command": " ".join(words), "seed": seed, "machine": self.machine,
                "load": load, "version": self.version, "build": self.build, "wall_s": min(walls), "walls_s": walls,
                "cpu_s": min(cpu), "seconds": min(seconds), "peak_memory_bytes": peak * 1024, "result": result}

    def result(self, step, need_output=False):
        """The step's record; runs it where there is none, or where its output is wanted and gone."""
        record = self.valid(self.key(step))
        output = self.output(step)
        if record is None or (need_output and output and not os.path.exists(output)):
            record = self._run(step)
            self._write(record)
        return record

    def point_key(self, point):
        return digest("point", point.name, *(self.key(s) for s in point.steps))

    def point(self, point):
        """The point's record."""
        key = self.point_key(point)
        if self.valid(key) is None:
            steps = [self.result(s) for s in point.steps]
            figures = point.measure(Run(self, point, steps))
            timed = [(s, r) for s, r in zip(point.steps, steps) if s.timed]
            self._write({"key": key, "kind": "point", "curve": point.curve, "panel": point.panel, "series": point.series,
                         "label": point.label, "join": point.join, "name": point.name, "version": self.version, "build": self.build,
                         "machine": self.machine, "steps": [r["key"] for r in steps],
                         "commands": [r["command"] for _, r in timed] or [r["command"] for r in steps],
                         "time_s": sum(r["seconds"] if s.seconds == "result" else r["wall_s"] for s, r in timed),
                         "peak_memory_bytes": max((r["peak_memory_bytes"] for _, r in timed), default=0),
                         "load": max((r["load"] for _, r in timed), default=0), **figures})
        return self.records[key]

    def known(self, point):
        return self.valid(self.point_key(point)) is not None

    def is_done(self, point):
        try:
            return self.known(point)
        except (Failure, OSError):
            return False

    def points(self, points):
        """Records of all points that could be measured."""
        done, start = [], time.monotonic()
        new = sum(not self.is_done(p) for p in points)
        count = 0
        for p in points:
            try:
                if not self.known(p):
                    count += 1
                    if not self.quiet:
                        print(f"[{count}/{new}, {time.monotonic() - start:.0f} s] {p.name}", file=sys.stderr, flush=True)
                done.append(self.point(p))
            except (Failure, OSError) as failure:
                self.failed.append((p.name, str(failure)))
                print(f"failed: {p.name}: {failure}", file=sys.stderr, flush=True)
        return done


class Run:
    """What a point's measure() may ask."""

    def __init__(self, runner, point, records):
        self.runner, self.point, self.records = runner, point, records

    def result(self, step):
        return self.runner.result(step)["result"]

    def seconds(self, step):
        record = self.runner.result(step)
        return record["seconds"] if step.seconds == "result" else record["wall_s"]

    def output(self, step):
        self.runner.result(step, need_output=True)
        return self.runner.output(step)
