"""The add-on from its zip: exports, bakes, stops and goes on, shows what it baked where it belongs, and says what went wrong."""

import math
import pathlib
import re
import subprocess

import bpy
import numpy as np
from mathutils import Vector

import support
from support import BlenderTest, box, ivory, lamp, material, mesh


class Addon(BlenderTest):
    def bounds(self, turn=0.0):
        """An empty, 3 x 2 x 1.5 m, inside the room."""
        made = bpy.data.objects.new("Bounds", None)
        made.empty_display_size = 1
        made.location, made.scale, made.rotation_euler = (3, -0.5, 1), (1.5, 1, 0.75), (0, 0, turn)
        self.scene.collection.objects.link(made)
        self.settings.bounds = made
        bpy.context.view_layer.update()
        return made

    def small_grid(self, photons="20k"):
        self.settings.grid_by, self.settings.resolution, self.settings.photons = "RESOLUTION", (7, 5, 4), photons

    def select(self, *names):
        for each in bpy.data.objects:
            each.select_set(each.name in names)

    def test_has_the_version_of_ivory(self):
        import ivory_blender
        project = (support.ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
        version = re.search(r"project\(ivory VERSION ([0-9.]+)", project).group(1)
        self.assertEqual(".".join(map(str, ivory_blender.bl_info["version"])), version)

    def test_exports_the_same_bytes_and_leaves_the_scene_as_it_was(self):
        support.room()
        self.bounds()
        lamp("AREA", (3, 0, 2.4), energy=10, size=0.5)
        self.scene.world = bpy.data.worlds.new("World")

        def state():
            return [sorted(each.name for each in data) for data in (bpy.data.objects, bpy.data.meshes, bpy.data.materials,
                                                                    bpy.data.scenes, bpy.data.cameras)]
        before = state()
        bpy.ops.ivory.export()
        self.assertEqual(state(), before)
        self.assertFalse(self.settings.bounds.hide_render)
        first = self.bytes_of(".glb"), self.bytes_of(".world.exr")
        bpy.ops.ivory.export()
        self.assertEqual((self.bytes_of(".glb"), self.bytes_of(".world.exr")), first)
        # A room and a crate of 12 triangles, and the area lamp of 2; the bounds are none.
        self.assertEqual(ivory("info", self.file(".glb"))["triangles"], 26)

    def test_a_mesh_as_bounds_is_no_part_of_the_scene(self):
        support.room()
        self.settings.bounds = box("Bounds", (2, -1, 0.5), (3, 0, 1), material("any", (1, 1, 1)))
        bpy.ops.ivory.export()
        self.assertEqual(ivory("info", self.file(".glb"))["triangles"], 24)

    def test_volume_lies_in_its_bounds(self):
        # Blender draws the box of a tree's leaves along the file's axes, from the first to the last of eight voxels: with
        # seven vertices a side that is their cells, and so what encloses the bounds.
        support.room()
        self.small_grid()
        self.settings.resolution = (7, 7, 7)
        for turn in (0, 0.5, math.pi / 2 - 0.2):
            holder = self.bounds(turn)
            bpy.ops.ivory.bake_grid()
            bpy.ops.ivory.import_grid()
            volume = bpy.data.objects["ivory grid"]
            bpy.context.view_layer.update()
            self.assertIn("I_px_r", volume.data.grids)
            self.assertEqual(len([each for each in bpy.data.objects if each.type == "VOLUME"]), 1)
            asked = [holder.matrix_world @ Vector((x, y, z)) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
            drawn = [volume.matrix_world @ Vector(corner) for corner in volume.bound_box]
            for end in (np.min, np.max):
                np.testing.assert_allclose(end(drawn, axis=0), end(asked, axis=0), atol=1e-5)  # of floats at 5 m
            # The cells' corners themselves, turned.
            voxels = volume.matrix_world @ volume.data.grids["I_px_r"].matrix_object
            cells = [voxels @ Vector((x, y, z)) for x in (0, 7) for y in (0, 7) for z in (0, 7)]
            for corner in asked:
                self.assertLess(min((corner - other).length for other in cells), 1e-5, (turn, cells, asked))
            bpy.data.objects.remove(holder)

    def test_light_is_what_ivory_says(self):
        support.room()
        self.small_grid()
        bpy.ops.ivory.bake_grid()
        before = self.bytes_of(".glb")
        self.select("Room", "Crate")
        for domain in ("POINT", "CORNER"):
            self.settings.domain = domain
            bpy.ops.ivory.light_on_objects()
            for name in ("Room", "Crate"):
                each = bpy.data.objects[name]
                attribute = each.data.color_attributes["ivory_E"]
                self.assertEqual((attribute.domain, attribute.data_type), (domain, "FLOAT_COLOR"))
                found = np.array([value.color[:3] for value in attribute.data])
                self.assertGreater(found.max(), 1)
                np.testing.assert_allclose(found, self.asked(each, domain), rtol=2e-5, atol=1e-5 * found.max())
        # Neither the attribute nor its material is part of the scene that is baked next.
        self.assertEqual(bpy.data.objects["Crate"].material_slots[0].material.name, "ivory light")
        bpy.ops.ivory.export()
        self.assertEqual(self.bytes_of(".glb"), before)
        bpy.ops.ivory.hide_light()
        self.assertEqual(bpy.data.objects["Crate"].material_slots[0].material.name, "crate")

    def asked(self, each, domain):
        """E where the attribute is, by ivory's own command on the same grid. Normals by their definition: the mean of a
        vertex's faces by their angles for vertices, which are three right ones here; a corner's face."""
        world = np.array(each.matrix_world)
        turn = np.linalg.inv(world[:3, :3]).T
        faces = [(face.vertices[:], np.array(face.normal)) for face in each.data.polygons]
        places = [np.array(vertex.co) for vertex in each.data.vertices]
        if domain == "CORNER":
            # A hundredth of the way to the face's middle: at the edge itself it would lie in other walls.
            middles = [sum(places[i] for i in vertices) / len(vertices) for vertices, _ in faces]
            pairs = [(0.99 * places[i] + 0.01 * middle, normal) for (vertices, normal), middle in zip(faces, middles)
                     for i in vertices]
        else:
            pairs = [(place, sum(normal for vertices, normal in faces if i in vertices)) for i, place in enumerate(places)]
        points = [world[:3, :3] @ place + world[:3, 3] for place, _ in pairs]
        normals = [(turn @ (normal / np.linalg.norm(normal))) for _, normal in pairs]
        normals = [normal / np.linalg.norm(normal) for normal in normals]
        return support.probe(self.file(".vdb"), points, normals, "--scene", self.file(".glb"))

    def test_path_traced_light_on_objects(self):
        mesh("Plane", [(x, y, 0) for y in (0, 1, 2) for x in (0, 1, 2)],
             [(0, 1, 4, 3), (1, 2, 5, 4), (3, 4, 7, 6), (4, 5, 8, 7)], material("white", (0.8, 0.8, 0.8)))
        lamp("POINT", (1, 1, 2), energy=100)
        self.settings.source, self.settings.units, self.settings.path_samples = "PATHS", "WATT", 4
        self.select("Plane")
        bpy.ops.ivory.light_on_objects()
        colours = bpy.data.meshes["Plane"].color_attributes["ivory_E"].data
        # I cos / d2, without noise; the outer vertices lie on the plane's edge.
        self.assertAlmostEqual(colours[4].color[0] / (100 / (4 * math.pi) / 4), 1, places=5)
        self.assertAlmostEqual(colours[5].color[0] / (100 / (4 * math.pi) * 2 / 5**1.5), 1, places=5)

    def test_shared_meshes_are_refused(self):
        support.room()
        twin = bpy.data.objects.new("Twin", bpy.data.meshes["Crate"])
        self.scene.collection.objects.link(twin)
        self.select("Crate")
        with self.assertRaisesRegex(RuntimeError, "mesh 'Crate' of object 'Crate' is shared"):
            bpy.ops.ivory.light_on_objects()

    def test_stops_and_goes_on(self):
        from ivory_blender import commands, run
        support.room()
        self.small_grid("2m")
        files = commands.files(self.settings)
        bpy.ops.ivory.export()
        command = commands.bake_grid(bpy.context, files["scene"], None, files["grid"], False)
        child = run.Child(command)
        self.assertFalse(child.wait(until=lambda child: child.progress.text.startswith("baking") and
                                    child.progress.fraction > 0.05), child.lines)
        self.assertRegex(child.progress.text, r"^baking: .* of 2 M photons, .*/s, [0-9:]+ left$")
        child.stop()
        child.wait()
        self.assertEqual(child.code, 143, child.lines)
        self.assertRegex(child.message(), "checkpoint")
        self.assertTrue(pathlib.Path(self.file(".checkpoint.vdb")).exists())
        bpy.ops.ivory.bake_grid()
        gone_on = self.bytes_of(".vdb")
        self.assertFalse(pathlib.Path(self.file(".checkpoint.vdb")).exists())
        bpy.ops.ivory.bake_grid()
        self.assertEqual(self.bytes_of(".vdb"), gone_on)

    def test_plan_bakes_nothing(self):
        support.room()
        self.settings.target_error = 20
        bpy.ops.ivory.bake_grid(dry_run=True)
        said = bpy.context.window_manager.ivory.said
        self.assertRegex(said, r"\d+ × \d+ × \d+ vertices, .* m apart\n[\d,]+ photons\nerror .* %")
        self.assertFalse(pathlib.Path(self.file(".vdb")).exists())

    def test_errors_are_ivorys_line(self):
        support.room()
        self.small_grid("many")
        with self.assertRaisesRegex(RuntimeError, "ivory: --photons: 'many' is not"):
            bpy.ops.ivory.bake_grid()
        self.small_grid()
        bpy.ops.ivory.bake_grid()
        self.settings.overwrite = False
        with self.assertRaisesRegex(RuntimeError, "ivory: .*level.vdb: already exists"):
            bpy.ops.ivory.bake_grid()
        self.assertFalse(bpy.context.window_manager.ivory.running)
        preferences = bpy.context.preferences.addons["ivory_blender"].preferences
        preferences.program = "/nowhere/ivory"
        with self.assertRaisesRegex(RuntimeError, "/nowhere/ivory: is no program"):
            bpy.ops.ivory.bake_grid()
        preferences.program = ""

    def test_job_bakes_the_same_bytes(self):
        support.room()
        self.small_grid()
        self.bounds(0.3)
        self.scene.world = bpy.data.worlds.new("World")
        self.settings.world_width = 64
        bpy.ops.ivory.bake_grid()
        bpy.ops.ivory.bake_sh9()
        baked = {extension: self.bytes_of(extension) for extension in (".vdb", ".sh9.json")}
        for extension in baked:
            pathlib.Path(self.file(extension)).unlink()
        bpy.ops.ivory.write_job()
        subprocess.run([support.IVORY, "batch", self.file(".toml"), "--quiet"], check=True)
        for extension, bytes_ in baked.items():
            self.assertEqual(self.bytes_of(extension), bytes_, extension)

    def test_lightmap_is_shown_the_right_way_up(self):
        plane = mesh("Plane", [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)], [(0, 1, 2, 3)], material("white", (0.8, 0.8, 0.8)))
        for name in ("UVMap", "Charts"):
            uv = plane.data.uv_layers.new(name=name)
            for i, corner in enumerate([(0.1, 0.1), (0.9, 0.1), (0.9, 0.9), (0.1, 0.9)]):
                uv.data[i].uv = corner
        lamp("POINT", (1.75, 0.5, 0.25), energy=10)
        self.small_grid("1k")
        self.settings.lightmap_size, self.settings.lightmap_samples, self.settings.lightmap_gather = 64, 4, 0
        self.settings.direct = False
        bpy.ops.ivory.bake_grid()
        bpy.ops.ivory.bake_lightmap()
        self.select("Plane")
        bpy.ops.ivory.show_lightmap()
        texture = next(node for node in plane.material_slots[0].material.node_tree.nodes if node.type == "TEX_IMAGE")
        image = texture.image
        texels = np.array(image.pixels[:]).reshape(64, 64, image.channels)[:, :, 0]
        brightest = np.unravel_index(texels.argmax(), texels.shape)  # (v, u), v upward as Blender has it
        # Below the lamp, at (1.75, 0.5) of 2 x 2 m in charts of 0.8.
        np.testing.assert_allclose((np.array(brightest) + 0.5) / 64, [0.1 + 0.8 * 0.25, 0.1 + 0.8 * 0.875], atol=1.5 / 64)

support.install()
support.main()
