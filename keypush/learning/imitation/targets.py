"""What a row teaches each of the thesis' networks."""

import numpy as np
from numpy.typing import NDArray

from keypush.learning.clips import Clips
from keypush.learning.imitation.config import ImitationConfig
from keypush.learning.labels import make_labels
from keypush.learning.rows import Rows
from keypush.networks.normalisation import normalise_positions
from keypush.planning.plan_state import Stage

Targets = NDArray[np.float64]


def make_targets(kind: str, rows: Rows, clips: Clips, config: ImitationConfig) -> Targets:
    """Returns the targets of all rows, (n, 3) or (n, 6); NaN for rows that teach nothing.

    Args:
        kind: "keypoint": normalised p_WK; "behavior_cloning": the action in shares of its clips,
            clipped as the controller does.
        rows: ordered by episode and step.
        clips: of the action.
        config: settings.
    """
    if kind == "keypoint":
        return np.asarray(normalise_positions(make_labels(rows, config.label)))
    shares = np.clip(rows.action / clips.of_action, -1, 1)
    shares[~_acts(rows, retreats=config.retreats)] = np.nan
    return np.asarray(shares)


def _acts(rows: Rows, *, retreats: bool) -> NDArray[np.bool_]:
    """Whether a row has an action that the scene explains, (n,)."""
    last = np.append(rows.episode[1:] != rows.episode[:-1], True)  # it has no answer
    idle = last | (rows.stage == Stage.HALTED)
    return np.asarray(~idle if retreats else ~idle & (rows.stage != Stage.RETREAT))
