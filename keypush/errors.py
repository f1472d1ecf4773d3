"""The one exception that stands for a user's mistake."""


class UserError(Exception):
    """A mistake the user can mend: bad field, unknown name, unreadable file.

    The message is one line that names the field or file, what was found and what
    is allowed. The command line prints it and exits with status 2; no traceback.
    """
