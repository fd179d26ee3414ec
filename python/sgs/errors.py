# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What the library raises. Every message ends with the remedy where there is one."""


class Error(Exception):
    """A failure that the library expects: of files, values, devices.

    code: "not found", "invalid format", "invalid argument", "unknown key", "io", "unsupported", "busy",
    "interrupted" or "internal"; message: what happened; remedy: what can be done, or "".
    """

    def __init__(self, code: str, message: str, remedy: str = "") -> None:
        super().__init__(code, message, remedy)
        self.code = code
        self.message = message
        self.remedy = remedy

    def __str__(self) -> str:
        return f"{self.message} ({self.remedy})" if self.remedy else self.message


class InvalidArgument(Error, ValueError):
    """An argument or a configuration value that cannot be."""


class UnknownKey(Error, KeyError):
    """A key that no parameter has; the message names the nearest one."""


class NotFound(Error, FileNotFoundError):
    """A file or folder that does not exist."""


class Busy(Error, RuntimeError):
    """Another thread is at work on this object."""


_CLASSES = {
    "invalid argument": InvalidArgument,
    "unknown key": UnknownKey,
    "not found": NotFound,
    "busy": Busy,
}


def make(code: str, message: str, remedy: str) -> Error:
    """The exception for an error of the library."""
    return _CLASSES.get(code, Error)(code, message, remedy)
