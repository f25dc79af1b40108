"""Long work: progress, ends before its time, errors, and Python going on meanwhile."""

import os
import signal
import sys
import threading
import unittest
import warnings

import numpy as np

import ivory
from support import BOX, KNOT, MIDDLE, SKY, FolderTest, box, box_grid

ENDLESS = 10_000_000_000  # photons, paths: hours of work


class Enough(Exception):
    pass


class Work(FolderTest):
    def test_progress(self):
        calls = []
        box().bake_grid(resolution=8, photons=400_000, progress=lambda stage, done: calls.append((stage, done)))
        self.assertEqual(calls[-1], ("baking", 1.0))
        self.assertTrue(all(0 <= done <= 1 for _, done in calls), calls)
        stages = [stage for stage, _ in calls]
        self.assertEqual(stages, sorted(stages, key=["pilot", "baking"].index))

    def test_what_progress_raises_ends_each_work(self):
        sky, knot = ivory.Environment(SKY), ivory.Mesh(KNOT)
        works = {
            "baking": lambda f: box().bake_grid(resolution=8, photons=ENDLESS, emission="bounds", progress=f),
            "capturing": lambda f: box().bake_cubemap(MIDDLE, capture=512, progress=f),
            "tracing": lambda f: box().irradiance(np.tile(MIDDLE, (10_000, 1)), (0, 1, 0), progress=f),
            "rendering": lambda f: box().render(progress=f),
            "fitting": lambda f: knot.bake_spheres(count=256, resolution=64, progress=f),
            "FIV": lambda f: knot.bake_fiv(sky, samples=(16, 9, 8), hemispheres=6, progress=f),
        }
        for name, work in works.items():
            def stop(stage, done):
                raise Enough(stage)
            with self.subTest(name), self.assertRaises(Enough):
                work(stop)

    def test_ctrl_c(self):
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            box().bake_grid(resolution=8, photons=ENDLESS)
        timer.join()

    def test_python_goes_on(self):
        # A bake that keeps Python's lock would never let this thread set `enough`, and would not end.
        started, enough = threading.Event(), threading.Event()
        outcome = []

        def progress(stage, done):
            started.set()
            if enough.is_set():
                raise Enough

        def bake():
            try:
                box().bake_grid(resolution=8, photons=ENDLESS, progress=progress)
            except Enough:
                outcome.append("ended")

        thread = threading.Thread(target=bake)
        thread.start()
        started.wait()
        box_grid().irradiance(MIDDLE, (0, 1, 0))  # meanwhile
        enough.set()
        thread.join()
        self.assertEqual(outcome, ["ended"])

    def test_look_ups_let_others_run(self):
        ticks, done = [0], threading.Event()

        def tick():
            while not done.wait(0.001):
                ticks[0] += 1

        thread = threading.Thread(target=tick)
        thread.start()
        p = np.tile(np.float32(MIDDLE), (1_000_000, 1))
        before = ticks[0]
        while ticks[0] < before + 3:  # lest it has not begun
            done.wait(0.001)
        before = ticks[0]
        box_grid().irradiance(p, (0, 1, 0), interpolation="fitted")
        after = ticks[0]
        done.set()
        thread.join()
        # Half a second of look-ups: a lock that is held lets no tick through.
        self.assertGreater(after, before + 2)

    def test_errors(self):
        scene, grid = box(), box_grid()
        grid.write(self.folder / "there.vdb")
        (self.folder / "not.vdb").write_text("no grid")
        cases = (
            (ivory.Error, "nowhere.glb", lambda: ivory.Scene("nowhere.glb")),
            (ivory.Error, "not.vdb: ", lambda: ivory.read(self.folder / "not.vdb")),
            (ivory.Error, "exists", lambda: grid.write(self.folder / "there.vdb")),
            (ivory.Error, "is a scene", lambda: ivory.read(BOX)),
            (ivory.Error, "backs of surfaces", lambda: scene.bake_cubemap((0, 1, 0), capture=16)),
            (ivory.ParameterError, "path: ", lambda: grid.write(self.folder / "grid.exr")),
            (ivory.ParameterError, "resolution: ", lambda: scene.bake_grid(resolution=1)),
            (ivory.ParameterError, "voxel_size: ", lambda: scene.bake_grid(voxel_size=-1)),
            (ivory.ParameterError, "basis: 'cubic'", lambda: scene.bake_grid(resolution=4, basis="cubic")),
            (ivory.ParameterError, "groups: ", lambda: scene.bake_grid(resolution=4, groups={"a": ["Nothing*"]})),
            (ivory.ParameterError, "target_error: ", lambda: scene.bake_grid(target_error=5)),
            (ivory.ParameterError, "target_error: ", lambda: scene.bake_grid(photons=5, max_time=3)),
            (ivory.ParameterError, "threads: ", lambda: scene.bake_grid(resolution=4, threads=-1)),
            (ivory.ParameterError, "grid: ", lambda: scene.render("direct")),
            (ivory.ParameterError, "guard: ", lambda: grid.irradiance(MIDDLE, (0, 1, 0), guard="rays")),
            (ivory.ParameterError, "window: ", lambda: ivory.Environment(SKY).bake_sh9(window="wide")),
            (ivory.ParameterError, "animation: ", lambda: ivory.Scene(BOX, animation="walk")),
            (TypeError, "incompatible", lambda: scene.bake_grid(resolution="fine")),
        )
        for kind, text, work in cases:
            with self.subTest(text), self.assertRaisesRegex(kind, text):
                work()
        self.assertTrue(issubclass(ivory.ParameterError, ValueError))
        self.assertTrue(issubclass(ivory.ParameterError, ivory.Error))
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["not.vdb", "there.vdb"])

    def test_warnings(self):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            grid = box().bake_grid(resolution=16, photons=1_000)
        self.assertEqual([str(warning.message) for warning in said], grid.warnings)
        self.assertIn("fewer than 8 photons", grid.warnings[0])
        self.assertIs(said[0].category, ivory.Warning)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaises(ivory.Warning):
                box().bake_grid(resolution=16, photons=1_000)

    def test_grids_saved_by_others(self):
        # No checksum: OpenVDB is tried in a process of its own, forked from one with many threads.
        path = self.folder / "box.vdb"
        box_grid().write(path)
        data = bytearray(path.read_bytes())
        data[21:57] = b"01234567-89ab-cdef-0123-456789abcdef"  # OpenVDB's random UUID in place of ivory's seal
        other = self.folder / "other.vdb"
        other.write_bytes(data)
        np.testing.assert_array_equal(ivory.read(other).moments, ivory.read(path).moments)
        data[2000:2100] = bytes(100)
        other.write_bytes(data)
        with self.assertRaisesRegex(ivory.Error, "other.vdb: "):
            ivory.read(other)


class Pictures(FolderTest):
    def test_methods_agree(self):
        grid = box().bake_grid(resolution=16, photons=1_000_000)
        options = {"width": 32, "height": 24, "samples": 64}
        path = box().render("path", **options)
        self.assertEqual((path.shape, path.dtype), ((24, 32, 3), np.float32))
        for method, most in (("direct", 0.05), ("gather", 0.05)):
            # A twentieth: 64 samples a pixel leave about a fiftieth of noise in a mean over 768 pixels' means.
            other = box().render(method, grid=grid, **options)
            self.assertLess(abs(other.mean() / path.mean() - 1), most, method)

    def test_cameras(self):
        first = box().render(width=16, height=12, samples=4)
        np.testing.assert_array_equal(box().render(width=16, height=12, samples=4, camera=0), first)
        np.testing.assert_array_equal(box().render(width=16, height=12, samples=4, camera=box().cameras[0]), first)
        # Down onto the red wall from the box's middle: more red than green.
        side = ivory.Camera(MIDDLE, (2, 0.27, 0.28), fov=40)
        picture = box().render(width=16, height=16, samples=16, camera=side).mean(axis=(0, 1))
        other = box().render(width=16, height=16, samples=16, camera=ivory.Camera(MIDDLE, (-2, 0.27, 0.28), fov=40))
        ratio = (picture[0] / picture[1]) / (other.mean(axis=(0, 1))[0] / other.mean(axis=(0, 1))[1])
        self.assertTrue(ratio > 4 or ratio < 0.25, ratio)
        with self.assertRaisesRegex(ivory.ParameterError, "^target: "):
            ivory.Camera(MIDDLE, MIDDLE)

    def test_files(self):
        rng = np.random.default_rng(2)
        picture = rng.uniform(0, 4, (12, 16, 3)).astype(np.float32)
        path = self.folder / "picture.exr"
        ivory.write_image(path, picture)
        np.testing.assert_array_equal(ivory.read_image(path), picture)
        with self.assertRaisesRegex(ivory.Error, "exists"):
            ivory.write_image(path, picture)
        ivory.write_image(self.folder / "picture.png", picture, exposure=-1)
        shown = ivory.read_image(self.folder / "picture.png")
        np.testing.assert_allclose(shown, ivory.display(picture, exposure=-1), atol=0.51 / 255)
        with self.assertRaisesRegex(ivory.ParameterError, "^pixels: "):
            ivory.display(picture[:, :, :2])


if __name__ == "__main__":
    unittest.main()
