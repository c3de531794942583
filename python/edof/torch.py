"""Blur and the float network for PyTorch (optional: `pip install torch`).

`Blur` is an autograd function by the adjoint of `edof.blur`: gradients reach the picture, and the kernel's numbers are those of `edof.psf`. `FloatNetwork` is
the float network as a module: train it in any way, write it with `network()`, and quantize that.
"""

from __future__ import annotations

from typing import Any, Callable, Sequence, cast

import numpy as np
import torch
from torch import Tensor, nn

import edof

PATCH = 8

# z of b and theta, by the name of the shrinkage (docs/contract.md, 3.3).
SHRINKAGES: dict[str, Callable[[Tensor, Tensor], Tensor]] = {
    "two-sided": lambda b, theta: torch.sign(b) * torch.relu(b.abs() - theta),
    "one-sided": lambda b, theta: torch.relu(b - theta),
    "firm": lambda b, theta: torch.sign(b) * torch.minimum(2 * torch.relu(b.abs() - theta), b.abs()),
}


class _Blur(torch.autograd.Function):
    """Each plane with its kernel; backward by the adjoint."""

    @staticmethod
    def forward(ctx: Any, picture: Tensor, kernels: Sequence[np.ndarray[Any, Any]]) -> Tensor:
        ctx.kernels = kernels
        return _each(edof.blur, picture, kernels)

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, None]:  # type: ignore[override]
        return _each(edof.blur_adjoint, gradient, ctx.kernels), None


def _each(operator: Any, pictures: Tensor, kernels: Sequence[np.ndarray[Any, Any]]) -> Tensor:
    planes = pictures.detach().cpu().to(torch.float32).numpy()
    flat = planes.reshape(-1, *planes.shape[-3:])
    made = np.stack([operator(picture, list(kernels)) for picture in flat]).reshape(planes.shape)
    return torch.from_numpy(made).to(pictures.dtype).to(pictures.device)


class Blur(nn.Module):
    """What a camera makes of pictures at one depth: (..., 3, rows, columns) of linear light.

    The derivative by the picture is exact up to f32 rounding; those by mask and focus are not computed.
    """

    def __init__(self, camera: Any, psi: float, **settings: Any) -> None:
        super().__init__()
        self.kernels = edof.psf(camera, psi, **settings)

    def forward(self, picture: Tensor) -> Tensor:
        """Blurs every plane with the kernel of its colour."""
        return cast(Tensor, _Blur.apply(picture, self.kernels))


class FloatNetwork(nn.Module):
    """The float network of a weight file: windows (count x pixels) to patches (count x 192), as `edof.Network.forward`."""

    def __init__(self, network: edof.Network) -> None:
        super().__init__()
        self.like = network
        words = network.form.split(",")
        self.shrink = next(SHRINKAGES[word] for word in words if word in SHRINKAGES)
        self.difference = "difference" in words
        self.tied = "tied" in words
        for name, array in network.arrays().items():
            self.register_parameter(name, nn.Parameter(torch.from_numpy(array.copy())))

    def _shrunk(self, codes: Tensor, layer: int) -> Tensor:
        return self.shrink(codes, cast(Tensor, self.thresholds)[layer])

    def forward(self, windows: Tensor) -> Tensor:
        """The layers I, M and F (docs/contract.md, section 5, in floating point)."""
        first = windows @ cast(Tensor, self.analysis).T
        before, base = torch.zeros_like(first), first
        codes = self._shrunk(first, 0)
        for layer in range(1, cast(Tensor, self.thresholds).shape[0]):
            recurrent = cast(Tensor, self.recurrent)[0 if self.tied else layer - 1]
            if self.difference:
                base = base + (codes - before) @ recurrent.T
                before = codes
                codes = self._shrunk(base, layer)
            else:
                codes = self._shrunk(first + codes @ recurrent.T, layer)
        patches = codes @ cast(Tensor, self.dictionary).T
        if "linear_path" in dict(self.named_parameters()):
            patches = patches + windows @ cast(Tensor, self.linear_path).T
        return patches

    def network(self, name: str = "torch") -> edof.Network:
        """The network with the weights as they are now."""
        arrays = {name: weights.detach().cpu().to(torch.float32).numpy() for name, weights in self.named_parameters()}
        return edof.Network.from_arrays(self.like.form, arrays, like=self.like, name=name)
