"""FOLDER/results.jsonl: what was measured, a record a line, only ever appended to."""
import fcntl
import json
import os
import sys

from process import Failure, Stop


def lock(folder):
    """Held by one measuring run a folder, until the file returned is closed."""
    try:
        file = open(os.path.join(folder, "lock"), "a", encoding="ascii")
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise Failure(f"{folder}: another ivory chart is measuring into it; wait for its end or choose another folder") from error
    except OSError as error:
        raise Failure(f"{folder}: cannot be written: {error.strerror}; choose another folder") from error
    return file


class Results:
    def __init__(self, folder):
        self.path = os.path.join(folder, "results.jsonl")
        self.records = {}  # by key; the last one counts
        data = b""
        if os.path.exists(self.path):
            with open(self.path, "rb") as file:
                data = file.read()
        self._whole = data.rfind(b"\n") + 1  # another run may be writing what follows, or have died of it
        damaged = sum(not self._take(line) for line in data[:self._whole].splitlines())
        if damaged:
            print(f"ivory: {self.path}: {damaged} damaged line{'s' if damaged > 1 else ''} left out; what they held is measured again",
                  file=sys.stderr)

    def _take(self, line):
        try:
            record = json.loads(line)
            self.records[record["key"]] = record
            return record["kind"] != ""
        except (ValueError, KeyError, TypeError):
            return False

    def trim(self):
        """Takes off the part of a line that an earlier run died of. For the holder of the lock."""
        if os.path.exists(self.path) and os.path.getsize(self.path) != self._whole:
            os.truncate(self.path, self._whole)

    def append(self, record):
        """All of it or, on a full disk, nothing."""
        line = (json.dumps(record, allow_nan=False) + "\n").encode()
        try:
            with open(self.path, "ab", buffering=0) as file:
                size = os.fstat(file.fileno()).st_size
                try:
                    while line:
                        line = line[file.write(line):]
                    os.fsync(file.fileno())
                except BaseException:
                    os.ftruncate(file.fileno(), size)
                    raise
        except OSError as error:
            raise Stop(f"{self.path}: cannot be written: {error.strerror}; the same command goes on once it can") from error
        self.records[record["key"]] = record
