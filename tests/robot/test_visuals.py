"""The visual meshes: every link has one, in the right place, small enough for a page."""

import numpy as np
import pytest
import trimesh
from pydrake.geometry import Mesh, Meshcat, MeshcatVisualizer, Role, SceneGraph
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlant, MultibodyPlantConfig
from pydrake.systems.framework import DiagramBuilder

from keypush.errors import UserError
from keypush.robot import visuals
from keypush.robot.panda import add_panda
from keypush.scenario import RobotConfig, SimulationConfig
from tests.robot.panda_oracle import package_file


@pytest.fixture(scope="module")
def scene() -> tuple[DiagramBuilder, MultibodyPlant, SceneGraph]:
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlant(MultibodyPlantConfig(time_step=0.001), builder)
    panda = add_panda(plant, RobotConfig(), SimulationConfig())
    visuals.add_panda_visuals(plant, panda)
    plant.Finalize()
    return builder, plant, scene_graph


Scene = tuple[DiagramBuilder, MultibodyPlant, SceneGraph]


@pytest.mark.parametrize(
    ("link", "name"),
    [*((f"panda_link{i}", f"link{i}") for i in range(8)), ("panda_hand", "hand")],
)
def test_mesh_fills_the_space_of_the_original(scene: Scene, link: str, name: str) -> None:
    _, plant, scene_graph = scene
    (geometry,) = plant.GetVisualGeometriesForBody(plant.GetBodyByName(link))
    shape = scene_graph.model_inspector().GetShape(geometry)
    assert isinstance(shape, Mesh)
    hull = shape.GetConvexHull()
    vertices = np.array([hull.vertex(i) for i in range(hull.num_vertices())])
    original = trimesh.load_scene(package_file(f"meshes/visual/{name}.dae")).bounds
    np.testing.assert_allclose(vertices.min(axis=0), original[0], atol=2e-3)
    np.testing.assert_allclose(vertices.max(axis=0), original[1], atol=2e-3)


def test_right_finger_mirrors_the_left(scene: Scene) -> None:
    _, plant, scene_graph = scene
    inspector = scene_graph.model_inspector()
    poses = []
    for name in ("panda_leftfinger", "panda_rightfinger"):
        (geometry,) = plant.GetVisualGeometriesForBody(plant.GetBodyByName(name))
        poses.append(inspector.GetPoseInFrame(geometry).rotation().matrix())
    np.testing.assert_allclose(poses[0] @ [0, 1, 0], -(poses[1] @ [0, 1, 0]), atol=1e-12)


def test_visuals_take_no_part_in_contact(scene: Scene) -> None:
    inspector = scene[2].model_inspector()
    assert inspector.NumGeometriesWithRole(Role.kIllustration) == 11
    assert inspector.NumGeometriesWithRole(Role.kProximity) == 5


def test_page_stays_small(scene: Scene) -> None:
    builder, _, scene_graph = scene
    meshcat = Meshcat()
    empty = len(meshcat.StaticHtml())
    MeshcatVisualizer.AddToBuilder(builder, scene_graph, meshcat)
    diagram = builder.Build()
    diagram.ForcedPublish(diagram.CreateDefaultContext())
    assert 1e6 < len(meshcat.StaticHtml()) - empty < 5e6


def test_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(visuals, "_PACKAGE", "no-such-robot-data")
    plant = MultibodyPlant(0.0)
    panda = add_panda(plant, RobotConfig(), SimulationConfig())
    with pytest.raises(UserError, match="no-such-robot-data, which is not installed"):
        visuals.add_panda_visuals(plant, panda)
