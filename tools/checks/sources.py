#!/usr/bin/env python3
"""Every .cpp file is built by the CMakeLists.txt of its floor: a test that nobody compiles tests nothing.

usage: sources.py     prints what is forgotten, and exits with 1
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    forgotten = []
    lists = [path for path in ROOT.rglob("CMakeLists.txt") if "build" not in path.relative_to(ROOT).parts]
    named = {(path.parent / word).resolve() for path in lists for word in re.findall(r"[\w./-]+\.cpp\b", path.read_text())}
    for floor in ("grid", "tracer", "runtime", "tools", "tests"):
        for source in sorted((ROOT / floor).rglob("*.cpp")):
            own = source.parent / "CMakeLists.txt"  # may go through names without their endings
            if source not in named and not (own.exists() and re.search(rf"\b{source.stem}\b", own.read_text())):
                forgotten.append(str(source.relative_to(ROOT)))
    for source in forgotten:
        print(f"{source}: no CMakeLists.txt names it; add it, or remove it")
    sys.exit(1 if forgotten else 0)


if __name__ == "__main__":
    main()
