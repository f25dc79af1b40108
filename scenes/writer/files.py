"""Files written whole or not at all."""
import os
import pathlib


def write_file(path, data):
    """`data`: bytes or text. A file that holds them already is left alone."""
    path = pathlib.Path(path)
    data = data.encode("utf-8") if isinstance(data, str) else bytes(data)
    if path.is_file() and path.read_bytes() == data:
        return
    part = path.with_name(path.name + ".part")
    try:
        part.write_bytes(data)
        os.replace(part, path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise
