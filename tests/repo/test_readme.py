"""What the README shows as Python runs, block after block in one interpreter."""

import re
from pathlib import Path
from typing import Any

import numpy as np

README = Path(__file__).resolve().parents[2] / "README.md"


def test_the_python_of_the_readme_runs() -> None:
    blocks = re.findall(r"^```python\n(.*?)^```", README.read_text(encoding="utf-8"), re.M | re.S)
    assert len(blocks) == 3
    names: dict[str, Any] = {}
    for block in blocks:
        exec(compile(block, str(README), "exec"), names)
    assert names["result"].summary["outcome"] == "success"
    away = np.linalg.norm(names["cloud_W"] - names["p_WK"], axis=1)
    assert away.min() < 0.03
