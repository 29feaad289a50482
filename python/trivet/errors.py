"""Exceptions by kind of error.

Every message names the location, the expected and the found value, and a remedy.
"""


class Error(Exception):
    """Base class of all errors."""


class UsageError(Error, ValueError):
    """An option or an argument is invalid."""


class DataError(Error, ValueError):
    """A file or an array violates its format, or cannot be used."""


class MissingInputError(Error, FileNotFoundError):
    """A specified file does not exist."""


class CannotCreateError(Error, OSError):
    """A file or a folder cannot be created."""


class InputOutputError(Error, OSError):
    """Reading or writing failed, or memory ran out."""


class ChangedError(InputOutputError):
    """Another process changed a file during its use: open it again."""


class Stopped(Error):
    """The operation was stopped before its end."""


class InternalError(Error, RuntimeError):
    """A defect of the program."""
