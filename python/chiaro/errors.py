"""What chiaro raises."""

from __future__ import annotations


class Error(Exception):
    """One sentence that names the thing, the value and the allowed range; ``code`` is the tool's exit code."""

    code = 1


class UsageError(Error, ValueError):
    """A value that a setting does not take, or settings that contradict each other (code 2)."""

    code = 2


class InputError(Error):
    """Something is wrong with a file or with data (code 3)."""

    code = 3


class OutputError(Error):
    """A file that cannot be written, memory or a device that cannot be had (code 4)."""

    code = 4


class Interrupted(Error):
    """The call was cancelled (code 130)."""

    code = 130


_kinds = {2: UsageError, 3: InputError, 4: OutputError, 130: Interrupted}


def error_of(code: int, sentence: str) -> Error:
    """The exception for an error of the library."""
    error = _kinds.get(code, Error)(sentence)
    error.code = code
    return error
