"""The one exception that stands for a user's mistake, and what others say on one line."""


class UserError(Exception):
    """A mistake the user can mend: bad field, unknown name, unreadable file.

    The message is one line that names the field or file, what was found and what
    is allowed. The command line prints it and exits with status 2; no traceback.
    """


def one_line(error: BaseException) -> str:
    """Returns an exception's text on one line of at most 300 characters."""
    return " ".join(str(error).split())[:300]
