#!/usr/bin/env python3
"""Drills: what is left when ivory is killed, starved and hindered while it writes and reads.

usage: drills.py IVORY FOLDER [MOMENTS [DRILL...]]     MOMENTS a writing command are killed, 100 by default

Every command that writes is to leave the file that was there before or the whole new one, and, where it fails, to say
so in one line that names the file or stream, with exit code 1. FOLDER is made anew. As root, full disks and read-only
folders are small file systems in memory; otherwise limits of file sizes and permissions stand in.
"""
import os
import pathlib
import random
import resource
import shutil
import subprocess
import sys
import threading
import time

from drill_bench import BOX, KNOT, LIMIT_SECONDS, SCENES, SKY
from kill_drills import KillDrills


class Drills(KillDrills):
    def full_disk(self):
        """A file system in memory with nothing, a block and four blocks left."""
        for writer in self.writers if self.mounted else []:
            for free in (0, 4096, 16384):
                self.tried += 1
                folder = self.folder / "full"
                folder.mkdir()
                size = (len(writer.old) // 4096 + 2) * 4096 + free
                subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "ivory", folder], check=True)
                output = self.output(folder, writer)
                output.write_bytes(writer.old)
                with open(folder / "filler", "wb", buffering=0) as filler:
                    disk = os.statvfs(folder)
                    filler.write(bytes(max(disk.f_bavail * disk.f_frsize - free, 0)))
                code, said = self.run(writer.words + ["-o", output, "--force"])
                fits = len(writer.new) <= free
                self.check_end(writer.name, code, said, [output], may_work=fits)
                self.check_file(writer, output, whole=fits)
                self.check_leftovers(writer, folder)
                subprocess.run(["umount", folder], check=True)
                shutil.rmtree(folder)

    def starve(self, what, levels, names, may_work=True):
        """Every writer under a limit of the system, level by level."""
        for writer in self.writers:
            for level in levels(writer):
                self.tried += 1
                output = self.output(self.folder, writer)
                output.write_bytes(writer.old)
                code, said = self.run(writer.words + ["-o", output, "--force"], [(what, level)])
                if not ("shared librar" in said and code == 127):  # the system's loader, before main()
                    self.check_end(writer.name, code, said, [output] + names, may_work)
                self.check_file(writer, output, whole=may_work)
                self.check_leftovers(writer, self.folder)
                output.unlink()

    def limited_file(self):
        self.starve(resource.RLIMIT_FSIZE, lambda writer: (0, len(writer.new) // 2), [], may_work=False)

    def little_memory(self):
        """From where libraries can be loaded at all, which is before main(), to four times that."""
        least = 64e6
        while self.run(["--version"], [(resource.RLIMIT_AS, int(least))])[0] != 0:
            least *= 1.1
        self.starve(resource.RLIMIT_AS, lambda _: [int(least * 1.15 ** i) for i in range(1, 11)],
                    ["memory", "cannot be loaded"])

    def few_open_files(self):
        self.starve(resource.RLIMIT_NOFILE, lambda _: (3, 4, 5, 6, 8, 12), ["cannot be"])

    def read_only_folder(self):
        for writer in self.writers:
            self.tried += 1
            folder = self.folder / "locked"
            folder.mkdir()
            output = self.output(folder, writer)
            if self.mounted:
                subprocess.run(["mount", "-t", "tmpfs", "ivory", folder], check=True)
            output.write_bytes(writer.old)
            if self.mounted:
                subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
            else:
                folder.chmod(0o555)
            code, said = self.run(writer.words + ["-o", output, "--force"])
            self.check_end(writer.name, code, said, [output], may_work=False)
            self.check_file(writer, output, whole=False)
            if self.mounted:
                subprocess.run(["umount", folder], check=True)
            folder.chmod(0o755)
            shutil.rmtree(folder)

    def vanishing_folder(self):
        for writer in self.writers:
            for remove in (True, False):
                self.tried += 1
                folder, away = self.folder / "vanishing", self.folder / "away"
                folder.mkdir()
                output = self.output(folder, writer)
                output.write_bytes(writer.old)
                command = [self.ivory] + writer.words + ["-o", str(output), "--force"]
                with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
                    time.sleep(random.uniform(0, writer.seconds))
                    shutil.rmtree(folder, ignore_errors=True) if remove else folder.rename(away)
                    _, said = process.communicate(timeout=LIMIT_SECONDS)
                self.check_end(writer.name, process.returncode, said, [output], may_work=True)
                if away.exists():
                    self.check_file(writer, self.output(away, writer), whole=True)
                shutil.rmtree(away, ignore_errors=True)
                shutil.rmtree(folder, ignore_errors=True)

    def closed_streams(self):
        """Exit code, whether the file is there, and what is said, by how streams are closed in the shell."""
        for writer in self.writers:
            for how, json, code_wanted in [(">&-", True, 1), (">/dev/full", True, 1), (">&-", False, None),
                                           (">/dev/full 2>/dev/full", True, 1), ("2>&-", False, 0),
                                           ("2>/dev/full", False, 0), ("<&- >&- 2>&-", True, 1),
                                           ("<&- >&- 2>&-", False, None)]:
                self.tried += 1
                output = self.output(self.folder, writer)
                output.write_bytes(writer.old)
                words = writer.words + ["-o", str(output), "--force", "--json" if json else "--quiet"]
                done = subprocess.run(["sh", "-c", f'"$0" "$@" {how}', self.ivory] + words, capture_output=True,
                                      text=True, check=False, timeout=LIMIT_SECONDS)
                wanted = 0 if code_wanted is None else code_wanted
                if done.returncode != wanted:
                    self.fault("misled", writer.name, f"{how}: exit code {done.returncode}, not {wanted}: {done.stderr}")
                if wanted == 1 and "2>" not in how:
                    self.check_end(writer.name, done.returncode, done.stderr, ["standard output"], may_work=False)
                if output.read_bytes() != writer.new:
                    self.fault("damaged", writer.name, f"{how}: not the new file")
                output.unlink()
        # An error that nobody can hear is an exit code all the same.
        for how in ("2>&-", "2>/dev/full"):
            self.tried += 1
            done = subprocess.run(["sh", "-c", f'"$0" info {self.folder}/none.vdb {how}', self.ivory], check=False)
            if done.returncode != 1:
                self.fault("misled", "info", f"{how}: exit code {done.returncode}, not 1")

    def two_at_once(self):
        for writer in self.writers:
            for force in (False, True):
                self.tried += 1
                folder = self.folder / "two"
                folder.mkdir()
                output = self.output(folder, writer)
                command = [self.ivory] + writer.words + ["-o", str(output)] + (["--force"] if force else [])
                both = [subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                        for _ in range(2)]
                ends = [(process.communicate(timeout=LIMIT_SECONDS)[1], process.returncode) for process in both]
                codes = sorted(code for _, code in ends)
                if codes != [0, 0 if force else 1]:
                    self.fault("misled", writer.name, f"exit codes {codes}: {ends}")
                for said, code in ends:
                    self.check_end(writer.name, code, said, [output], may_work=True)
                if not output.exists() or output.read_bytes() != writer.new:
                    self.fault("damaged", writer.name, "not the new file")
                shutil.rmtree(folder)

    def changing_input(self):
        """Files that are cut, mixed and restored while they are read."""
        read = [(BOX, ["bake", "grid", "IN", "--resolution", "4", "--photons", "2k", "-o", "OUT.vdb"]),
                (KNOT, ["info", "IN"]),
                (self.folder / "whole.vdb", ["probe", "IN", "--points", self.points, "-o", "OUT.csv"]),
                (self.folder / "a.vdb", ["merge", "IN", self.folder / "b.vdb", "-o", "OUT.vdb"]),
                (SKY, ["bake", "sh9", "IN", "-o", "OUT.json"]),
                (self.folder / "map.exr", ["probe", "IN", "--points", self.points, "-o", "OUT.csv"]),
                (self.folder / "map.json", ["info", "IN"]),
                (self.points, ["probe", self.folder / "whole.vdb", "--points", "IN", "-o", "OUT.csv"])]
        for source, words in read:
            name = self.folder / f"changing{source.suffix}"
            content = source.read_bytes()
            stop = threading.Event()

            def change(name=name, content=content, stop=stop):
                with open(name, "r+b", buffering=0) as file:
                    while not stop.is_set():
                        at = random.randrange(len(content))
                        file.seek(at)
                        file.write(random.randbytes(random.randrange(1, 65)))
                        if random.random() < 0.3:
                            file.truncate(at)
                        time.sleep(random.uniform(0, 0.003))
                        file.seek(0)
                        file.write(content)
                        file.truncate(len(content))
                        time.sleep(random.uniform(0, 0.05))

            for _ in range(max(5, self.moments // 5)):
                self.tried += 1
                name.write_bytes(content)
                stop.clear()
                thread = threading.Thread(target=change)
                thread.start()
                out = self.folder / "changed"
                code, said = self.run([str(w).replace("IN", str(name)) if w == "IN" else
                                       str(w).replace("OUT", str(out)) for w in words] +
                                      (["--force"] if words[0] != "info" else []))
                stop.set()
                thread.join()
                said = "".join(line + "\n" for line in said.splitlines() if not line.startswith("warning: "))
                self.check_end(words[0], code, said, [name], may_work=True)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[2]).resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    drills = Drills(sys.argv[1], folder, int(sys.argv[3]) if len(sys.argv) > 3 else 100)
    every = [drills.killed, drills.killed_and_resumed, drills.batch_killed, drills.full_disk, drills.limited_file, drills.read_only_folder, drills.vanishing_folder,
             drills.closed_streams, drills.little_memory, drills.few_open_files, drills.two_at_once,
             drills.changing_input]
    chosen = [drill for drill in every if not sys.argv[4:] or drill.__name__ in sys.argv[4:]]
    for drill in chosen:
        drills.name = drill.__name__.replace("_", " ")
        before = (drills.tried, drills.damaged, drills.misled)
        drill()
        tried, damaged, misled = (now - then for now, then in zip((drills.tried, drills.damaged, drills.misled), before))
        print(f"{drills.name:<18} {tried:>5} moments, {damaged} files damaged or lost, {misled} misled", flush=True)
    print(f"{'all':<18} {drills.tried:>5} moments, {drills.damaged} files damaged or lost, {drills.misled} misled")
    sys.exit(1 if drills.damaged or drills.misled else 0)


if __name__ == "__main__":
    main()
