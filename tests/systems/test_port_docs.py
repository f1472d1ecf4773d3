"""The port documentation of every system agrees with its ports."""

import importlib
import inspect
import pkgutil
import re
from functools import cache
from typing import Any

import pytest
import yaml
from pydrake.systems.framework import Diagram, LeafSystem, System

import keypush.systems
from diagrams.push_diagram import MakePushDiagram
from keypush.learning.baselines import CentroidKeypoint
from keypush.policies import POLICIES
from keypush.scenario import Scenario


def _system_classes() -> list[type[LeafSystem]]:
    """The systems in keypush/systems, without the bases that others complete."""
    modules = [
        importlib.import_module(f"keypush.systems.{info.name}")
        for info in pkgutil.iter_modules(keypush.systems.__path__)
    ]
    classes = [
        cls
        for module in modules
        for _, cls in inspect.getmembers(module, inspect.isclass)
        if issubclass(cls, LeafSystem) and cls.__module__ == module.__name__
    ]
    return [cls for cls in classes if not cls.__subclasses__()]


def _leaves(system: System) -> list[System]:
    if not isinstance(system, Diagram):
        return [system]
    return [leaf for inner in system.GetSystems() for leaf in _leaves(inner)]


@cache
def _instances() -> dict[str, System]:
    """One instance of every system that a diagram of some policy holds, by class name."""
    found = {}
    for policy in POLICIES:
        push = MakePushDiagram(Scenario(policy=policy), CentroidKeypoint())
        found.update({type(leaf).__name__: leaf for leaf in _leaves(push.diagram)})
    return found


@pytest.mark.parametrize("cls", _system_classes(), ids=lambda cls: str(cls.__name__))
def test_documented_ports_are_the_real_ports(cls: type[LeafSystem]) -> None:
    text = inspect.cleandoc(cls.__doc__ or "")
    block = re.search(r"^@system$(.*?)^@endsystem$(.*)", text, re.DOTALL | re.MULTILINE)
    assert block, f"{cls.__name__} has no @system block"
    system = _instances()[cls.__name__]
    ports = {
        "input_ports": [
            system.get_input_port(i).get_name() for i in range(system.num_input_ports())
        ],
        "output_ports": [
            system.get_output_port(i).get_name() for i in range(system.num_output_ports())
        ],
    }
    real = {kind: names for kind, names in ports.items() if names}
    assert _without_flags(yaml.safe_load(block[1])) == {"name": cls.__name__, **real}
    paragraphs = re.split(r"\n\s*\n", block[2].strip())
    described = [found[1] for p in paragraphs if (found := re.match(r"``(\w+)``", p))]
    assert described == [*ports["input_ports"], *ports["output_ports"]]


def _without_flags(block: dict[str, Any]) -> dict[str, Any]:
    """Strips what Drake writes behind a port that may stay unconnected."""
    return {
        key: [name.removesuffix(" (optional)") for name in value] if key != "name" else value
        for key, value in block.items()
    }


def test_every_system_is_looked_at() -> None:
    assert len(_system_classes()) >= 9
