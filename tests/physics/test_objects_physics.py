"""Objects on the table at our setting, each against a closed formula."""

import numpy as np
import pytest
from numpy.typing import NDArray

from keypush.objects.catalogue import catalogue_names, make_object
from keypush.objects.model import ObjectModel
from tests.physics.object_scene import FRICTION, GRAVITY, ObjectScene, with_com

NAMES = catalogue_names()
INTEGRATORS = ["cenic", "discrete"]


def outward_normals(polygon: NDArray[np.float64]) -> NDArray[np.float64]:
    edge = np.roll(polygon, -1, axis=0) - polygon
    normal = np.column_stack([edge[:, 1], -edge[:, 0]])
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def com_beyond_edge(
    model: ObjectModel, direction: NDArray[np.float64], distance: float
) -> ObjectModel:
    """Moves the COM along `direction` until it is `distance` outside its support polygon."""
    polygon, start = model.support_polygon, model.p_OoOcm_O[:2]
    normals = outward_normals(polygon)
    gap = np.sum(normals * (polygon - start), axis=1) + distance
    speed = normals @ direction
    return with_com(model, start + direction * np.min(gap[speed > 1e-9] / speed[speed > 1e-9]))


def directions(model: ObjectModel) -> list[NDArray[np.float64]]:
    """Across two sides, towards a corner, and along nothing in particular."""
    corner = model.support_polygon[0] - model.p_OoOcm_O[:2]
    return [
        np.array([1.0, 0.0]),
        np.array([0.0, -1.0]),
        corner / np.linalg.norm(corner),
        np.array([np.cos(2.2), np.sin(2.2)]),
    ]


@pytest.mark.parametrize("name", NAMES)
def test_an_object_at_rest_stays_at_rest(name: str) -> None:
    scene = ObjectScene(make_object(name))
    start = scene.pose().translation()
    assert scene.advance(5.0) < 1e-3
    assert np.linalg.norm(scene.pose().translation() - start) < 1e-5


@pytest.mark.parametrize("name", NAMES)
def test_it_stands_with_its_com_1_mm_inside_the_support_polygon(name: str) -> None:
    model = make_object(name)
    for direction in directions(model):
        assert ObjectScene(com_beyond_edge(model, direction, -0.001)).advance(3.0, 0.1) < 0.1


@pytest.mark.parametrize("name", NAMES)
def test_it_falls_with_its_com_1_mm_outside_the_support_polygon(name: str) -> None:
    model = make_object(name)
    for direction in directions(model):
        assert ObjectScene(com_beyond_edge(model, direction, 0.001)).advance(3.0, 0.3) > 0.3


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("name", ["box", "disc"])
def test_sliding_decelerates_at_mu_g(name: str, integrator: str) -> None:
    scene = ObjectScene(make_object(name), integrator)
    scene.advance(0.1)
    scene.throw(np.array([1.0, 0.0, 0.0]))
    scene.advance(0.1)
    expected = 1.0 - FRICTION * GRAVITY * 0.1
    # One step of 0.1 s is one implicit Euler step, 1 ms steps are a hundred.
    tolerance = 0.05 if integrator == "cenic" else 0.02
    assert scene.velocity()[0] == pytest.approx(expected, abs=tolerance)


def push_outcome(name: str, height: float, share: float) -> tuple[float, float]:
    """Pushes at a height with a share of the least force that moves it; tilt, distance."""
    model = make_object(name)
    scene = ObjectScene(model)
    scene.advance(0.1)
    half_base = model.support_polygon[:, 0].max()
    weight = model.mass * GRAVITY
    force = share * weight * min(FRICTION, half_base / height)
    scene.push(np.array([0.0, 0.0, height - model.rest_height]), np.array([force, 0.0, 0.0]))
    largest = scene.advance(0.4, 0.3)
    return largest, float(scene.pose().translation()[0])


def toppling_height(name: str) -> float:
    """Half base over mu: pushed above it an object topples, below it slides."""
    return float(make_object(name).support_polygon[:, 0].max() / FRICTION)


@pytest.mark.parametrize("name", ["tall_box", "candle"])
def test_a_push_above_half_base_over_mu_topples(name: str) -> None:
    tilt, _ = push_outcome(name, 1.4 * toppling_height(name), 1.3)
    assert tilt > 0.3


@pytest.mark.parametrize("name", ["tall_box", "candle", "bottle"])
def test_a_push_below_half_base_over_mu_slides(name: str) -> None:
    tilt, distance = push_outcome(name, 0.6 * toppling_height(name), 1.3)
    assert tilt < 0.05
    assert distance > 0.01


@pytest.mark.parametrize("name", ["tall_box", "candle", "bottle"])
@pytest.mark.parametrize("height", [0.8, 1.2])
def test_less_than_the_least_force_moves_nothing(name: str, height: float) -> None:
    tilt, distance = push_outcome(name, height * toppling_height(name), 0.85)
    assert tilt < 0.05
    assert abs(distance) < 0.003
