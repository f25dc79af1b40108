"""A glTF 2.0 writer that knows just what the bundled scenes need.

Materials are purely Lambertian (KHR_materials_specular with specularFactor 0). Positions are rounded
to 0.1 micrometre before they are stored as floats, so that the last bit of a platform's sine does not
show in the files.
"""
import base64
import json
import struct

from writer import gltf_file
from writer.files import write_file

FLOAT, UINT16, INT16, INT8 = 5126, 5123, 5122, 5120
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963


def as_float32(value, digits=7):
    """The nearest 32-bit float, as JSON must state it for min and max to hold exactly."""
    return struct.unpack("<f", struct.pack("<f", round(value, digits) + 0.0))[0]


class Gltf:
    def __init__(self, copyright_note=None):
        self.root = {"asset": {"version": "2.0", "generator": "ivory scenes/make_scenes.py"},
                     "scene": 0, "scenes": [{"nodes": []}], "nodes": []}
        if copyright_note:
            self.root["asset"]["copyright"] = copyright_note
        self.used = set()
        self.required = set()
        self.binary = bytearray()

    def _append(self, key, value):
        self.root.setdefault(key, []).append(value)
        return len(self.root[key]) - 1

    def _view(self, data, target, stride=None):
        while len(self.binary) % 4:
            self.binary.append(0)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data), "target": target}
        if stride:
            view["byteStride"] = stride
        self.binary += data
        return self._append("bufferViews", view)

    def _accessor(self, view, component, count, kind, normalized=False, low=None, high=None):
        accessor = {"bufferView": view, "componentType": component, "count": count, "type": kind}
        if normalized:
            accessor["normalized"] = True
        if low is not None:
            accessor["min"], accessor["max"] = low, high
        return self._append("accessors", accessor)

    def _vectors(self, vectors):
        flat = [[as_float32(x) for x in v] for v in vectors]
        view = self._view(b"".join(struct.pack("<3f", *v) for v in flat), ARRAY_BUFFER)
        low, high = [min(c) for c in zip(*flat)], [max(c) for c in zip(*flat)]
        return self._accessor(view, FLOAT, len(flat), "VEC3", low=low, high=high)

    def _quantized(self, vectors, component, scale):
        """Normalised integers, padded to four-byte alignment (KHR_mesh_quantization)."""
        limit, pattern, stride = (32767, "<3hxx", 8) if component == INT16 else (127, "<3bx", 4)
        ints = [[round(x / scale * limit) for x in v] for v in vectors]
        view = self._view(b"".join(struct.pack(pattern, *v) for v in ints), ARRAY_BUFFER, stride)
        low, high = [min(c) for c in zip(*ints)], [max(c) for c in zip(*ints)]
        return self._accessor(view, component, len(ints), "VEC3", True, low, high)

    def material(self, name, albedo, radiance=None):
        """albedo: linear Rec.709 reflectance; radiance: nits per channel, from the front side."""
        entry = {"name": name,
                 "pbrMetallicRoughness": {"baseColorFactor": [*albedo, 1.0], "metallicFactor": 0.0,
                                          "roughnessFactor": 1.0},
                 "extensions": {"KHR_materials_specular": {"specularFactor": 0.0}}}
        self.used.add("KHR_materials_specular")
        if radiance:
            strength = max(radiance)
            entry["emissiveFactor"] = [round(c / strength, 6) for c in radiance]
            entry["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
            self.used.add("KHR_materials_emissive_strength")
        return self._append("materials", entry)

    def mesh(self, name, pieces, materials, quantize_scale=None):
        """pieces: {material name: Piece}; materials: {material name: index}. quantize_scale stores
        position / quantize_scale as 16-bit integers; give the node that scale."""
        primitives = []
        for key, piece in pieces.items():
            assert len(piece.positions) <= 65535, "16-bit indices"
            attributes = {}
            if quantize_scale:
                attributes["POSITION"] = self._quantized(piece.positions, INT16, quantize_scale)
                attributes["NORMAL"] = self._quantized(piece.normals, INT8, 1.0)
                self.used.add("KHR_mesh_quantization")
                self.required.add("KHR_mesh_quantization")
            else:
                attributes["POSITION"] = self._vectors(piece.positions)
                if piece.normals:
                    attributes["NORMAL"] = self._vectors(piece.normals)
            indices = [i for triangle in piece.triangles for i in triangle]
            view = self._view(struct.pack(f"<{len(indices)}H", *indices), ELEMENT_ARRAY_BUFFER)
            primitives.append({"attributes": attributes, "material": materials[key],
                               "indices": self._accessor(view, UINT16, len(indices), "SCALAR")})
        return self._append("meshes", {"name": name, "primitives": primitives})

    def node(self, name, parent=None, **fields):
        index = self._append("nodes", {"name": name, **fields})
        siblings = (self.root["scenes"][0]["nodes"] if parent is None
                    else self.root["nodes"][parent].setdefault("children", []))
        siblings.append(index)
        return index

    def point_light(self, name, position, intensity_cd, parent=None):
        lights = self.root.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"name": name, "type": "point", "color": [1.0, 1.0, 1.0], "intensity": intensity_cd})
        self.used.add("KHR_lights_punctual")
        self.node(name, parent, translation=list(position),
                  extensions={"KHR_lights_punctual": {"light": len(lights) - 1}})

    def sun(self, name, direction, illuminance_lux, parent=None):
        """A directional light that shines along `direction`."""
        lights = self.root.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"name": name, "type": "directional", "color": [1.0, 1.0, 1.0], "intensity": illuminance_lux})
        self.used.add("KHR_lights_punctual")
        # Lights shine along -Z: the shortest turn from there is about (0, 0, -1) x direction.
        x, y, z = _unit(direction)
        q = _unit([y, -x, 0.0, 1.0 - z])
        self.node(name, parent, rotation=[round(c, 9) + 0.0 for c in q],
                  extensions={"KHR_lights_punctual": {"light": len(lights) - 1}})

    def camera(self, name, eye, target, yfov_rad, parent=None):
        """Looks from eye to target, +Y up."""
        back = _unit([e - t for e, t in zip(eye, target)])
        right = _unit([back[2], 0.0, -back[0]])  # (0,1,0) x back
        up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2],
              back[0] * right[1] - back[1] * right[0]]
        index = self._append("cameras", {"name": name, "type": "perspective",
                                         "perspective": {"yfov": round(yfov_rad, 7), "znear": 0.01}})
        axes = [round(x, 9) + 0.0 for axis in (right, up, back) for x in axis]
        matrix = axes[0:3] + [0.0] + axes[3:6] + [0.0] + axes[6:9] + [0.0] + list(eye) + [1.0]
        self.node(name, parent, camera=index, matrix=matrix)

    def save(self, path):
        if self.used:
            self.root["extensionsUsed"] = sorted(self.used)
        if self.required:
            self.root["extensionsRequired"] = sorted(self.required)
        while len(self.binary) % 4:
            self.binary.append(0)
        buffer = {"byteLength": len(self.binary)}
        if path.suffix == ".glb":
            write_file(path, gltf_file.data({**self.root, "buffers": [buffer]}, gltf_file.binary_chunk(self.binary)))
        else:
            buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
            text = json.dumps({**self.root, "buffers": [buffer]}, indent=1)
            write_file(path, text + "\n")


def _unit(v):
    length = sum(x * x for x in v) ** 0.5
    return [x / length for x in v]
