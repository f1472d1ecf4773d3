"""What checks of objects found, as JSON and as a table."""

from collections.abc import Mapping
from typing import Any

from rich.table import Table

from keypush.checking.object_checks import Check

Checks = Mapping[str, Mapping[str, Check]]


def describe_checks(checked: Checks) -> dict[str, dict[str, Any]]:
    """Returns {NAME: {"ok": ..., CHECK: {"ok": ..., "value": ..., "limit": ..., "text": ...}}}."""
    return {
        name: {
            "ok": all(check.ok for check in checks.values()),
            **{kind: vars(check) for kind, check in checks.items()},
        }
        for name, checks in checked.items()
    }


def checks_table(checked: Checks) -> Table:
    """Lays out one line per object: what failed, or that all is well."""
    table = Table(title_justify="left")
    table.add_column("object")
    table.add_column("result")
    passed = 0
    for name, checks in checked.items():
        failed = [
            f"{kind}: {_figure(check)} ({check.text})"
            for kind, check in checks.items()
            if not check.ok
        ]
        passed += not failed
        table.add_row(name, "\n".join(failed) or "ok")
    table.title = f"{passed} of {len(checked)} objects pass"
    return table


def _figure(check: Check) -> str:
    return "-" if check.value is None else f"{check.value:.4g}, allowed {check.limit:g}"
