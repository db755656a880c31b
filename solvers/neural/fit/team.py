"""The processes that train together: one, or those that torchrun started."""

import os
from dataclasses import dataclass

import torch
from torch import Tensor
from torch import distributed as dist

from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.fit.plan import Device


@dataclass(frozen=True)
class Team:
    """One process of a group that trains a model together: its device and `rank`, and the group's `size`."""

    device: torch.device  # of this process
    rank: int = 0  # index of this process, and number of processes
    size: int = 1

    @property
    def leads(self) -> bool:
        """Whether this process writes files and reports."""
        return self.rank == 0

    def share(self, rows: Tensor) -> tuple[Tensor, float]:
        """Return the rows of a batch that this process computes, and their weight in the processes' mean.

        A process without rows gets the first row of the batch, with weight 0, as all must compute a step.
        """
        own = rows[self.rank :: self.size]
        if len(own) == 0:
            return rows[:1], 0.0
        return own, len(own) * self.size / len(rows)

    def mean(self, value: Tensor) -> Tensor:
        """Return the mean of `value` over the processes."""
        if self.size == 1:
            return value
        value = value.clone()
        dist.all_reduce(value)
        return value / self.size

    def close(self) -> None:
        """Leave the group of processes."""
        if self.size > 1 and dist.is_initialized():
            dist.destroy_process_group()


def team(device: Device) -> Team:
    """Return the `Team` object of this process; under torchrun, all started processes train together.

    Raises InputError if `device` is ``cuda`` and there is no such device.
    """
    if device == "cuda" and not torch.cuda.is_available():
        raise InputError("torch sees no CUDA device", "use {device} cpu or auto", parameter="device")
    cuda = device != "cpu" and torch.cuda.is_available()
    size = int(os.environ.get("WORLD_SIZE", "1"))
    local = int(os.environ.get("LOCAL_RANK", "0"))
    place = torch.device("cuda", local) if cuda else torch.device("cpu")
    if size == 1:
        return Team(place)
    if cuda:
        torch.cuda.set_device(place)
    dist.init_process_group("nccl" if cuda else "gloo")
    return Team(place, dist.get_rank(), size)
