"""How well a contact network tells which patches touch."""

from collections.abc import Iterable
from typing import Any

import torch
from torchmetrics.functional.classification import (
    binary_average_precision,
    binary_calibration_error,
    binary_f1_score,
)

from keypush.learning.pretraining.contact_scenes import ContactBatch
from keypush.networks.contact_network import ContactNetwork

BINS = 10
"""Of probability, for the calibration."""


def score_network(network: ContactNetwork, batches: Iterable[ContactBatch]) -> dict[str, Any]:
    """Scores a network on scenes; see `score`."""
    device = next(network.parameters()).device
    logits, labels = [], []
    with torch.inference_mode():
        for *scene, label in batches:
            logits.append(network(*(part.to(device) for part in scene)).float().cpu())
            labels.append(label)
    return score(torch.cat(logits), torch.cat(labels))


def score(logits: torch.Tensor, labels: torch.Tensor) -> dict[str, Any]:
    """Sums up logits and labels (n, patches) of n scenes, over all of their patches.

    Returns:
        Scenes, shares of scenes and of patches in contact, mean binary cross-entropy, average
        precision, F1 at probability 0.5, expected calibration error over `BINS` equal bins, and
        the reliability of every bin that is not empty.
    """
    probability, truth = logits.flatten().sigmoid(), labels.flatten().int()
    loss = torch.nn.functional.binary_cross_entropy_with_logits(logits, labels)
    return {
        "scenes": len(labels),
        "scenes_in_contact": float(labels.any(dim=1).float().mean()),
        "patches_in_contact": float(labels.mean()),
        "bce": float(loss),
        "average_precision": float(binary_average_precision(probability, truth)),
        "f1": float(binary_f1_score(probability, truth)),
        "calibration_error": float(binary_calibration_error(probability, truth, n_bins=BINS)),
        "reliability": reliability(probability, truth),
    }


def reliability(probability: torch.Tensor, truth: torch.Tensor) -> list[dict[str, float]]:
    """What was predicted and what was so, by bins of the predicted probability (n,)."""
    bins = (probability * BINS).long().clamp_max(BINS - 1)
    rows = []
    for i in range(BINS):
        chosen = bins == i
        if chosen.any():
            rows.append({
                "from": i / BINS,
                "patches": int(chosen.sum()),
                "predicted": float(probability[chosen].mean()),
                "observed": float(truth[chosen].float().mean()),
            })  # fmt: skip
    return rows
