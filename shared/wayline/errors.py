"""Pure: the errors that a user can mend."""


class InputError(Exception):
    """Bad input: says where, what is wrong and how to mend it, in one line for a terminal.

    Commands print it and exit with status 2. It is never raised for bad data inside a stream,
    which is counted and dropped instead.
    """

    def __init__(self, where: str, what: str, mend: str) -> None:
        self.where, self.what, self.mend = where, what, mend
        line = " ".join(f"{where}: {what}; {mend}".split())
        super().__init__("".join(each if each.isprintable() else "?" for each in line))

    def __reduce__(self) -> tuple[type["InputError"], tuple[str, str, str]]:
        """What pickles it, so that it can be raised again where another process did the work."""
        return type(self), (self.where, self.what, self.mend)


class UnreadableError(InputError):
    """A recording is there but cannot be read: the other sources of its drive still can."""
