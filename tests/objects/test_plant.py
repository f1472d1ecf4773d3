"""Object and table as they enter a Drake plant."""

import io

import numpy as np
import pytest
import trimesh
from pydrake.geometry import Mesh, Role, Shape
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
from pydrake.systems.framework import DiagramBuilder

from keypush.objects.library import make_object
from keypush.objects.plant import add_object
from keypush.objects.table import add_table
from keypush.scenario import SimulationConfig, TableConfig
from tests.objects.every_object import EVERY_OBJECT


@pytest.mark.parametrize("time_step", [0.0, 0.001])
@EVERY_OBJECT
def test_the_body_has_the_models_mass_properties(name: str, time_step: float) -> None:
    plant, _ = AddMultibodyPlant(MultibodyPlantConfig(time_step=time_step), DiagramBuilder())
    model = make_object(name, 0.75, 0.2)
    body = add_object(plant, model, 0.7)
    plant.Finalize()
    inertia = body.default_spatial_inertia()
    assert body.is_floating_base_body()
    assert inertia.get_mass() == pytest.approx(0.2)
    np.testing.assert_allclose(inertia.get_com(), model.p_OoOcm_O, atol=1e-12)
    about_com = inertia.Shift(model.p_OoOcm_O).CalcRotationalInertia().CopyToFullMatrix3()
    np.testing.assert_allclose(about_com, model.I_OOcm_O, atol=1e-12)


def test_contact_is_with_the_coarse_mesh_itself_and_rigid() -> None:
    plant, scene_graph = AddMultibodyPlant(MultibodyPlantConfig(), DiagramBuilder())
    model = make_object("mug", 1.25)
    body = add_object(plant, model, 0.55)
    inspector = scene_graph.model_inspector()
    (geometry,) = plant.GetCollisionGeometriesForBody(body)
    properties = inspector.GetProximityProperties(geometry)
    _check_same_mesh(inspector.GetShape(geometry), model.mesh)
    assert properties.HasProperty("hydroelastic", "compliance_type")
    assert not properties.HasProperty("hydroelastic", "hydroelastic_modulus")  # so it is rigid
    assert properties.GetProperty("material", "coulomb_friction").dynamic_friction() == 0.55
    frame = plant.GetBodyFrameIdOrThrow(body.index())
    (seen,) = inspector.GetGeometries(frame, Role.kIllustration)
    _check_same_mesh(inspector.GetShape(seen), model.visual)
    colour = inspector.GetIllustrationProperties(seen).GetProperty("phong", "diffuse")
    np.testing.assert_allclose(colour.rgba, model.colour)


def _check_same_mesh(shape: Shape, mesh: trimesh.Trimesh) -> None:
    assert isinstance(shape, Mesh)
    text = shape.source().in_memory().mesh_file.contents()
    found = trimesh.load_mesh(io.BytesIO(text), file_type="obj", process=False)
    np.testing.assert_allclose(found.vertices, mesh.vertices, atol=1e-9)
    np.testing.assert_array_equal(found.faces, mesh.faces)


def test_the_table_top_is_finite_compliant_and_centred_below_the_origin() -> None:
    plant, scene_graph = AddMultibodyPlant(MultibodyPlantConfig(), DiagramBuilder())
    table = TableConfig(length=0.6, width=0.3, height=0.7, friction=0.25)
    body = add_table(plant, table, SimulationConfig(table_modulus=2e7, table_margin=2e-4))
    inspector = scene_graph.model_inspector()
    top, floor = plant.GetCollisionGeometriesForBody(body)
    size = inspector.GetShape(top).size()
    X_WT = inspector.GetPoseInFrame(top)
    assert tuple(size[:2]) == (0.6, 0.3)
    np.testing.assert_allclose(X_WT.translation(), [0.0, 0.0, -size[2] / 2])
    properties = inspector.GetProximityProperties(top)
    assert properties.GetProperty("hydroelastic", "hydroelastic_modulus") == 2e7
    assert properties.GetProperty("hydroelastic", "margin") == 2e-4
    assert properties.GetProperty("material", "coulomb_friction").dynamic_friction() == 0.25
    X_WF = inspector.GetPoseInFrame(floor)
    surface = X_WF.translation()[2] + inspector.GetShape(floor).size()[2] / 2
    assert surface == pytest.approx(-0.7)


@pytest.mark.parametrize("integrator", ["cenic", "discrete"])
def test_only_cenic_foresees_contact(integrator: str) -> None:
    margin = SimulationConfig().table_margin if integrator == "cenic" else 0.0
    plant, scene_graph = AddMultibodyPlant(MultibodyPlantConfig(), DiagramBuilder())
    body = add_table(plant, TableConfig(), SimulationConfig(integrator=integrator))
    for geometry in plant.GetCollisionGeometriesForBody(body):
        properties = scene_graph.model_inspector().GetProximityProperties(geometry)
        assert properties.GetProperty("hydroelastic", "margin") == margin
