"""Objects stand and fall where their support polygon says, as far as the table is hard."""

import numpy as np
import pytest

from keypush.checking.object_checks import HARD_TABLE
from keypush.checking.object_scene import ObjectScene
from keypush.checking.tipping import com_beyond_edge, directions
from keypush.objects.catalogue import catalogue_names
from keypush.objects.table import THICKNESS
from keypush.scenario import SimulationConfig
from tests.physics.exact_shapes import EXACT, any_model, exact_model
from tests.physics.foundation import com_height, tipping_inset
from tests.physics.thrown import GRAVITY

SHAPES = pytest.mark.parametrize("name", [*EXACT, *catalogue_names()])
SHIPPED = SimulationConfig()
HARD = SimulationConfig(table_modulus=HARD_TABLE)
"""A hundred times the shipped modulus. CENIC's long steps kick pushed objects over on it, so it is
not what we ship; it shows that the meshes are true to 1 mm where the table gives nothing."""
ACROSS = [(name, i) for name in EXACT for i in (0, 1) if (name, i) != ("l_prism", 0)]
"""Directions in which an object tips straight ahead; the L tips across its slanted side."""
CORNERS = [("tall_box", 2), ("l_prism", 2)]
SETTINGS = pytest.mark.parametrize("setting", [SHIPPED, HARD], ids=["shipped", "hard"])


def stands(name: str, direction: int, outside: float, setting: SimulationConfig) -> bool:
    """Whether it stands for 3 s with its COM `outside` its support polygon by so many metres."""
    model = any_model(name)
    moved = com_beyond_edge(model, directions(model)[direction], outside)
    return ObjectScene(moved, setting).advance(3.0, 0.1) < 0.1


@pytest.mark.parametrize("direction", range(4))
@SHAPES
def test_it_stands_with_its_com_2_mm_inside(name: str, direction: int) -> None:
    """2 mm and not 1 because the shipped table is soft; only two sharp corners need more.

    The foundation itself tips a tall box 2.3 mm inside its corner.
    """
    inside = 0.0025 if (name, direction) in CORNERS else 0.002
    assert stands(name, direction, -inside, SHIPPED)


@pytest.mark.parametrize("direction", range(4))
@SHAPES
def test_it_stands_with_its_com_1_mm_inside_on_a_hard_table(name: str, direction: int) -> None:
    assert stands(name, direction, -0.001, HARD)


@SETTINGS
@pytest.mark.parametrize("direction", range(4))
@SHAPES
def test_it_falls_with_its_com_1_mm_outside(
    name: str, direction: int, setting: SimulationConfig
) -> None:
    assert not stands(name, direction, 0.001, setting)


@pytest.mark.parametrize(
    ("name", "direction"),
    [("box", 0), ("box", 1), ("tall_box", 0), ("tall_box", 1), ("l_prism", 1), ("disc", 0)],
)
def test_across_a_long_edge_it_stands_with_its_com_1_mm_inside(name: str, direction: int) -> None:
    assert stands(name, direction, -0.001, SHIPPED)


@pytest.mark.parametrize(("name", "direction"), ACROSS)
def test_it_tips_where_the_tables_stiffness_says(name: str, direction: int) -> None:
    """At the shipped setting the simulation tips up to 0.3 mm farther inside than a foundation."""
    model = exact_model(name)
    inset = tipping_inset(model, directions(model)[direction], SHIPPED.table_modulus)
    assert stands(name, direction, -inset - 0.0004, SHIPPED)
    assert not stands(name, direction, -inset + 0.0003, SHIPPED)


@SETTINGS
@pytest.mark.parametrize("name", ["box", "tall_box"])
def test_the_tables_formula_for_a_straight_edge(name: str, setting: SimulationConfig) -> None:
    model = exact_model(name)
    weight, height = model.mass * GRAVITY, com_height(model)
    edge = np.ptp(model.support_polygon[:, 1])
    stiffness = setting.table_modulus / (THICKNESS / 2)
    inset = 1.5 * np.cbrt(4 * weight * height / (9 * stiffness * edge))
    along_x = tipping_inset(model, np.array([1.0, 0.0]), setting.table_modulus)
    assert along_x == pytest.approx(inset, rel=0.03, abs=2e-5)  # it sums strips of 0.01 mm
