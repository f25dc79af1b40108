"""Scenes, meshes and environments that the suites measure on: bundled, generated, or from sample data where that is at hand."""
import functools
import glob
import os
import subprocess
import sys

from hashing import digest, file_hash
from process import Failure
from steps import File
from writer import gltf_file
from writer.files import write_file
from writer.gltf import Gltf


def clamp(source, out):
    """A copy of a map without the values below zero that filtering left at sharp edges: no light is less than none."""
    # These files are compressed with losses, which bring values below zero back: the copy is not.
    part = out[:-4] + ".part.exr"
    try:
        subprocess.run(["oiiotool", source, "--ch", "R,G,B", "--maxc", "0", "-d", "float", "--compression", "zip", "-o", part],
                       check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise Failure(f"{source}: cannot be clamped at zero: {error}; install Debian's openimageio-tools") from error
    os.replace(part, out)


class Inputs:
    def __init__(self, source, made, kept=None):
        """source: ivory's source folder, with scenes/. made: the folder that gets what is generated. kept: one more folder where what
        takes long to generate may lie ready."""
        self.scenes = os.path.join(source, "scenes")
        self.made, self.folders = made, [f for f in (kept, made) if f]
        os.makedirs(made, exist_ok=True)
        self.data = os.environ.get("IVORY_DATA")
        self.skipped = []  # (what, why)
        self._ready = {}  # name of what takes long to generate: the folder where it lies

    def skip(self, what, why):
        if (what, why) not in self.skipped:
            self.skipped.append((what, why))

    def bundled(self, name):
        return os.path.join(self.scenes, name)

    def sample(self, name):
        """A file of the sample data, or None."""
        if not self.data:
            self.skip(name, "IVORY_DATA does not name a folder of sample data")
            return None
        path = os.path.join(self.data, name)
        if os.path.exists(path):
            return path
        self.skip(name, f"not found under {self.data} (IVORY_DATA)")
        return None

    def path(self, name):
        return os.path.join(self.made, name)

    @staticmethod
    def _stamp(folder, outputs, sources):
        """Of the sources, and of what they made; None where something is missing."""
        paths = [os.path.join(folder, o) for o in outputs]
        return digest(*sources, *map(file_hash, paths)) if all(map(os.path.exists, paths)) else None

    def _is_ready(self, name, outputs, sources):
        """Does a stamp NAME.stamp say that these very sources made the outputs just as they lie there?"""
        for folder in self.folders:
            stamp = os.path.join(folder, name + ".stamp")
            if name not in self._ready and os.path.exists(stamp):
                with open(stamp, encoding="ascii") as file:
                    if file.read() == self._stamp(folder, outputs, sources):
                        self._ready[name] = folder
        return name in self._ready

    def _make(self, name, outputs, sources, make):
        if not self._is_ready(name, outputs, sources):
            make()
            write_file(self.path(name + ".stamp"), self._stamp(self.made, outputs, sources) or "")
            self._ready[name] = self.made

    def _script(self, script, outputs, *arguments):
        """The folder with the outputs of a script in scenes/, or None."""
        mesh = "/usr/share/glmark2/models/bunny.obj"
        scripts = sorted(glob.glob(os.path.join(self.scenes, "**", "*.py"), recursive=True))
        sources = [*arguments, *map(file_hash, scripts),
                   file_hash(mesh) if os.path.exists(mesh) else "no mesh"]

        def make():
            done = subprocess.run([sys.executable, "-B", self.bundled(script), self.made, *arguments], capture_output=True, text=True)
            if done.returncode != 0:
                raise Failure(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"{script} failed")

        try:
            self._make(script, outputs, sources, make)
        except Failure as failure:
            self.skip(" and ".join(outputs), str(failure))
        return self._ready.get(script)

    def bunny_room(self):
        """A room with the Stanford bunny, and points on its surfaces; or None."""
        outputs = ("bunny_room.glb", "bunny_room_points.csv")
        folder = self._script("make_bunny_room.py", outputs, "--rotate", "30")
        return tuple(os.path.join(folder, o) for o in outputs) if folder else None

    def bunny(self, name="bunny.glb"):
        """bunny.glb alone, bunny_plane.glb, bunny_gloss.glb under a spherical light; or None."""
        folder = self._script("make_lobes_scenes.py", ("bunny.glb", "bunny_plane.glb", "bunny_gloss.glb"))
        return os.path.join(folder, name) if folder else None

    def occluder(self):
        return self.bunny() or self.bundled("knot.glb")

    def _clamped(self, source):
        """A map without negative values, made where it is first used."""
        name = os.path.basename(source)
        sources = [file_hash(source), "clamped at zero"]
        if self._is_ready(name, (name,), sources):
            return File(os.path.join(self._ready[name], name))
        return File(self.path(name), functools.partial(self._make, name, (name,), sources, functools.partial(clamp, source, self.path(name))))

    def environments(self, suite):
        """{name: File}: the bundled sky and those of the sample data; all that is at hand in the full suite."""
        found = {"sky": File(self.bundled("sky.hdr"))}
        for name in ("drachenfels_cellar", "studio_small_05", "noon_grass"):
            path = self.sample(f"env/{name}_1k.hdr")
            if path:
                found[name] = File(path)
        if suite != "full":
            return found
        blender = "/usr/share/blender/datafiles/studiolights/world"
        if os.path.isdir(blender):
            for name in sorted(os.listdir(blender)):
                if name.endswith(".exr"):
                    found[name[:-4]] = self._clamped(os.path.join(blender, name))
        else:
            self.skip("eight more environments", "Debian's package blender-data is not installed")
        return found

    def with_camera(self, path, name, eye, target, yfov_rad):
        """A copy of a scene with one more camera, first in line; what the scene refers to stays where it is."""
        root, rest = gltf_file.read(path)
        for entry, file in gltf_file.external(root, os.path.dirname(path)):
            entry["uri"] = gltf_file.uri(file, self.made)
        view = Gltf()
        view.camera("chart", eye, target, yfov_rad)
        root["cameras"] = view.root["cameras"] + root.get("cameras", [])
        for node in root["nodes"]:
            if "camera" in node:
                node["camera"] += 1
        root["nodes"].append(view.root["nodes"][0])
        root["scenes"][root.get("scene", 0)].setdefault("nodes", []).append(len(root["nodes"]) - 1)
        write_file(self.path(name), gltf_file.data(root, rest))
        return self.path(name)
