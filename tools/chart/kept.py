"""Tables and charts of whole curves, kept in FOLDER/tables.json for documents: {size: {curve: {"tables": {name: Markdown}, "charts": [name]}}}."""
import json
import os


class Kept:
    """Of one size; those of the other stay as they are, but for charts drawn over."""

    def __init__(self, folder, size):
        self.path = os.path.join(folder, "tables.json")
        self.sizes = self._read()
        self.curves = self.sizes.setdefault(size, {})

    def _read(self):
        try:
            with open(self.path, encoding="utf-8") as file:
                sizes = json.load(file)
            return {size: {curve: {"tables": dict(k["tables"]), "charts": list(k["charts"])} for curve, k in curves.items()}
                    for size, curves in sizes.items()}
        except (OSError, ValueError, KeyError, TypeError, AttributeError):  # none, or of another version: made again in time
            return {}

    def drawn(self, charts):
        """These files are now of this run, whatever they showed before."""
        for curves in self.sizes.values():
            for kept in curves.values():
                kept["charts"] = [c for c in kept["charts"] if c not in charts]

    def put(self, curve, tables, charts):
        self.curves[curve] = {"tables": tables, "charts": charts}

    def save(self):
        with open(self.path + ".part", "w", encoding="utf-8") as file:
            json.dump(self.sizes, file, indent=1)
        os.replace(self.path + ".part", self.path)

    def of(self, left_out):
        """(tables, charts) of all curves but some."""
        chosen = [kept for curve, kept in self.curves.items() if curve not in left_out]
        return {name: text for kept in chosen for name, text in kept["tables"].items()}, {c for kept in chosen for c in kept["charts"]}
