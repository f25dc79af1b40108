"""E at arrays of points: what `ivory probe` says, whatever the arrays look like."""

import csv
import unittest

import numpy as np

import ivory
from support import BOX, KNOT, MIDDLE, SKY, FolderTest, box, box_grid, command


def points(count=200):
    rng = np.random.default_rng(3)
    n = rng.normal(size=(count, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    return rng.uniform(0.05, 0.5, (count, 3)).astype(np.float32), n.astype(np.float32)


class LookUps(FolderTest):
    def probe(self, source, p, n, *options):
        """E by the command, and its standard errors."""
        table, out = self.folder / "p.csv", self.folder / "e.csv"
        np.savetxt(table, np.hstack([p, n]), "%.9g", ",", header="x,y,z,nx,ny,nz", comments="")
        command("probe", source, "--points", table, "-o", out, "--force", *options)
        with open(out, encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        number = lambda text: float(text) if text else np.nan
        return (np.array([[number(row[c]) for c in "rgb"] for row in rows]),
                np.array([[number(row[c + "_se"]) for c in "rgb"] for row in rows]))

    def expect_equal(self, ours, theirs):
        # Nine digits hold a float; the command's normals are made unit length again, which rounds them anew.
        np.testing.assert_allclose(ours, theirs, rtol=2e-5, atol=2e-5 * np.nanmax(theirs))

    def test_grid(self):
        path = self.folder / "box.vdb"
        box_grid().write(path)
        grid = ivory.read(path)
        p, n = points()
        e, error = self.probe(path, p, n)
        self.expect_equal(grid.irradiance(p, n), e)
        self.expect_equal(grid.standard_error(p, n), error)
        for options in ({"guard": "off"}, {"interpolation": "tricubic"}, {"interpolation": "fitted"},
                        {"reconstruction": "paper"}, {"nudge": 1.0}):
            flags = [text for name, value in options.items() for text in (f"--{name}", value)]
            self.expect_equal(grid.irradiance(p, n, **options), self.probe(path, p, n, *flags)[0])
        e, error = self.probe(path, p, n, "--scene", BOX)
        self.expect_equal(grid.irradiance(p, n, scene=box()), e)
        self.expect_equal(grid.standard_error(p, n, scene=box()), error)

    def test_all_other_assets(self):
        p, n = points()
        sky = ivory.Environment(SKY)
        exact = self.probe(SKY, p, n)[0]
        self.expect_equal(sky.irradiance(n, exact=True), exact)
        # The map has 64 rows: a hundredth of a texel's width along the horizon.
        np.testing.assert_allclose(sky.irradiance(n), exact, atol=1e-3 * exact.mean())
        table = ivory.Mesh(KNOT).bake_fiv(sky, samples=(8, 5, 4), env_size=8, parts=64, silhouette=32)
        cases = (("sky.json", sky.bake_sh9(), lambda asset: asset.irradiance(n)),
                 ("sky.exr", sky.bake_difmap(size=8), lambda asset: asset.irradiance(n)),
                 ("cube.exr", box().bake_cubemap(MIDDLE, capture=16), lambda asset: asset.irradiance(p, n)),
                 ("knot.exr", table, lambda asset: asset.hidden_irradiance(p * 4, n)))
        for name, asset, look_up in cases:
            path = self.folder / name
            asset.write(path)
            back = ivory.read(path)
            self.assertIs(type(back), type(asset))
            # A cube map's file holds distances, not depths: of numbers that cancel some last bits go.
            np.testing.assert_allclose(look_up(back), look_up(asset), rtol=1e-6, atol=1e-5, err_msg=name)
            self.expect_equal(look_up(asset), self.probe(path, p * 4 if name == "knot.exr" else p, n)[0])

    def test_paths(self):
        p, n = points(5)
        e, error = box().irradiance(p, n, samples=64, seed=3)
        theirs, their_error = self.probe(BOX, p, n, "--samples", 64, "--seed", 3)
        self.expect_equal(e, theirs)
        np.testing.assert_allclose(error, their_error, rtol=1e-3)

    def test_arrays_of_any_make(self):
        grid = box_grid()
        p, n = points()
        e = grid.irradiance(p, n)
        self.assertEqual((e.dtype, e.shape), (np.float32, p.shape))
        for other in (p.astype(np.float64), p.astype(np.float64).tolist(), np.asfortranarray(p),
                      np.repeat(p, 2, axis=0)[::2], p.astype(">f4")):
            np.testing.assert_array_equal(grid.irradiance(other, n), e)
        np.testing.assert_array_equal(grid.irradiance(p.reshape(10, 20, 3), n.reshape(10, 20, 3)).reshape(-1, 3), e)
        up = grid.irradiance(p, np.tile(np.float32([0, 1, 0]), (len(p), 1)))
        np.testing.assert_array_equal(grid.irradiance(p, (0, 1, 0)), up)
        np.testing.assert_array_equal(grid.irradiance(p[7], n[7]), e[7])
        np.testing.assert_array_equal(grid.irradiance(p[7], n), grid.irradiance(np.tile(p[7], (len(n), 1)), n))
        self.assertEqual(grid.irradiance(p[:0], n[:0]).shape, (0, 3))

    def test_arrays_that_cannot_be(self):
        p, n = points(4)
        nan = p.copy()
        nan[2, 1] = np.nan
        for bad_p, bad_n, name in ((p[:, :2], n, "p"), (nan, n, "p"), (p, n * 2, "n"), (p, n[:3], "n"), ("x", n, "p"),
                                   (p, [[1, 2], [3]], "n"), (p, n * np.nan, "n")):
            with self.assertRaisesRegex(ivory.ParameterError, f"^{name}: "):
                box_grid().irradiance(bad_p, bad_n)

    def test_numbers_in_place(self):
        grid = box().bake_grid(resolution=4, photons=20_000)
        moments = grid.moments
        self.assertEqual(moments.shape, (64, 12, 3))
        self.assertFalse(moments.flags.writeable)
        self.assertEqual(moments.__array_interface__["data"], grid.moments.__array_interface__["data"])
        total = moments.sum()
        del grid
        self.assertEqual(moments.sum(), total)  # the view keeps its grid

    def test_uniform_light(self):
        # A closed box whose walls all emit: E = pi L_e / (1 - albedo), scenes/README.md.
        scene = ivory.Scene(BOX.parent / "furnace_box.gltf")
        e, error = scene.irradiance((0, 0, 0), np.eye(3), samples=4096)
        self.assertTrue((np.abs(e - e.mean()) < 6 * error + 1e-6 * e).all())

    def test_groups(self):
        rooms = ivory.Scene(BOX.parent / "two_rooms.gltf", environment=SKY)
        grid = rooms.bake_grid(resolution=(4, 4, 8), photons=20_000, groups={"sky": ["@environment"]})
        self.assertEqual(grid.groups, ["sky", "rest"])
        p, n = points(20)
        all_light = grid.irradiance(p, n)
        parts = [grid.mix({"sky": s, "rest": 1 - s}).moments for s in (0, 1)]
        np.testing.assert_allclose(parts[0] + parts[1], grid.moments, rtol=1e-5, atol=1e-5 * grid.moments.max())
        np.testing.assert_array_equal(grid.mix({}).irradiance(p, n), all_light)
        with self.assertRaisesRegex(ivory.ParameterError, "^groups: "):
            grid.mix({"hall": 1})


if __name__ == "__main__":
    unittest.main()
