"""What goes wrong, by kind. Every message names the place, what was expected, what was found and
what to do."""


class Error(Exception):
    """Of any kind."""


class UsageError(Error, ValueError):
    """An option or an argument is wrong."""


class DataError(Error, ValueError):
    """A file or an array breaks its format, or cannot be used."""


class MissingInputError(Error, FileNotFoundError):
    """A file that is named does not exist."""


class CannotCreateError(Error, OSError):
    """A file or a folder cannot be made."""


class InputOutputError(Error, OSError):
    """Reading or writing failed, or memory ran out."""


class ChangedError(InputOutputError):
    """Others changed a file while it was used: open it anew."""


class Stopped(Error):
    """It was stopped before its end."""


class InternalError(Error, RuntimeError):
    """A fault of the program."""
