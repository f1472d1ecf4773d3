import dataclasses

import numpy as np
import pytest
import torch

from keypush.learning.pretraining.config import PretrainConfig
from keypush.learning.pretraining.contact_bank import draw_bank
from keypush.learning.pretraining.contact_objects import ContactObjects, contact_objects
from keypush.learning.pretraining.contact_scenes import ContactBatches
from keypush.learning.pretraining.gripper import inside
from keypush.learning.pretraining.random_scenes import random_scenes
from keypush.learning.pretraining.rotations import random_rotations, tool_rotations
from keypush.learning.pretraining.task_scenes import task_scenes
from keypush.networks.config import EncoderConfig
from keypush.networks.normalisation import LENGTH
from keypush.objects.library import make_object
from keypush.planning.push_frame import tool_rotation
from keypush.seeding import make_generator

CONFIG = PretrainConfig(batch=32, clouds_per_object=4)
DRAW = (3, "test")


@pytest.fixture(scope="module")
def objects() -> ContactObjects:
    return contact_objects(["mug", "book", "candle"])


def _bank_points(objects: ContactObjects, config: PretrainConfig, count: int) -> torch.Tensor:
    bank = draw_bank(objects, count, config, make_generator(0, 0, "test"))
    return bank.surface.repeat(-(-count // len(bank.surface)), 1, 1)[:count]


def test_draws_follow_from_seed_draw_and_number(objects: ContactObjects) -> None:
    batches = list(ContactBatches(objects, CONFIG, DRAW, 80))
    assert [len(batch[-1]) for batch in batches] == [32, 32, 16]
    (again,) = ContactBatches(objects, CONFIG, DRAW, 80, torch.tensor([1]))
    for one, other in zip(batches[1], again, strict=True):
        assert torch.equal(one, other)
    for draw, config in (((4, "test"), CONFIG), (DRAW, dataclasses.replace(CONFIG, seed=1))):
        different = next(iter(ContactBatches(objects, config, draw, 80)))
        assert not torch.equal(different[0], batches[0][0])


@pytest.mark.parametrize("encoder", [EncoderConfig(patch_size=16), EncoderConfig(patch_size=32)])
def test_shapes_are_the_encoders(objects: ContactObjects, encoder: EncoderConfig) -> None:
    config = dataclasses.replace(CONFIG, encoder=encoder)
    (batch,) = ContactBatches(objects, config, DRAW, 8)
    cloud, centres, members, hand, label = batch
    assert cloud.shape == (8, 512, 3)
    assert centres.shape == label.shape == (8, encoder.patches)
    assert members.shape == (8, encoder.patches, encoder.patch_size)
    assert hand.shape == (8, 9)
    torch.testing.assert_close(hand[:, 3:6].norm(dim=1), torch.ones(8))
    torch.testing.assert_close(
        (hand[:, 3:6] * hand[:, 6:]).sum(dim=1), torch.zeros(8), atol=1e-5, rtol=0
    )


def test_labels_are_those_of_points_without_noise(objects: ContactObjects) -> None:
    quiet = dataclasses.replace(CONFIG, cloud_deviation=0.0)
    (batch,) = ContactBatches(objects, dataclasses.replace(quiet, batch=512), DRAW, 512)
    cloud, _, members, hand, label = batch
    R_WE = torch.stack(
        [hand[:, 3:6], hand[:, 6:], torch.linalg.cross(hand[:, 3:6], hand[:, 6:])], dim=2
    )
    touching = inside(torch.bmm((cloud - hand[:, None, :3]) * LENGTH, R_WE))
    rows = torch.arange(len(cloud))[:, None, None]
    assert (touching[rows, members].any(dim=2).float() == label).float().mean() > 0.999
    # Sizes vary, so do the classes: neither of them is rare.
    assert 0.45 < label.any(dim=1).float().mean() < 0.75
    assert 0.15 < label.mean() < 0.5


def test_random_scenes_overlap_as_configured(objects: ContactObjects) -> None:
    sharp = dataclasses.replace(
        CONFIG, overlap_mean=0.002, overlap_deviation=0.0, shift_deviation=0.0
    )
    p_OP = _bank_points(objects, sharp, 256)
    poses = random_scenes(p_OP, sharp, torch.Generator().manual_seed(0))
    touching = inside(poses.to_hand(p_OP))
    assert touching.any(dim=1).float().mean() > 0.9
    apart = random_scenes(
        p_OP, dataclasses.replace(sharp, overlap_mean=-0.002), torch.Generator().manual_seed(0)
    )
    assert inside(apart.to_hand(p_OP)).any(dim=1).float().mean() < 0.3  # those that began inside
    lowest = poses.to_world(p_OP)[..., 2].amin(dim=1)
    assert lowest.min() >= -1e-5
    assert lowest.max() <= 0.1 + 1e-5


def test_task_scenes_stand_on_the_table_and_are_pushed(objects: ContactObjects) -> None:
    config = dataclasses.replace(CONFIG, size_variation=0.0)
    p_OP = _bank_points(objects, config, 300)
    rng = torch.Generator().manual_seed(0)
    index = torch.arange(len(objects.names)).repeat_interleave(CONFIG.clouds_per_object)
    index = index.repeat(300 // len(index))
    R_rest, height = objects.rest(index, rng)
    poses = task_scenes(p_OP, R_rest, height, rng)
    for k, name in enumerate(objects.names):
        vertices = torch.from_numpy(make_object(name).vertices).float()
        chosen = index == k
        bottoms = (vertices @ poses.R_WO[chosen].transpose(1, 2))[..., 2].amin(dim=1)
        torch.testing.assert_close(
            bottoms + poses.p_WO[chosen, 2], torch.zeros(100), atol=3e-4, rtol=0
        )
    assert (poses.p_WO[:, :2].abs() <= torch.tensor([0.16, 0.20])).all()
    pitch = torch.rad2deg(torch.asin(-poses.R_WE[:, 2, 2]))
    assert pitch.min() >= 49.9
    assert 0.2 < inside(poses.to_hand(p_OP)).any(dim=1).float().mean() < 0.6


def test_tool_rotations_are_the_planners() -> None:
    d_W = np.array([0.6, -0.8, 0.0])
    for pitch, side, yaw in ((1.0, 1, 1.2), (0.7, -1, np.pi / 2)):
        one = [torch.tensor([v], dtype=torch.float32) for v in (pitch, side, yaw)]
        many = tool_rotations(torch.from_numpy(d_W).float()[None], *one)
        expected = tool_rotation(d_W, pitch, side, yaw).matrix()
        np.testing.assert_allclose(many[0].numpy(), expected, atol=1e-6)


def test_random_rotations_are_rotations() -> None:
    R = random_rotations(1000, torch.Generator().manual_seed(0))
    torch.testing.assert_close(
        R @ R.transpose(1, 2), torch.eye(3).expand(1000, 3, 3), atol=1e-5, rtol=0
    )
    torch.testing.assert_close(torch.linalg.det(R), torch.ones(1000), atol=1e-5, rtol=0)
    assert R.mean(dim=0).abs().max() < 0.06
