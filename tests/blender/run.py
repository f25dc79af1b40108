"""Runs one of the scripts beside it in Blender, with the add-on's zip and nobody's preferences. Exit code 77: skipped.

usage: run.py SCRIPT.py      environment: IVORY, the program; ADDON, the zip
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

here = pathlib.Path(__file__).resolve().parent
script = here / sys.argv[1]
in_window = "# in a window" in script.read_text().splitlines()[:3]

command = [shutil.which("blender")]
if command[0] is None:
    print("skipped: no Blender here (Debian package blender)")
    sys.exit(77)
if in_window:
    if shutil.which("xvfb-run") is None:
        print("skipped: no display that nobody sees here (Debian package xvfb)")
        sys.exit(77)
    command = ["xvfb-run", "-a", "-s", "-screen 0 900x600x24"] + command + ["--enable-event-simulate",
                                                                              "--window-geometry", "0", "0", "900", "600"]
else:
    command.append("-b")
command += ["--factory-startup", "-noaudio", "--python-exit-code", "1", "--python", str(script)]

# Debian's Python first: Blender takes its modules from where the first python3 of the PATH is.
path = os.pathsep.join([str(pathlib.Path(os.environ["IVORY"]).parent), "/usr/bin", os.environ["PATH"]])
with tempfile.TemporaryDirectory() as folder:
    environment = dict(os.environ, BLENDER_USER_SCRIPTS=f"{folder}/scripts", BLENDER_USER_CONFIG=f"{folder}/config",
                       HOME=folder, FOLDER=folder, LIBGL_ALWAYS_SOFTWARE="1", PYTHONDONTWRITEBYTECODE="1",
                       PYTHONPATH=str(here), PATH=path)
    sys.exit(subprocess.run(command, env=environment, check=False).returncode)
