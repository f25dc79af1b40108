"""ivory's program as a child process that nobody waits for: what it says, how far it is, how it ended. No bpy here."""

import atexit
import dataclasses
import errno
import json
import os
import pty
import re
import subprocess
import tempfile
import time


class Failure(Exception):
    """What a person is told in one line."""


@dataclasses.dataclass
class Progress:
    text: str = ""      # "baking: 12.3 M of 64 M photons, 1.2 M/s, 0:43 left"
    fraction: float = 0


_PROGRESS = re.compile(r"^[a-z ]+: ([0-9.]+)( [kMGT])? of ([0-9.]+)( [kMGT])? [a-z]+(?:, .* left)?$")
_UNITS = {None: 1.0, " k": 1e3, " M": 1e6, " G": 1e9, " T": 1e12}
_END = re.compile(r"\r|\n|\x1b\[K")

STOPPED = (130, 143)  # exit codes after SIGINT and SIGTERM

_running = set()


class Child:
    """One run of ivory. poll() as often as you like until it is true; then code, result() and message()."""

    def __init__(self, command):
        self.command = [str(word) for word in command]
        self.progress = Progress()
        self.lines = []   # what it said on stderr, progress apart
        self.code = None  # exit code, from the end on
        self.asked_to_stop = False
        self._tail = ""
        self._out = tempfile.TemporaryFile()
        # Progress is drawn where stderr is a terminal.
        self._terminal, theirs = pty.openpty()
        try:
            self._process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL, stdout=self._out, stderr=theirs)
        except OSError as error:
            os.close(self._terminal)
            self._out.close()
            raise Failure(f"{self.command[0]}: cannot be run ({error.strerror}); choose ivory's program in the add-on's "
                          "preferences") from error
        finally:
            os.close(theirs)
        os.set_blocking(self._terminal, False)
        _running.add(self)

    def poll(self):
        """Reads what was said; true when it has ended. Never blocks."""
        if self.code is not None:
            return True
        ended = self._process.poll()
        self._read()  # after that, so that the last words are among it
        if ended is None:
            return False
        self._take(_END.split(self._tail))
        self.code = ended if ended >= 0 else 128 - ended
        os.close(self._terminal)
        self._out.seek(0)
        self._stdout = self._out.read().decode("utf-8", "replace")
        self._out.close()
        _running.discard(self)
        return True

    def wait(self, until=lambda child: False):
        """Blocks to its end, or until `until` is true of it; is it at its end?"""
        while not self.poll():
            if until(self):
                return False
            time.sleep(0.02)
        return True

    def stop(self):
        """SIGTERM: a grid leaves its checkpoint first, and the same command goes on from there."""
        self.asked_to_stop = True
        if self.code is None and self._process.poll() is None:
            self._process.terminate()

    def leave(self):
        """stop(), for who will not poll() any more."""
        self.stop()
        _running.discard(self)

    def result(self):
        """The JSON object that a command prints, {} where it printed none."""
        return json.loads(self._stdout) if self.code == 0 and self._stdout.strip() else {}

    def stdout(self):
        return self._stdout

    def message(self):
        """ivory's own line on what went wrong."""
        for line in reversed(self.lines):
            if line.startswith("ivory: "):
                return line
        if self.code in STOPPED:
            return "ivory: stopped" + ("; " + self.lines[-1] if self.lines else "")
        return f"ivory: ended with exit code {self.code}" + (": " + self.lines[-1] if self.lines else "")

    def _read(self):
        while True:
            try:
                data = os.read(self._terminal, 65536)
            except BlockingIOError:
                break
            except OSError as error:
                if error.errno == errno.EIO:  # nobody has the other end any more
                    break
                raise
            if not data:
                break
            self._tail += data.decode("utf-8", "replace")
        *whole, self._tail = _END.split(self._tail)
        self._take(whole)

    def _take(self, texts):
        for text in texts:
            match = _PROGRESS.match(text)
            if match:
                done, done_unit, total, total_unit = match.groups()
                whole = float(total) * _UNITS[total_unit]
                part = float(done) * _UNITS[done_unit]
                self.progress = Progress(text, min(1.0, part / whole) if whole > 0 else 0.0)
            elif text.strip():
                self.lines.append(text.strip())


def busy():
    """Is one running whose end nobody has seen?"""
    return bool(_running)


def stop_all():
    """At Blender's end: grids leave their checkpoints."""
    for child in list(_running):
        child.stop()
    for child in list(_running):
        child.wait()


atexit.register(stop_all)
