# %% [markdown]
# # From a network to Verilog to a simulated board
#
# A small network is trained by least squares on its last layer, quantized, printed as Verilog, and loaded into a board in memory, whose screen then shows the
# golden picture bit for bit. (`edof train` and `edof.torch` train whole networks; minutes to hours.)

# %%
import json
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import edof

# %% [markdown]
# ## Training
# Codes of random windows are fixed features; the dictionary and the linear path are the best linear map from features and windows to patches.

# %%
camera, form = edof.Camera("ring-outer"), "one-sided,w8,t4,c16,r"
rng = np.random.default_rng(0)
analysis = (rng.normal(0.0, 1.0, (16, 64)) / 8.0).astype(np.float32)
arrays = {
    "analysis": analysis,
    "thresholds": np.full((3, 16), 0.02, np.float32),
    "recurrent": np.stack([-0.05 * np.eye(16, dtype=np.float32)] * 2),
    "dictionary": np.zeros((192, 16), np.float32),
    "linear_path": np.zeros((192, 64), np.float32),
}
untrained = edof.Network.from_arrays(form, arrays, camera=camera, name="small")
windows, patches = [], []
for seed in range(4):
    light = edof.Scene.draw("leaves", 128, 192, psi=[0.0], seed=seed).sharp()
    raw = edof.capture(light, camera, 4.0, bit_depth=16).raw
    for row in range(0, 128, 8):
        for column in range(0, 192, 8):
            windows.append(raw[row : row + 8, column : column + 8].ravel() / np.float32(65536.0))
            patches.append(light[:, row : row + 8, column : column + 8].ravel())
y, x = np.array(windows, np.float32), np.array(patches, np.float32)
# The features are what a dictionary of unit vectors gives.
probe = dict(arrays, dictionary=np.eye(192, 16, dtype=np.float32))
features = edof.Network.from_arrays(form, probe, camera=camera).forward(y)[:, :16]
both = np.hstack([features, y])
solved = np.linalg.solve(both.T @ both + 1e-2 * np.eye(80, dtype=np.float32), both.T @ x).T.astype(np.float32)
arrays["dictionary"], arrays["linear_path"] = np.ascontiguousarray(solved[:, :16]), np.ascontiguousarray(solved[:, 16:])
network = edof.Network.from_arrays(form, arrays, camera=camera, name="small")

# %% [markdown]
# ## Integers
# 12 bits, so that every sum fits the design `tiny`.

# %%
pictures = [edof.encode(edof.Scene.draw("leaves", 128, 192, psi=[0.0], seed=9).sharp(), "linear")]
fixed = network.quantize(pictures, bits=12)
truth = edof.Scene.draw("leaves", 128, 192, psi=[0.0], seed=7).sharp()
raw = edof.capture(truth, camera, 4.0, bit_depth=16).raw
print(f"float {edof.psnr(truth, edof.reconstruct(raw, network)):.2f} dB, integers {edof.psnr(truth, edof.reconstruct(raw, fixed)):.2f} dB")

# %% [markdown]
# ## Verilog and what it takes

# %%
fields = json.loads(edof.Design("tiny").json())
fields["code_bits"] = 12
design = edof.Design.from_json(json.dumps(fields))
with tempfile.TemporaryDirectory() as folder:
    manifest = design.generate(fixed, Path(folder) / "build")
estimate = design.estimate()
print(f"{len(manifest['files'])} files; {estimate['cycles_per_patch']:.0f} cycles per patch, {estimate['dsp48e1']} multipliers")

# %% [markdown]
# ## A board in memory

# %%
rows, columns = design.shape
frame = raw[:rows, :columns]
with edof.Board.simulated(design, design.random_network(1), frame) as board:
    loaded = board.load(fixed, design=design)
    board.run(0.2)
    screen = board.screen()
golden = edof.board_picture(frame, fixed)
assert screen is not None and (screen[0] == golden.y_code).all()
print(f"{loaded['words']} words loaded into bank {loaded['bank']}; the screen is golden")

# %%
figure, axes = plt.subplots(1, 3, figsize=(11, 3.2), layout="constrained")
axes[0].imshow(frame / 65535.0, cmap="gray")
axes[1].imshow(np.clip(golden.shown(), 0.0, 1.0).transpose(1, 2, 0))
axes[2].imshow(edof.encode(np.clip(truth[:, :rows, :columns], 0.0, 1.0)).transpose(1, 2, 0))
for axis, title in zip(axes, ["raw frame", "the board's screen", "scene"]):
    axis.set(title=title, xlabel="column (pixels)", ylabel="row (pixels)")
figure.savefig("board.png", dpi=80)
