"""What drills have in common: the commands that write, and how an end of one is judged."""
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes"
BOX, KNOT, SKY = SCENES / "furnace_box.gltf", SCENES / "knot.glb", SCENES / "sky.hdr"
LIMIT_SECONDS = 300


class Writer:
    """A command that writes: its words without the output's, and the output's extension."""

    def __init__(self, name, words, extension):
        self.name, self.words, self.extension = name, [str(word) for word in words], extension
        self.old = self.new = b""  # contents before and after
        self.seconds = 0.0


def writers(folder, points):
    grid = ["bake", "grid", BOX, "--resolution", "4", "--photons", "2k"]
    return [Writer("bake grid", grid, ".vdb"),
            Writer("bake grid levels", grid + ["--levels", "2"], ".vdb"),
            Writer("bake grid to an error", grid + ["--target-error", "50%", "--error-points", points], ".vdb"),
            Writer("bake grid part", grid + ["--photon-range", "0:1k"], ".vdb"),
            Writer("merge", ["merge", folder / "a.vdb", folder / "b.vdb"], ".vdb"),
            Writer("mix", ["mix", folder / "groups.vdb", "--scale", "sky=0.5"], ".vdb"),
            Writer("bake sh9", ["bake", "sh9", SKY], ".json"),
            Writer("bake difmap", ["bake", "difmap", SKY, "--size", "4"], ".exr"),
            Writer("bake fiv", ["bake", "fiv", BOX, "--env", SKY, "--samples", "4,3,2", "--env-size", "2", "--parts", "1",
                                "--silhouette", "8"], ".exr"),
            Writer("bake cubemap", ["bake", "cubemap", BOX, "--at", "0,0,0", "--capture", "8", "--samples", "1"], ".exr"),
            Writer("bake lobes", ["bake", "lobes", "--exponent-nodes", "3", "--angle-nodes", "5", "--error-samples",
                                  "100"], ".exr"),
            Writer("bake spheres", ["bake", "spheres", BOX, "--count", "2", "--resolution", "16"], ".json"),
            Writer("render exr", ["render", BOX, "--size", "16x12", "--samples", "1"], ".exr"),
            Writer("render png", ["render", BOX, "--size", "16x12", "--samples", "1"], ".png"),
            Writer("probe", ["probe", folder / "whole.vdb", "--points", points], ".csv")]


class Bench:
    """The writers, what each wrote when nothing was in its way, and the counts of a run."""

    def __init__(self, ivory, folder, moments):
        # A copy, whatever is built meanwhile.
        self.ivory, self.folder, self.moments = str(shutil.copy2(ivory, folder)), folder, moments
        self.tried = self.damaged = self.misled = 0
        self.name = ""
        self.mounted = os.geteuid() == 0 and self.can_mount()
        part = ["bake", "grid", str(BOX), "--resolution", "4", "--photons", "2k"]
        self.points = folder / "points.csv"
        self.points.write_text("x,y,z,nx,ny,nz\n" + "".join(f"0,{i / 200},0,0,1,0\n" for i in range(100)))
        self.make(part + ["--photon-range", "0:1k", "-o", str(folder / "a.vdb")])
        self.make(part + ["--photon-range", "1k:2k", "-o", str(folder / "b.vdb")])
        self.make(part + ["-o", str(folder / "whole.vdb")])
        self.make(part + ["--env", str(SKY), "--groups", "sky=@environment", "-o", str(folder / "groups.vdb")])
        self.make(["bake", "difmap", str(SKY), "--size", "4", "-o", str(folder / "map.exr")])
        self.make(["bake", "sh9", str(SKY), "-o", str(folder / "map.json")])
        self.writers = writers(folder, self.points)
        for writer in self.writers:
            output = self.output(folder, writer)
            start = time.monotonic()
            self.make(writer.words + ["-o", str(output)])
            writer.seconds = time.monotonic() - start
            writer.new = output.read_bytes()
            writer.old = b"whole, and worth keeping " + writer.name.encode()
            output.unlink()

    def make(self, words):
        done = subprocess.run([self.ivory] + words, capture_output=True, text=True, check=False, timeout=LIMIT_SECONDS)
        if done.returncode != 0:
            sys.exit(f"ivory {' '.join(words)}: {done.stderr}")

    def can_mount(self):
        point = self.folder / "mount"
        point.mkdir()
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "ivory", point], capture_output=True, check=False)
        if done.returncode == 0:
            subprocess.run(["umount", point], check=True)
        return done.returncode == 0

    @staticmethod
    def output(folder, writer):
        return folder / f"out{writer.extension}"

    def fault(self, kind, writer_name, text):
        setattr(self, kind, getattr(self, kind) + 1)
        print(f"  {self.name}, {writer_name}: {text}", flush=True)

    def run(self, words, limits=(), **streams):
        """Exit code (negative: signal) and what stands on stderr."""
        def limit():
            for which, value in limits:
                resource.setrlimit(which, (value, value))
        streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE} | streams
        done = subprocess.run([self.ivory] + [str(word) for word in words], preexec_fn=limit if limits else None,
                              errors="replace", text=True, check=False, timeout=LIMIT_SECONDS, **streams)
        return done.returncode, done.stderr or ""

    def check_end(self, writer_name, code, said, names, may_work):
        """A failure must be exit code 1 and one line that holds one of `names`."""
        if code == 0:
            if not may_work:
                self.fault("misled", writer_name, "exit code 0")
        elif code != 1 or not said.startswith("ivory: ") or said.count("\n") != 1:
            self.fault("misled", writer_name, f"exit code {code}: {said.strip()[:300]}")
        elif not any(str(name) in said for name in names):
            self.fault("misled", writer_name, f"names no file: {said.strip()}")

    def check_file(self, writer, output, whole):
        """The output is the old file or, with `whole`, the new one; nothing else is there but hidden parts."""
        content = output.read_bytes() if output.exists() else None
        if content not in ([writer.old, writer.new] if whole else [writer.old]):
            size = "missing" if content is None else f"{len(content)} bytes"
            self.fault("damaged", writer.name, f"{output.name} is neither old nor new: {size}")

    def check_leftovers(self, writer, folder):
        left = [f.name for f in folder.iterdir() if ".part" in f.name]
        if left:
            self.fault("misled", writer.name, f"left behind: {' '.join(left)}")
