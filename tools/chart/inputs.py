"""Scenes, meshes and environments that the suites measure on: bundled, generated, or from sample data where that is at hand."""
import functools
import json
import os
import struct
import subprocess
import sys

from runner import Failure, File


def clamp(path, out):
    """A copy of a map without the values below zero that filtering left at sharp edges: no light is less than none."""
    # These files are compressed with losses, which bring values below zero back: the copy is not.
    part = out[:-4] + ".part.exr"
    try:
        subprocess.run(["oiiotool", path, "--ch", "R,G,B", "--maxc", "0", "-d", "float", "--compression", "zip", "-o", part],
                       check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise Failure(f"{path}: cannot be clamped at zero: {error}; install Debian's openimageio-tools") from error
    os.replace(part, out)


class Inputs:
    def __init__(self, source, folder):
        """source: ivory's source folder, with scenes/."""
        self.scenes = os.path.join(source, "scenes")
        self.made = os.path.join(folder, "scenes")
        os.makedirs(self.made, exist_ok=True)
        self.data = os.environ.get("IVORY_DATA", os.path.join(os.path.dirname(source), "shared", "data"))
        self.skipped = []  # (what, why)
        sys.path.insert(0, self.scenes)

    def skip(self, what, why):
        if (what, why) not in self.skipped:
            self.skipped.append((what, why))

    def bundled(self, name):
        return os.path.join(self.scenes, name)

    def sample(self, name):
        """A file of the sample data, or None."""
        path = os.path.join(self.data, name)
        if os.path.exists(path):
            return path
        self.skip(name, f"not found under {self.data} (IVORY_DATA)")
        return None

    def path(self, name):
        return os.path.join(self.made, name)

    def _script(self, script, needed, *arguments):
        if all(os.path.exists(self.path(n)) for n in needed):
            return True
        done = subprocess.run([sys.executable, os.path.join(self.scenes, script), self.made, *arguments],
                              capture_output=True, text=True)
        if done.returncode != 0:
            self.skip(" and ".join(needed), done.stderr.strip().splitlines()[-1] if done.stderr.strip() else script)
        return done.returncode == 0

    def bunny_room(self):
        """A room with the Stanford bunny, and points on its surfaces; or None."""
        found = self._script("make_bunny_room.py", ("bunny_room.glb", "bunny_room_points.csv"), "--rotate", "30")
        return (self.path("bunny_room.glb"), self.path("bunny_room_points.csv")) if found else None

    def bunny(self, name="bunny.glb"):
        """bunny.glb alone, bunny_plane.glb, bunny_gloss.glb under a ball of light; or None."""
        return self.path(name) if self._script("make_lobes_scenes.py", (name,)) else None

    def occluder(self):
        return self.bunny() or self.bundled("knot.glb")

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
                    source, out = os.path.join(blender, name), self.path(name)
                    found[name[:-4]] = File(out, functools.partial(clamp, source, out))
        else:
            self.skip("eight more environments", "Debian's package blender-data is not installed")
        return found

    def with_camera(self, path, name, eye, target, yfov_rad):
        """A copy of a scene with one more camera, first in line; what the scene refers to stays where it is."""
        from gltf_writer import Gltf
        out = self.path(name)
        if os.path.exists(out):
            return out
        with open(path, "rb") as file:
            data = file.read()
        if data[:4] == b"glTF":
            length = struct.unpack_from("<I", data, 12)[0]
            root, rest = json.loads(data[20:20 + length]), data[20 + length:]
        else:
            root, rest = json.loads(data), b""
            for entry in root.get("buffers", []) + root.get("images", []):
                if "uri" in entry and not entry["uri"].startswith("data:"):
                    entry["uri"] = os.path.relpath(os.path.join(os.path.dirname(path), entry["uri"]), self.made)
        view = Gltf()
        view.camera("chart", eye, target, yfov_rad)
        root["cameras"] = view.root["cameras"] + root.get("cameras", [])
        for node in root["nodes"]:
            if "camera" in node:
                node["camera"] += 1
        root["nodes"].append(view.root["nodes"][0])
        root["scenes"][root.get("scene", 0)].setdefault("nodes", []).append(len(root["nodes"]) - 1)
        text = json.dumps(root, separators=(",", ":")).encode()
        if rest:
            text += b" " * (-len(text) % 4)
            text = b"glTF" + struct.pack("<IIII", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest
        with open(out + ".part", "wb") as file:
            file.write(text)
        os.replace(out + ".part", out)
        return out
