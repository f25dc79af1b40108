"""Names of things by what they hold: files, scenes with all that they refer to, and the code that a curve's figures come from."""
import ast
import hashlib
import json
import os

from writer import gltf_file

FOLDER = os.path.dirname(os.path.abspath(__file__))


def digest(*parts):
    return hashlib.sha256("\0".join(str(p) for p in parts).encode()).hexdigest()[:20]


def file_hash(path):
    h = hashlib.sha256()
    with open(path, "rb") as file:
        for block in iter(lambda: file.read(1 << 20), b""):
            h.update(block)
    return h.hexdigest()[:16]


def input_hash(path):
    """Of what a file holds; of a glTF file also of the buffers and pictures that it refers to, wherever they lie."""
    if not path.endswith((".gltf", ".glb")):
        return file_hash(path)
    root, rest = gltf_file.read(path)
    named = list(gltf_file.external(root, os.path.dirname(path)))
    if not named:
        return file_hash(path)
    for entry, target in named:
        entry["uri"] = file_hash(target)
    return digest(json.dumps(root), hashlib.sha256(rest or b"").hexdigest())


def _definitions(module):
    """{name: syntax tree} of what a module beside this one defines or imports at its top; empty for any other module."""
    path = os.path.join(FOLDER, f"{module}.py")
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        tree = ast.parse(file.read())
    found = {}
    for node in tree.body:
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            found.update({alias.asname or alias.name: node for alias in node.names})
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found[node.name] = node
        else:
            found.update({n.id: node for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)})
    return found


def code_hash(module):
    """Of the code that a curve's figures depend on: `points`, and all in these scripts that it names, directly or not. How charts and
    tables are drawn does not count, nor do comments outside functions and places of lines."""
    modules, reached, waiting = {}, {}, [(module, "points")]
    while waiting:
        where, name = waiting.pop()
        if where not in modules:
            modules[where] = _definitions(where)
        node = modules[where].get(name)
        if node is None or (where, name) in reached:
            continue
        reached[where, name] = ast.dump(node)
        if isinstance(node, ast.ImportFrom):
            waiting.append((node.module, name))
        for part in ast.walk(node):
            if isinstance(part, ast.Name):
                waiting.append((where, part.id))
            elif isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name):
                waiting.append((part.value.id, part.attr))  # probes.errors
    return digest(*(f"{where}.{name} {reached[where, name]}" for where, name in sorted(reached)))
