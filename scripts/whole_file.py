"""Files that scripts write: whole or not at all, as those of the program itself (geometry/io/atomic_file.h).

A file is written under another name, which is new and no link, and gets its own name once all of it is on the disk.
"""

import contextlib
import os
import secrets
import sys

PICTURE_MARK = b"Pliant"  # in a picture's own description: who may be replaced by a newer one


@contextlib.contextmanager
def whole_file(path, mode="w", **options):
    """Opens a file to write that appears at `path` when the block ends without an exception."""
    folder, name = os.path.split(os.path.abspath(path))
    partial = os.path.join(folder, f".{name}.{os.getpid()}.{secrets.token_hex(4)}.tmp")
    descriptor = os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666)
    try:
        with os.fdopen(descriptor, mode, **options) as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, path)
    except BaseException:
        os.unlink(partial)
        raise


def save_picture(figure, path, **options):
    """Saves a figure of matplotlib as PNG or SVG, by the path's ending. Ends the program where something else is."""
    path = os.fspath(path)
    if os.path.lexists(path):
        own = False
        if os.path.isfile(path) and not os.path.islink(path):
            with open(path, "rb") as file:
                own = PICTURE_MARK in file.read(4096)
        if not own:
            sys.exit(f"'{path}' is there and was not drawn by Pliant: move it away")
    metadata = {"Creator": "Pliant", "Date": None} if path.endswith(".svg") else {"Software": "Pliant"}
    with whole_file(path, "wb") as file:
        figure.savefig(file, format=path[-3:], metadata=metadata, **options)
