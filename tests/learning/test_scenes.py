import dataclasses

import numpy as np
import pytest
import torch

from keypush.dataset.poses import rotations
from keypush.learning.clouds import CloudBank, draw_clouds, surface_samplers
from keypush.learning.config import TrainingConfig
from keypush.learning.goal_frame import GoalFrames
from keypush.learning.inference.goal_frame import GoalFrame
from keypush.learning.labels import make_labels
from keypush.learning.rows import Rows, read_rows
from keypush.learning.scenes import SceneBatch, augment, scene_table, to_network, with_clouds
from tests.learning.scenes import SMALL
from tests.learning.synthetic import write_data

NO_COLUMNS = ("objects", "seeds")
CONFIG = TrainingConfig(cloud_deviation=0.0, clouds_per_object=2, cloud_points=256, network=SMALL)


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> Rows:
    objects = [("l_block", 1.0), ("block", 0.75)]
    rows = read_rows(write_data(tmp_path_factory.mktemp("data"), objects, episodes=8))
    labels = make_labels(rows, "analytic")
    kept = np.isfinite(labels[:, 0])
    columns = {name: value[kept] for name, value in vars(rows).items() if name not in NO_COLUMNS}
    return dataclasses.replace(rows, **{**columns, "target": labels[kept]})


@pytest.fixture(scope="module")
def bank(rows: Rows) -> CloudBank:
    return draw_clouds(surface_samplers(rows.objects), CONFIG, np.random.default_rng(0))


@pytest.fixture
def batch(rows: Rows, bank: CloudBank) -> SceneBatch:
    table = scene_table(rows, rows.target)
    return with_clouds(table, bank, torch.Generator().manual_seed(0))


def test_scenes_are_centred_and_goal_aligned(rows: Rows, batch: SceneBatch) -> None:
    distance = np.linalg.norm(rows.goal - rows.com[:, :2], axis=1)
    np.testing.assert_allclose(batch.goal[:, 0], distance, atol=1e-6)
    np.testing.assert_allclose(batch.goal[:, 1:], 0.0, atol=1e-6)
    np.testing.assert_allclose(batch.com[:, :2], 0.0, atol=1e-6)
    # The analytic contact lies behind the COM, on the line of push.
    np.testing.assert_allclose(batch.label[:, 1], 0.0, atol=1e-6)
    assert (batch.label[:, 0] < 0).all()


def test_clouds_lie_on_the_table_at_the_rows_poses(rows: Rows, batch: SceneBatch) -> None:
    np.testing.assert_allclose(batch.cloud[:, :, 2].amin(dim=1), 0.0, atol=2e-3)
    # The first object's COM is off its origin: compare with the pose, not with the mean.
    table = scene_table(rows, rows.target)
    p_COo = rows.object_pose[:, 4:] - rows.com
    np.testing.assert_allclose(
        np.linalg.norm(table.p_CO[:, :2], axis=1), np.linalg.norm(p_COo[:, :2], axis=1), atol=1e-6
    )
    tool = rotations(rows.tool_pose)
    np.testing.assert_allclose(table.hand[:, 5], tool[:, 2, 0], atol=1e-6)
    np.testing.assert_allclose(table.hand[:, 8], tool[:, 2, 1], atol=1e-6)


def test_patches_were_grouped_on_the_cloud_itself(batch: SceneBatch) -> None:
    scene, _ = to_network(batch, use_com=False)
    centre = torch.take_along_dim(scene.cloud, scene.centres[:, :, None], dim=1)
    offset = (scene.cloud[:, None] - centre[:, :, None]).norm(dim=3)
    found = torch.take_along_dim(offset, scene.members, dim=2)
    nearest = offset.sort(dim=2).values[:, :, : found.shape[2]]
    torch.testing.assert_close(found, nearest, atol=1e-4, rtol=0)


def test_augmented_labels_stay_on_the_line_of_push_at_their_height(batch: SceneBatch) -> None:
    warped = augment(batch, torch.Generator().manual_seed(1))
    assert not torch.allclose(warped.cloud, batch.cloud, atol=1e-3)
    torch.testing.assert_close(warped.label[:, 1:], batch.label[:, 1:], atol=1e-6, rtol=0)
    torch.testing.assert_close(warped.goal, batch.goal)
    assert (warped.label[:, 0] < 0).all()


def test_augmentation_takes_a_surface_point_with_the_surface(batch: SceneBatch) -> None:
    marked = SceneBatch(**{**vars(batch), "label": batch.cloud[:, 17]})
    warped = augment(marked, torch.Generator().manual_seed(2))
    torch.testing.assert_close(warped.label, warped.cloud[:, 17])


def test_augmented_hands_keep_their_place_at_the_label(batch: SceneBatch) -> None:
    warped = augment(batch, torch.Generator().manual_seed(3))
    before, after = batch.hand[:, :3] - batch.label, warped.hand[:, :3] - warped.label
    torch.testing.assert_close(before.abs(), after.abs(), atol=1e-6, rtol=0)
    axes = warped.hand[:, 3:].reshape(-1, 2, 3)
    torch.testing.assert_close(axes @ axes.mT, torch.eye(2).expand(len(axes), 2, 2))
    # Mirrored or not, the tool still points down.
    torch.testing.assert_close(
        torch.linalg.cross(axes[:, 0], axes[:, 1])[:, 2], -torch.ones(len(axes))
    )


@pytest.mark.parametrize("use_com", [False, True])
def test_network_frame_is_metres_over_length(batch: SceneBatch, use_com: bool) -> None:
    scene, label = to_network(batch, use_com=use_com)
    frames = GoalFrames.of(batch.com if use_com else batch.cloud.mean(dim=1), batch.goal)
    each = zip(frames.origin.numpy(), frames.R_WG.numpy(), label.numpy(), strict=True)
    restored = [GoalFrame(origin, R_WG).to_world(p_G) for origin, R_WG, p_G in each]
    np.testing.assert_allclose(restored, batch.label, atol=1e-6)
    centre = scene.com if use_com else scene.cloud.mean(dim=1)
    torch.testing.assert_close(centre[:, :2], torch.zeros_like(centre[:, :2]), atol=1e-5, rtol=0)
    torch.testing.assert_close(scene.goal[:, 1], torch.zeros(len(scene.goal)), atol=1e-5, rtol=0)
    assert (scene.goal[:, 0] > 0).all()
