"""What a curve is made of: inputs, commands, points; runner.py measures them."""
import dataclasses
import re


@dataclasses.dataclass(frozen=True)
class File:
    """An input; `make`, called before it is first read, brings it up to date."""
    path: str
    make: object = None


@dataclasses.dataclass(frozen=True)
class Out:
    """The step's own output, by its extension."""
    extension: str


@dataclasses.dataclass(eq=False)
class Step:
    arguments: tuple  # strings and numbers, File, Out, Steps whose outputs are read; NAME=OUTPUT as ("NAME=", Step)
    timed: bool = False  # does its time count for the point?
    seconds: str = "wall"  # the command's whole time; "once": the same, never repeated; any other: a field of its result
    threads: int = 0  # 0: as the suite says

    def reports_time(self):
        return self.seconds not in ("wall", "once")

    def depends_on_machine(self):
        return self.timed or self.arguments[0] == "bench"


@dataclasses.dataclass(eq=False)
class Point:
    curve: str
    panel: str  # which chart, mostly the scene
    series: str  # which line
    label: str  # beside the mark
    steps: list
    measure: object  # function(run: Run) -> dict of figures; "nrmse", "memory_bytes" ...
    join: bool = True  # is the series a curve, or just marks?
    name: str = ""

    def __post_init__(self):
        words = (re.sub("[^a-z0-9.]+", "_", w.lower()).strip("_") for w in (self.curve, self.panel, self.series, self.label))
        self.name = self.name or "/".join(words)
