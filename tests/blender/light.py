"""The add-on's light: lamps, emission and the world arrive in ivory with the strength that Blender gives them."""

import math
import sys

import bpy
import numpy as np

import support
from support import BlenderTest, lamp, material, mesh

LUMENS_A_WATT = 683


class Light(BlenderTest):
    def setUp(self):
        super().setUp()
        # Alone in the world: nothing is lit by what it reflects.
        self.plane = mesh("Plane", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)],
                          material("white", (0.8, 0.8, 0.8)))

    def path_traced(self, samples=65536):
        """E in the middle of the plane, from above."""
        bpy.ops.ivory.export()
        world = ["--env", self.file(".world.exr")] if self.scene.world else []
        return support.probe(self.file(".glb"), [(0, 0, 0)], [(0, 0, 1)], "--samples", samples, *world)[0]

    def drawn_by_cycles(self):
        """The same, from what Cycles draws of the plane: pi / albedo times its radiance. By a node that is Lambert's, which
        that of exported materials is not in Cycles."""
        tree = self.plane.data.materials[0].node_tree
        lambert = tree.nodes.new("ShaderNodeBsdfDiffuse")
        lambert.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1)
        tree.links.new(lambert.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        camera = bpy.data.cameras.new("eye")
        camera.type, camera.ortho_scale = "ORTHO", 0.02
        eye = bpy.data.objects.new("eye", camera)
        # Aside, where it hides no lamp.
        eye.location, eye.rotation_euler = (1.5, 0, 1.5), (0, math.pi / 4, 0)
        self.scene.collection.objects.link(eye)
        scene = self.scene
        scene.camera, scene.render.engine = eye, "CYCLES"
        scene.cycles.samples, scene.cycles.use_denoising = 256, False
        scene.render.resolution_x = scene.render.resolution_y = 8
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
        scene.render.filepath = f"{self.folder}/drawn.exr"
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        texels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(texels)
        bpy.data.objects.remove(eye)
        return texels.reshape(-1, 4)[:, :3].mean(axis=0) * math.pi / 0.8

    def expect_light(self, closed_form, tolerance=0.003):
        """Both units, against the closed form in W/m2, and what Cycles draws. 0.3 %: the corners of round lamps, and four
        standard errors of 64 k paths to them. 2 %: the same of Cycles' 16 k."""
        for units, factor in (("WATT", 1), ("LUX", LUMENS_A_WATT)):
            self.settings.units = units
            np.testing.assert_allclose(self.path_traced() / factor, closed_form, rtol=tolerance)
        np.testing.assert_allclose(self.drawn_by_cycles(), closed_form, rtol=0.02)

    def test_point_lamp(self):
        lamp("POINT", (0.5, 0, 2), energy=100, color=(1, 0.5, 0.25), shadow_soft_size=0)
        squared = 0.5**2 + 2**2
        self.expect_light(100 / (4 * math.pi) * 2 / squared**1.5 * np.array([1, 0.5, 0.25]))

    def test_spot_lamp(self):
        lamp("SPOT", (0, 0, 2), energy=100, spot_size=1, shadow_soft_size=0)
        self.expect_light(np.full(3, 100 / (4 * math.pi) / 4))

    def test_sun(self):
        sun = lamp("SUN", (0, 0, 2), energy=3, angle=0)
        sun.rotation_euler = (1, 0, 0)
        self.expect_light(np.full(3, 3 * math.cos(1)))

    def test_area_lamp(self):
        # A disc of radius 0.5, radiance P / (4 A): E on its axis is pi L R2 / (R2 + d2).
        disc = lamp("AREA", (0, 0, 2), energy=100, shape="DISK", size=0.5)
        disc.scale = (2, 2, 2)
        self.expect_light(np.full(3, 100 / 4 / (0.5**2 + 2**2)))

    def test_square_area_lamp_of_another_side(self):
        # From below, its back: dark.
        square = lamp("AREA", (0, 0, 2), energy=100, size=0.4)
        self.assertGreater(self.path_traced(64)[0], 1)
        square.rotation_euler = (math.pi, 0, 0)
        bpy.context.view_layer.update()
        self.assertEqual(self.path_traced(64)[0], 0)

    def test_emission(self):
        ring = [(0.5 * math.cos(a), 0.5 * math.sin(a), 2) for a in np.linspace(0, -2 * math.pi, 96, endpoint=False)]
        mesh("Lamp", ring, [tuple(range(96))], material("glow", (0, 0, 0), 50))
        # 96 corners: 0.07 % less area.
        self.expect_light(np.full(3, math.pi * 50 * 0.25 / (0.25 + 4)))

    def test_world(self):
        # Of one channel each on Blender's +x, +y and +z: E(n) is pi (1 + n a) / 2 of each.
        world = bpy.data.worlds.new("World")
        world.use_nodes = True
        self.scene.world = world
        tree = world.node_tree
        back = tree.nodes["Background"]
        back.inputs["Strength"].default_value = 2
        place = tree.nodes.new("ShaderNodeTexCoord")
        split = tree.nodes.new("ShaderNodeSeparateXYZ")
        join = tree.nodes.new("ShaderNodeCombineXYZ")
        tree.links.new(place.outputs["Generated"], split.inputs[0])
        for axis in range(3):
            side = tree.nodes.new("ShaderNodeMath")
            side.operation = "GREATER_THAN"
            side.inputs[1].default_value = 0
            tree.links.new(split.outputs[axis], side.inputs[0])
            tree.links.new(side.outputs[0], join.inputs[axis])
        tree.links.new(join.outputs[0], back.inputs["Color"])
        self.settings.world_width = 256
        # Light or none with even odds: four standard errors of 64 k paths are 4 / 256.
        self.expect_light(2 * math.pi * np.array([0.5, 0.5, 1]), 4 / 256)

        normals = np.concatenate([np.eye(3), -np.eye(3)])
        self.settings.units = "WATT"
        bpy.ops.ivory.bake_sh9()
        exact = math.pi * (1 + normals)
        # The map's texels that the sides meet in are half lit: 0.1 %. Nine coefficients know these axes as well: of a
        # half sphere, bands 1 and 3 upward alone are not constant, and band 3 and all odd above weigh nothing in E.
        for asset, tolerance in ((".world.exr", 0.01), (".sh9.json", 0.01)):
            found = support.probe(self.file(asset), np.zeros((6, 3)), normals)
            np.testing.assert_allclose(found, exact, atol=tolerance * 2 * math.pi)

    def test_black_world_is_none(self):
        self.scene.world = bpy.data.worlds.new("World")
        self.scene.world.color = (0, 0, 0)
        lamp("POINT", (0, 0, 2), energy=100)
        bpy.ops.ivory.export()
        with self.assertRaises(FileNotFoundError):
            self.bytes_of(".world.exr")
        with self.assertRaisesRegex(RuntimeError, "no light to bake"):
            bpy.ops.ivory.bake_sh9()


support.install()
support.main()
