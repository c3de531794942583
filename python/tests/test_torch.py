"""edof.torch: the blur's gradient, and the float network as a module. Run by scripts/test-torch.sh, where PyTorch is installed."""

from pathlib import Path

import numpy as np
import pytest

import edof

torch = pytest.importorskip("torch")


def test_the_blur_has_the_gradient_of_its_adjoint() -> None:
    from edof.torch import Blur

    for camera in ["ring-2018", edof.Camera("ring-outer").with_aberrations({7: 120.0})]:
        blur = Blur(camera, 5.0)
        picture = torch.rand(3, 8, 10, dtype=torch.float64, requires_grad=True)
        # The blur is linear, so a step of any size gives its derivative; a large one, since it computes in f32.
        assert torch.autograd.gradcheck(blur, (picture,), eps=1.0, atol=1e-5, rtol=1e-3)
        batch = torch.rand(2, 3, 8, 10)
        assert torch.equal(blur(batch)[1], blur(batch[1]))
        assert np.array_equal(blur(batch[0]).numpy(), edof.blur(batch[0].numpy(), blur.kernels))


def form(words: str, seed: int) -> edof.Network:
    """A network of that form with random weights."""
    rng = np.random.default_rng(seed)
    layers = int(words.split(",t")[1].split(",")[0])
    window = 144 if "w12" in words else 64
    arrays = {
        "analysis": rng.normal(0.0, 0.1, (24, window)).astype(np.float32),
        "thresholds": rng.uniform(0.0, 0.1, (layers - 1, 24)).astype(np.float32),
        "dictionary": rng.normal(0.0, 0.2, (192, 24)).astype(np.float32),
    }
    if layers > 2:
        arrays["recurrent"] = rng.normal(0.0, 0.1, (1 if "tied" in words else layers - 2, 24, 24)).astype(np.float32)
    if words.endswith(",r"):
        arrays["linear_path"] = rng.normal(0.0, 0.1, (192, window)).astype(np.float32)
    return edof.Network.from_arrays(words, arrays, camera="clear")


@pytest.mark.parametrize("words", ["one-sided,w12,t4,c24,r", "two-sided,w8,t4,c24", "two-sided,w8,t5,c24,difference,r", "one-sided,w8,t6,c24,tied,r", "two-sided,w8,t2,c24,r", "firm,w8,t4,c24,r"])
def test_the_module_computes_what_the_network_does(words: str, tmp_path: Path) -> None:
    from edof.torch import FloatNetwork

    network = form(words, 3)
    module = FloatNetwork(network)
    windows = np.random.default_rng(0).random((50, network.window**2), np.float32)
    found = module(torch.from_numpy(windows)).detach().numpy()
    assert np.abs(found - network.forward(windows)).max() < 1e-5
    back = module.network("back")
    back.save(tmp_path / "back.safetensors")
    loaded = edof.Network.load(tmp_path / "back.safetensors")
    assert np.array_equal(loaded.forward(windows), network.forward(windows))


def test_a_trained_network_of_ours_comes_back_after_a_step() -> None:
    from edof.torch import FloatNetwork

    network = edof.Network.load("edof-t4w12-outer-light")
    module = FloatNetwork(network)
    windows = torch.rand(20, 144)
    assert np.abs(module(windows).detach().numpy() - network.forward(windows.numpy())).max() < 1e-5
    optimiser = torch.optim.SGD(module.parameters(), lr=1e-3)
    module(windows).square().mean().backward()
    optimiser.step()
    changed = module.network()
    assert np.abs(module(windows).detach().numpy() - changed.forward(windows.numpy())).max() < 1e-5
    assert not np.array_equal(changed.arrays()["dictionary"], network.arrays()["dictionary"])
