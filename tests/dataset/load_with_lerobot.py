"""Run by an interpreter that has lerobot: loads a data set without a network, saves what it got.

Arguments: folder of the data set, file for the arrays (npz).
"""

import socket
import sys
from pathlib import Path

import numpy as np
import torch
from lerobot.datasets.lerobot_dataset import LeRobotDataset  # type: ignore[import-not-found]


def _refuse(*_: object) -> None:
    raise OSError("a data set was to be loaded without a network")


def main(folder: Path, out: Path) -> None:
    """Loads it three ways: frame by frame, in batches, and two episodes with what follows."""
    socket.socket.connect = _refuse  # type: ignore[method-assign]  # on purpose
    data = LeRobotDataset("local/keypush", root=folder)
    loader = torch.utils.data.DataLoader(data, batch_size=10)
    batches = list(loader)
    arrays = {
        key: torch.cat([batch[key] for batch in batches]).numpy()
        for key in batches[0]
        if key != "task"
    }
    tasks = [task for batch in batches for task in batch["task"]]
    following = LeRobotDataset(
        "local/keypush", root=folder, episodes=[1, 3], delta_timestamps={"action": [0.0, 0.1]}
    )
    last = following[len(following) - 1]
    arrays |= {
        "tasks": np.array(tasks),
        "counts": np.array([len(data), data.num_episodes, data.meta.total_tasks, data.fps]),
        "chosen": np.array([len(following), following.num_episodes]),
        "first_pair": following[0]["action"].numpy(),
        "last_is_pad": last["action_is_pad"].numpy(),
        "mean": data.meta.stats["observation.state"]["mean"],
    }
    np.savez(out, allow_pickle=False, **arrays)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
