"""The scenario of one episode: the data set's, with the episode's own object."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from keypush.dataset.read import DataSet
from keypush.scenario import Scenario, load_scenario


def episode_scenario(dataset: DataSet, told: Mapping[str, Any]) -> Scenario:
    """Returns the scenario of an episode.

    Args:
        dataset: holds `meta/scenario.yaml`.
        told: of the episode: object and size_ratio.

    Raises:
        UserError: the file is missing or damaged.
    """
    scenario = load_scenario(dataset.scenario)
    mine = replace(scenario.object, name=told["object"], size_ratio=told["size_ratio"])
    return replace(scenario, object=mine)
