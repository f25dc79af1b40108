#!/usr/bin/env python3
"""Runs the commands of documents as they are written: what stands in ``` blocks and begins with `ivory`.

usage: documents.py FOLDER PAGE...     each page in a folder of its own below FOLDER, with the repository's scenes in it

`cp` is run too. A line with an ellipsis stands for something else and is left out, as is a block below the comment
<!-- check: slow -->. A command that opens a window gets a display that nobody sees, and is stopped after a while.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
WINDOW_SECONDS = 15
LIMIT_SECONDS = 1800


def commands(page):
    """The page's commands, in order, with continued lines joined."""
    inside = slow = False
    command = ""
    for line in page.read_text().splitlines():
        if line.startswith("```"):
            inside = not inside and line.strip() == "```"
            slow = slow and inside
        elif not inside:
            slow = line.strip() == "<!-- check: slow -->" or (slow and not line.strip())
        else:
            command += line
            if command.endswith("\\"):
                command = command[:-1]
                continue
            if re.match(r"(ivory|cp) ", command) and "…" not in command:
                yield command, slow
            command = ""


def run(command, folder):
    """Its exit code, and what it printed."""
    window = command.startswith("ivory view") and "--headless" not in command
    if window:
        command = f"xvfb-run -a -s '-screen 0 1280x800x24' timeout {WINDOW_SECONDS} {command.split('#')[0]}"
    result = subprocess.run(["bash", "-c", command], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, timeout=LIMIT_SECONDS, check=False)
    return 0 if window and result.returncode == 124 else result.returncode, result.stdout


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    os.environ["PATH"] = f"{ROOT}/build/release:{os.environ['PATH']}"
    failed = 0
    for name in sys.argv[2:]:
        page = ROOT / name
        folder = pathlib.Path(sys.argv[1]) / page.stem
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        (folder / "scenes").symlink_to(ROOT / "scenes")
        for command, slow in commands(page):
            start = time.monotonic()
            code, output = (0, "") if slow else run(command, folder)
            failed += code != 0
            state = "slow, not run" if slow else "ok" if code == 0 else f"exit code {code}"
            print(f"{name}: {command}\n  {state}, {time.monotonic() - start:.0f} s", flush=True)
            if code != 0:
                print(output, flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
