"""Grouping of many clouds at once, in PyTorch, for training; see `inference.patches`."""

import torch


def group_patches_batch(
    clouds: torch.Tensor, patches: int, patch_size: int
) -> tuple[torch.Tensor, torch.Tensor]:
    """Groups clouds (B, N, 3) as `group_patches` does.

    Returns:
        Indices (B, patches) of the centres and (B, patches, patch_size) of the members.
    """
    batch = torch.arange(len(clouds))
    start = (clouds - clouds.mean(dim=1, keepdim=True)).square().sum(-1)
    centre = start.argmax(dim=1)
    nearest = torch.full_like(start, torch.inf)
    centres, rows = [], []
    for _ in range(patches):
        row = (clouds - clouds[batch, centre][:, None]).square().sum(-1)
        nearest = torch.minimum(nearest, row)
        centres.append(centre)
        rows.append(row)
        centre = nearest.argmax(dim=1)
    distance = torch.stack(rows, dim=1)
    members = distance.topk(patch_size, dim=2, largest=False, sorted=True).indices
    return torch.stack(centres, dim=1), members
