#!/usr/bin/env python3
"""Holds docs/inputs.md to the code: its list of warnings, between <!-- warnings --> comments, is what the readers of
scenes and images can say.

usage: inputs.py [--write]     exit code 1 where the list is another; --write makes it anew
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/inputs.md"
ROOMS = {"glTF": "tracer/gltf", "cameras": "tracer/core/camera.cpp", "pictures": "grid/io", "bakes": "tools/bake",
         "renders": "tools/render/render.cpp", "units": "tools/input/units_hint.cpp",
         "hints of `ivory info`": "tools/input/hints.cpp"}
CALL = re.compile(r"\bwarn\(|\b(?:warnings|lines)\.(?:push_back|emplace_back)\(|(?:\breturn|\bhint =) fmt::format\(")
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')
# Parts of a call that name what a warning is about, but do not stand in its text.
LABEL = re.compile(r'\b(?:label|plural)\("[^"]*"')


def arguments(text, start):
    """What stands between the parenthesis that opens before `start` and the one that closes it."""
    depth, i = 1, start
    while depth:
        if text[i] == '"':
            i = LITERAL.match(text, i).end()
            continue
        depth += {"(": 1, ")": -1}.get(text[i], 0)
        i += 1
    return text[start:i - 1]


def warnings(path):
    """The constant text of every warning in a file, with an ellipsis for what varies."""
    text = path.read_text()
    for call in CALL.finditer(text):
        # Elsewhere such a line is an error's or a name.
        if call.group().startswith(("return", "hint")) and path.name not in ("camera.cpp", "hints.cpp", "units_hint.cpp"):
            continue
        joined = LABEL.sub("label(", re.sub(r'"\s*\n\s*"', "", arguments(text, call.end())))
        pieces = [literal.replace('\\"', '"') for literal in LITERAL.findall(joined)]
        message = re.sub(r"(\s*…\s*)+", " … ", "…" + "…".join(re.sub(r"\{[^}]*\}", "…", piece) for piece in pieces))
        message = message.strip(" …:,")
        if len(re.findall(r"[a-z]{3}", message)) > 4:
            yield message.replace("|", "\\|")


def listing():
    lines = []
    for room, place in ROOMS.items():
        folder = ROOT / place
        files = [folder] if folder.is_file() else sorted(folder.rglob("*.cpp"))
        said = sorted({message for file in files for message in warnings(file)}, key=str.lower)
        lines += ["", f"Of {room}:" if not room.startswith("hints") else f"{room[0].upper()}{room[1:]}:", ""]
        lines += [f"- … {message}" for message in said]
    return "\n".join(lines).strip("\n")


def main():
    page = PAGE.read_text()
    begin, end = "<!-- warnings -->\n", "\n<!-- /warnings -->"
    head, rest = page.split(begin)
    tail = rest.split(end)[1]
    made = head + begin + listing() + end + tail
    if "--write" in sys.argv[1:]:
        PAGE.write_text(made)
    elif made != page:
        sys.exit("docs/inputs.md: its list of warnings is not the code's; run tools/checks/inputs.py --write")


if __name__ == "__main__":
    main()
