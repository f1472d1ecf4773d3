"""`keypush train`: a keypoint network from collected episodes."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar


@dataclass(kw_only=True)
class Train:
    """Train the keypoint network on episodes of `keypush collect`."""

    after_interrupt: ClassVar[str] = "no weights were written"

    data: Path
    """Folder that `keypush collect` wrote."""
    out: Path
    """Folder for weights, metrics and settings."""

    def run(self) -> None:
        """Runs the verb."""
