"""What the tests of the Python package share: the command beside it, small bakes, and a folder of their own."""

import functools
import os
import pathlib
import subprocess
import tempfile
import unittest

import ivory

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes"
BOX = SCENES / "cornell_box.gltf"
SKY = SCENES / "sky.hdr"
KNOT = SCENES / "knot.glb"
MIDDLE = (0.28, 0.27, 0.28)  # of the box, in the open


def command(*arguments):
    """Runs ivory; what it prints."""
    result = subprocess.run([os.environ["IVORY"], *map(str, arguments)], stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, check=False)
    assert result.returncode == 0, f"{arguments}: {result.stdout}"
    return result.stdout


@functools.lru_cache
def box():
    return ivory.Scene(BOX)


@functools.lru_cache
def box_grid():
    return box().bake_grid(resolution=8, photons=100_000)


class FolderTest(unittest.TestCase):
    """Each test has a folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def expect_same_bytes(self, asset, *bake):
        """That the asset's file is the one that the command bakes."""
        suffix = {"grid": ".vdb", "sh9": ".json", "spheres": ".json"}.get(bake[0], ".exr")
        ours, theirs = self.folder / f"ours{suffix}", self.folder / f"theirs{suffix}"
        asset.write(ours)
        command("bake", *bake, "-o", theirs)
        self.assertEqual(ours.read_bytes(), theirs.read_bytes(), bake)
