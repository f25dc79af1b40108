"""Each asset that Python bakes is, to the byte, what the command bakes."""

import unittest

import ivory
from support import BOX, KNOT, MIDDLE, SCENES, SKY, FolderTest, box, box_grid


class SameBytes(FolderTest):
    def test_grid(self):
        self.expect_same_bytes(box_grid(), "grid", BOX, "--resolution", 8, "--photons", "100k")

    def test_grid_with_all_that_may_be_asked(self):
        rooms = ivory.Scene(SCENES / "two_rooms.gltf", environment=SKY, scale=0.5, portable=True)
        grid = rooms.bake_grid(bounds=((-1, 0, -1), (1, 1, 1)), rotate_y=20, voxel_size=0.25, levels=2,
                               dynamic=[((-0.5, 0, -0.5), (0.5, 1, 0.5))], photons=50_000, bounces=20,
                               groups={"sky": ["@environment"]}, direct=["sky"], emission="bounds", basis="sh9",
                               guard="planes", seed=7)
        self.expect_same_bytes(
            grid, "grid", SCENES / "two_rooms.gltf", "--env", SKY, "--scale", 0.5, "--bounds", "-1,0,-1:1,1,1",
            "--rotate-y", 20, "--voxel-size", 0.25, "--levels", 2, "--dynamic", "-0.5,0,-0.5:0.5,1,0.5", "--photons",
            "50k", "--bounces", 20, "--groups", "sky=@environment", "--direct-of", "sky", "--emission", "bounds",
            "--basis", "sh9", "--guard", "planes", "--seed", 7, "--portable")

    def test_grid_to_an_error(self):
        grid = box().bake_grid(target_error=0.3)
        self.assertEqual(grid.certificate["target"], 0.3)
        self.assertLessEqual(grid.certificate["low"], grid.certificate["error"])
        self.expect_same_bytes(grid, "grid", BOX, "--target-error", 0.3)

    def test_cube_map(self):
        at = ",".join(map(str, MIDDLE))
        cube = box().bake_cubemap(MIDDLE, size=2, capture=32, samples=4)
        self.expect_same_bytes(cube, "cubemap", BOX, "--at", at, "--size", 2, "--capture", 32, "--samples", 4)

    def test_cube_map_by_a_grid(self):
        path = self.folder / "box.vdb"
        box_grid().write(path)
        cube = box().bake_cubemap(MIDDLE, capture=32, samples=4, grid=ivory.Grid.read(path))
        self.expect_same_bytes(cube, "cubemap", BOX, "--at", ",".join(map(str, MIDDLE)), "--capture", 32, "--samples",
                               4, "--grid", path)

    def test_distant_light(self):
        sky = ivory.Environment(SKY)
        self.expect_same_bytes(sky.bake_difmap(size=8), "difmap", SKY, "--size", 8)

    def test_nine_coefficients(self):
        sky = ivory.Environment(SKY)
        self.expect_same_bytes(sky.bake_sh9(order=2, window=3.5), "sh9", SKY, "--order", 2, "--window", 3.5)

    def test_occluder_table(self):
        table = ivory.Mesh(KNOT, portable=True).bake_fiv(ivory.Environment(SKY), samples=(8, 5, 4), hemispheres=6, env_size=8,
                                                parts=64, farthest=4, silhouette=32)
        self.expect_same_bytes(table, "fiv", KNOT, "--env", SKY, "--samples", "8,5,4", "--hemispheres", 6,
                               "--env-size", 8, "--parts", 64, "--farthest", 4, "--silhouette", 32, "--portable")

    def test_spheres(self):
        spheres = ivory.Mesh(KNOT).bake_spheres(count=8, resolution=16)
        self.expect_same_bytes(spheres, "spheres", KNOT, "--count", 8, "--resolution", 16)

    def test_lobes(self):
        table = ivory.bake_lobes(exponent_nodes=5, angle_nodes=9, error_samples=1000)
        self.expect_same_bytes(table, "lobes", "--exponent-nodes", 5, "--angle-nodes", 9, "--error-samples", 1000)


if __name__ == "__main__":
    unittest.main()
