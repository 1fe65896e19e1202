# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is raised for bad input: exceptions of Python's own kinds, which know what was wrong and where."""

from __future__ import annotations

from typing import Any

from ._core import ErrorCode


class Error(Exception):
    """Bad input: a mesh, an update, a pose or a file.

    `code` says what was wrong, `where` is the index of the offending vertex, triangle, list entry, pose or frame; None
    where there is no such thing. The text names both.
    """

    def __init__(self, text: str, code: ErrorCode, where: int | None = None) -> None:
        super().__init__(text)
        self.code = code
        self.where = where

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.code, self.where)


class InputError(Error, ValueError):
    """Bad input that is none of the others. It is a ValueError."""


class OutOfRangeError(Error, IndexError):
    """`index_out_of_range`: something names a vertex that does not exist. It is an IndexError."""


class UnreadableFileError(Error, OSError):
    """`unreadable_file`: the file is missing, a folder, or there is no permission. It is an OSError."""


_CLASSES: dict[ErrorCode, type[Error]] = {
    ErrorCode.index_out_of_range: OutOfRangeError,
    ErrorCode.unreadable_file: UnreadableFileError,
}


def error_of(text: str, code: ErrorCode, where: int | None) -> Error:
    """The exception that stands for an error of the library."""
    return _CLASSES.get(code, InputError)(text, code, where)
