"""glTF files as their JSON and what follows it, and the files that they refer to."""
import json
import os
import struct
import urllib.parse


def read(path):
    """The JSON, and a GLB's chunks after it (None of a .gltf)."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:4] != b"glTF":
        return json.loads(data), None
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), data[20 + length:]


def data(root, rest):
    """The bytes of such a file."""
    text = json.dumps(root, separators=(",", ":")).encode()
    if rest is None:
        return text
    text += b" " * (-len(text) % 4)
    return b"glTF" + struct.pack("<IIII", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest


def binary_chunk(binary):
    """A GLB's second chunk; the length of `binary` is a multiple of four."""
    return struct.pack("<I", len(binary)) + b"BIN\0" + binary


def external(root, folder):
    """(entry with a "uri", the file's path) of buffers and images that lie in files; URIs are percent-encoded and relative to the folder."""
    for entry in root.get("buffers", []) + root.get("images", []):
        if "uri" in entry and not entry["uri"].startswith("data:"):
            yield entry, os.path.join(folder, urllib.parse.unquote(entry["uri"]))


def uri(path, folder):
    """How a glTF file in that folder refers to a file."""
    return urllib.parse.quote(os.path.relpath(path, folder))
