"""Drills that kill ivory at random moments."""
import random
import shutil
import signal
import subprocess
import time

from drill_bench import SCENES, SKY, Bench


class KillDrills(Bench):
    def killed(self):
        """SIGKILL at random moments, more of them towards the end, where files are written."""
        for writer in self.writers:
            folder = self.folder / "killed"
            folder.mkdir()
            output = self.output(folder, writer)
            command = [self.ivory] + writer.words + ["-o", str(output), "--force", "--quiet"]
            for _ in range(self.moments):
                self.tried += 1
                output.write_bytes(writer.old)
                moment = writer.seconds * (random.uniform(0, 1.1) if random.random() < 0.4 else random.uniform(0.7, 1.1))
                with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
                    start = time.monotonic()
                    try:
                        process.wait(moment)
                        writer.seconds = 0.9 * writer.seconds + 0.1 * (time.monotonic() - start)
                    except subprocess.TimeoutExpired:
                        process.send_signal(signal.SIGKILL)
                self.check_file(writer, output, whole=True)
                strange = [f.name for f in folder.iterdir() if f != output and not (f.name[0] == "." and ".part" in f.name)]
                if strange:
                    self.fault("damaged", writer.name, f"left behind: {' '.join(strange)}")
            # What was left behind is in nobody's way.
            code, said = self.run(writer.words + ["-o", output, "--force"])
            if code != 0 or output.read_bytes() != writer.new:
                self.fault("damaged", writer.name, f"does not run again: {said}")
            shutil.rmtree(folder)

    def killed_and_resumed(self):
        """SIGKILL at random moments of bakes with checkpoints, each of which goes on from what the last one left."""
        for name, options, longest in [("bake grid", ["--photons", "1m"], 0.6),
                                       ("bake grid groups", ["--photons", "700k", "--levels", "2", "--groups", "extras"], 0.6),
                                       ("bake grid to an error", ["--target-error", "6%"], 1.1)]:
            folder = self.folder / "resumed"
            folder.mkdir()
            output, checkpoint = folder / "out.vdb", folder / "out.checkpoint.vdb"
            words = ["bake", "grid", str(SCENES / "leak_axis.gltf")] + options
            if "--target-error" not in options:
                words += ["--resolution", "10"]
            start = time.monotonic()
            self.make(words + ["-o", str(output)])
            seconds, whole = time.monotonic() - start, output.read_bytes()
            output.unlink()
            for moment in range(self.moments // 3 + 1):
                self.tried += 1
                # As often as their cost allows, on other numbers of threads.
                command = [self.ivory] + words + ["-o", str(output), "--quiet", "--checkpoint", "0.0001",
                                                  "--threads", str(1 + moment % 2)]
                with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
                    try:
                        # Photons are but the end of a bake to an error.
                        _, said = process.communicate(timeout=random.uniform(0, longest * seconds))
                        code = process.returncode
                    except subprocess.TimeoutExpired:
                        process.send_signal(signal.SIGKILL)
                        code = None
                if code is None:
                    if checkpoint.exists():
                        code, said = self.run(["info", checkpoint])
                        if code != 0:
                            self.fault("damaged", name, f"checkpoint: {said}")
                    if output.exists():  # at the very end
                        if output.read_bytes() != whole:
                            self.fault("damaged", name, "not the bytes of a bake that nothing stopped")
                        output.unlink()
                    continue
                if code != 0:
                    self.fault("misled", name, f"does not go on: exit code {code}: {said}")
                elif output.read_bytes() != whole:
                    self.fault("damaged", name, "not the bytes of a bake that nothing stopped")
                if checkpoint.exists():
                    self.fault("misled", name, "its checkpoint stays")
                output.unlink(missing_ok=True)
            code, said = self.run(words + ["-o", output])
            if code != 0 or output.read_bytes() != whole:
                self.fault("damaged", name, f"does not end as a bake that nothing stopped: {said}")
            shutil.rmtree(folder)

    def batch_killed(self):
        """SIGKILL at random moments of a batch, which goes on each time, until it ends; then anew."""
        whole = self.batch_folder("batch_whole")
        start = time.monotonic()
        self.make(["batch", str(whole / "job.toml")])
        seconds = time.monotonic() - start
        names = sorted(f.name for f in whole.iterdir() if f.suffix in (".vdb", ".exr", ".json") and ".batch." not in f.name)
        folder = self.batch_folder("batch_killed")
        for _ in range(self.moments):
            self.tried += 1
            command = [self.ivory, "batch", str(folder / "job.toml"), "--quiet"]
            with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
                try:
                    _, said = process.communicate(timeout=random.uniform(0.02, 0.7 * seconds))
                    code = process.returncode
                except subprocess.TimeoutExpired:
                    process.send_signal(signal.SIGKILL)
                    continue
            if code != 0:
                self.fault("misled", "batch", f"does not go on: exit code {code}: {said}")
            for name in names:
                if not (folder / name).exists() or (folder / name).read_bytes() != (whole / name).read_bytes():
                    self.fault("damaged", "batch", f"{name}: not the bytes of a batch that nothing stopped")
            shutil.rmtree(folder)
            folder = self.batch_folder("batch_killed")
        shutil.rmtree(folder)
        shutil.rmtree(whole)

    def batch_folder(self, name):
        folder = self.folder / name
        folder.mkdir()
        shutil.copy(SCENES / "leak_axis.gltf", folder)
        shutil.copy(SKY, folder / "sky.hdr")
        (folder / "job.toml").write_text('''
[grid.room]
scene = "leak_axis.gltf"
resolution = 8
photons = "300k"
checkpoint = 0.0001
[cubemap.room]
scene = "leak_axis.gltf"
grid = "room"
at = [0.5, 1, 0.5]
capture = 16
[sh9.sky]
environment = "sky.hdr"
[difmap.sky]
environment = "sky.hdr"
''')
        return folder
