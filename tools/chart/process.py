"""Runs one command: its result, time and memory, and what others took of the processors meanwhile."""
import dataclasses
import json
import os
import shlex
import subprocess
import tempfile
import time

TICK_S = 1 / os.sysconf("SC_CLK_TCK")


class Failure(Exception):
    """What went wrong, in a line."""


class Stop(Exception):
    """What makes going on senseless, in a line."""


@dataclasses.dataclass
class Outcome:
    output: str
    wall_s: float
    cpu_s: float
    peak_memory_bytes: int
    foreign: object  # processor time of others while it ran, as a share of one core; None where the system does not tell
    complaint: str = ""  # why it failed although it gave a result

    def result(self):
        """The JSON object that it printed."""
        return json.loads(self.output) if self.output.strip() else {}


def busy_s():
    """Seconds that all processors together were busy since the system started; None where /proc/stat does not say."""
    try:
        with open("/proc/stat", encoding="ascii") as file:
            user, nice, system, _, _, irq, softirq, steal = (int(x) for x in file.readline().split()[1:9])
    except (OSError, ValueError):
        return None
    return TICK_S * (user + nice + system + irq + softirq + steal) or None


def foreign_share(before_s, after_s, own_s, wall_s):
    if before_s is None or after_s is None:
        return None
    # Time is counted in ticks: two of them, one at either end, say nothing.
    return max(0.0, after_s - before_s - own_s - 2 * TICK_S) / wall_s


def run(words):
    with tempfile.TemporaryFile("w+") as errors:
        busy, start = busy_s(), time.monotonic()
        child = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=errors, text=True)
        try:
            output = child.stdout.read()
            _, status, usage = os.wait4(child.pid, 0)  # this child's own peak memory
            wall = time.monotonic() - start
            child.returncode = os.waitstatus_to_exitcode(status)
        except BaseException:
            child.kill()
            child.wait()
            raise
        finally:
            child.stdout.close()
        errors.seek(0)
        why = " ".join(errors.read().split()) or f"ended with {child.returncode}"
    # A bench whose figures break their bounds prints them all the same.
    if child.returncode != 0 and not (child.returncode == 1 and output.startswith("{")):
        raise Failure(f"{shlex.join(words)}: {why}")
    cpu = usage.ru_utime + usage.ru_stime
    return Outcome(output, wall, cpu, usage.ru_maxrss * 1024, foreign_share(busy, busy_s(), cpu, wall), why if child.returncode else "")
