"""The JSON of a .glb file, read and written."""

import json
import struct

_MAGIC = 0x46546C67
_JSON = 0x4E4F534A


def read(path):
    """(document, all bytes behind its chunk)."""
    with open(path, "rb") as file:
        data = file.read()
    magic, _, _, length, kind = struct.unpack_from("<5I", data)
    assert magic == _MAGIC and kind == _JSON, path
    return json.loads(data[20:20 + length]), data[20 + length:]


def write(path, document, rest):
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<5I", _MAGIC, 2, 20 + len(text) + len(rest), len(text), _JSON) + text + rest)


def scale_emission(document, factor):
    """Multiplies what materials emit. glTF holds factors of at most 1 and a strength."""
    for material in document.get("materials", []):
        if not any(material.get("emissiveFactor", [0, 0, 0])):
            continue
        extension = material.setdefault("extensions", {}).setdefault("KHR_materials_emissive_strength", {})
        extension["emissiveStrength"] = extension.get("emissiveStrength", 1.0) * factor
        used = document.setdefault("extensionsUsed", [])
        if "KHR_materials_emissive_strength" not in used:
            used.append("KHR_materials_emissive_strength")


def drop_extras(document):
    """What the add-on itself keeps in a scene and its objects is not part of what is baked."""
    for each in document.get("scenes", []) + document.get("nodes", []):
        extras = {key: value for key, value in each.pop("extras", {}).items() if key not in {"ivory", "ivory_file"}}
        if extras:
            each["extras"] = extras
