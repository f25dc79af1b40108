"""Runs the examples of docs/python.md as they are written: the blocks of a section one after the other."""

import contextlib
import io
import os
import re
import unittest

from support import ROOT, FolderTest

PAGE = ROOT / "docs" / "python.md"


def sections():
    """Title and code of each section with code."""
    for text in re.split(r"^## ", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]:
        blocks = re.findall(r"^```python\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)
        if blocks:
            yield text.splitlines()[0], "\n".join(blocks)


class Documents(FolderTest):
    def test_examples(self):
        os.symlink(ROOT / "scenes", self.folder / "scenes")
        os.chdir(self.folder)
        self.addCleanup(os.chdir, ROOT)
        titles = []
        for title, code in sections():
            said = io.StringIO()
            with self.subTest(title), contextlib.redirect_stdout(said):
                exec(compile(code, f"{PAGE.name}: {title}", "exec"), {"__name__": "example"})  # pylint: disable=exec-used
            titles.append(title)
        self.assertEqual(len(titles), 4)


if __name__ == "__main__":
    unittest.main()
