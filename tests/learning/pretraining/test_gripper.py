import numpy as np
import torch

from keypush.learning.pretraining.contact_scenes import patch_labels
from keypush.learning.pretraining.gripper import inside, nearest, way_to
from tests.learning.pretraining.panda_gripper import gripper_distances

LOW, HIGH = (-0.05, -0.13, -0.15), (0.05, 0.13, 0.03)


def _points(scenes: int, count: int) -> torch.Tensor:
    points = np.random.default_rng(0).uniform(LOW, HIGH, (scenes, count, 3))
    return torch.from_numpy(points.astype(np.float32))


def test_labels_and_distances_are_those_of_the_plants_gripper() -> None:
    p_EP = _points(8, 256)
    signed = gripper_distances(p_EP.reshape(-1, 3).double().numpy()).reshape(8, 256)
    clear = np.abs(signed) > 1e-6
    assert (signed < 0).mean() > 0.1
    np.testing.assert_array_equal(inside(p_EP).numpy()[clear], (signed < 0)[clear])
    distance, p_EG = nearest(p_EP)
    np.testing.assert_allclose(distance.numpy(), np.clip(signed, 0, None), atol=1e-6)
    np.testing.assert_allclose((p_EP - p_EG).norm(dim=-1).numpy(), distance.numpy(), atol=1e-6)
    members = torch.from_numpy(np.random.default_rng(1).integers(0, 256, (8, 16, 4)))
    expected = [[bool((row[patch] < 0).any()) for patch in some]
                for row, some in zip(signed, members.numpy(), strict=True)]  # fmt: skip
    np.testing.assert_array_equal(patch_labels(p_EP, members).bool().numpy(), np.array(expected))


def test_way_ends_where_the_point_enters() -> None:
    p_EP = _points(16, 256)
    rng = np.random.default_rng(2)
    v = torch.nn.functional.normalize(torch.from_numpy(rng.normal(size=(16, 3))).float(), dim=1)
    way = way_to(p_EP, v)
    hit = way.isfinite() & ~inside(p_EP)
    way = way.nan_to_num(posinf=0.0)[..., None]
    assert hit.sum() > 500
    assert inside(p_EP + (way + 1e-5) * v[:, None])[hit].float().mean() > 0.99  # but at the edges
    assert not inside(p_EP + (way - 1e-5) * v[:, None])[hit].any()
    along = torch.linspace(0, 0.4, 200)[:, None, None, None]
    met = inside(p_EP + along * v[:, None]).any(dim=0) & ~inside(p_EP)
    assert not (met & ~hit).any()
