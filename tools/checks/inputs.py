#!/usr/bin/env python3
"""Holds docs/inputs.md to the code: every warning that the readers of scenes and images give has a row there that quotes
it, and every row quotes a warning that there is.

usage: inputs.py
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
READERS = ("tracer/gltf", "grid/io", "tools/input", "tools/bake")
# Places where a warning is handed on, not made.
CALLS = re.compile(r"\bwarn\(|\bwarnings\.(?:push_back|emplace_back)\(|\blines\.(?:push_back|emplace_back)\(")
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')


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


def warnings():
    """(file, longest piece of constant text) of every warning."""
    for folder in READERS:
        for path in sorted((ROOT / folder).rglob("*.cpp")):
            text = path.read_text()
            for call in CALLS.finditer(text):
                joined = re.sub(r'"\s*\n\s*"', "", arguments(text, call.end()))
                pieces = [piece for literal in LITERAL.findall(joined) for piece in re.split(r"\{[^}]*\}", literal)]
                longest = max(pieces, key=len, default="").strip(" ,:;'")
                if len(longest) > 5:
                    yield path.relative_to(ROOT), longest


def main():
    page = (ROOT / "docs/inputs.md").read_text()
    flat = re.sub(r"\s+", " ", page)
    known = list(warnings())
    faults = [f"{path}: docs/inputs.md does not say: {text}" for path, text in known if text not in flat]
    quoted = re.findall(r"^\| `([^`]+)` \|", page, re.MULTILINE)
    sources = re.sub(r'"\s*\n\s*"', "", "\n".join(path.read_text() for folder in READERS
                                                   for path in sorted((ROOT / folder).rglob("*.cpp"))))
    for row in quoted:
        piece = max(row.split("…"), key=len).strip()
        if piece not in sources:
            faults.append(f"docs/inputs.md: no reader says: {row}")
    print("\n".join(faults) or f"{len(known)} warnings, {len(quoted)} rows")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
