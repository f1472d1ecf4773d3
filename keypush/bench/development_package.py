"""Packages that only the comparison with another engine needs."""

import importlib
from typing import Any

from keypush.errors import UserError


def import_development(name: str) -> Any:
    """Imports a package that a checkout has and an installation of keypush need not have.

    Raises:
        UserError: it is not installed.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise UserError(
            f"the benchmark needs the package {name}, which is not installed; run it in a "
            f"checkout (scripts/uv.sh run --frozen keypush bench sim) or install {name}"
        ) from error
