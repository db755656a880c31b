"""Error messages for the user, in which parameters are written as options."""

_OPTIONS = {
    "from_format": "--from", "to_format": "--to", "output": "-o", "settings": "--set",
}  # fmt: skip  # parameters whose options have other names


def explained(error: Exception, name: str = "") -> str:
    """Return the message, of one or two lines, about an `error` in the input called `name`."""
    from meshonet.geometry.errors import InputError, MeshonetError, NoValidGridError

    if isinstance(error, InputError):
        error.source = error.source or name
        return error.text(option)
    where = f"{name}: " if name else ""
    if isinstance(error, NoValidGridError):
        return f"{where}{error.text(option)}"
    if isinstance(error, MeshonetError):
        return f"{where}{with_options(str(error))}"
    if isinstance(error, MemoryError):
        return f"{where}not enough memory ({error}); use a smaller --res".replace(" ()", "")
    if isinstance(error, OSError):
        file = f"{error.filename}: " if error.filename else where
        return f"{file}{error.strerror or error}; check the path, its permissions and the free space"
    return f"{where}internal error: {type(error).__name__}: {error}; this is a bug, --debug shows where"


def option(parameter: str) -> str:
    """Return the command-line option for a parameter of the library.

    >>> option("far_field"), option("from_format")
    ('--far-field', '--from')
    """
    return _OPTIONS.get(parameter) or "--" + parameter.replace("_", "-")


def with_options(text: str) -> str:
    """Return a message of the library in which each ``{parameter}`` is replaced by its option.

    >>> with_options("the far field is cut off; set {far_field}")
    'the far field is cut off; set --far-field'
    """
    from meshonet.geometry.errors import spelled

    return spelled(text, option)
