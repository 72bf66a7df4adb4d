"""A kill in the middle of a change of a file, without a process that dies."""

from __future__ import annotations

import contextlib


class Killed(BaseException):
    """Stands for a kill: nothing may catch it."""


@contextlib.contextmanager
def killed_at(monkeypatch, moment: int):
    """A file under a journal gets so many writes whole, and half of the next; then comes Killed."""
    left = moment

    def write(file, data):
        nonlocal left
        if left == 0:
            file.write(data[: len(data) // 2])
            raise Killed
        left -= 1
        file.write(data)

    with monkeypatch.context() as patch:
        patch.setattr("openmmhelfrich._journal._write_all", write)
        yield
