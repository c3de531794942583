# %% [markdown]
# # A lens of one's own, from PSF to picture
#
# A mask with one ring is given by its fields; its point spread functions, its contrast through focus and a captured scene follow. Cells are in the percent
# format: Jupyter (jupytext), VS Code and `python lens.py` run them alike.

# %%
import json

import matplotlib.pyplot as plt
import numpy as np

import edof

# %%
fields = json.loads(edof.Camera("ring-outer").json())
fields["name"] = "mine"
fields["rings"] = [{"inner": 0.6, "outer": 0.9, "delay": {"phase": {"rad": 5.0, "at_nm": 455.0}}}]
mine, clear = edof.Camera.from_json(json.dumps(fields)), edof.Camera("clear-mid")
print(mine, clear)

# %% [markdown]
# ## Point spread functions
# One row per camera, one column per depth; red, green and blue to the peak of each.

# %%
depths = [0.0, 2.0, 4.0, 6.0, 8.0]
figure, axes = plt.subplots(2, len(depths), figsize=(10, 5), layout="constrained")
for row, camera in enumerate([mine, clear]):
    for column, psi in enumerate(depths):
        side = 21
        sheet = np.zeros((side, side, 3))
        for channel, kernel in enumerate(edof.psf(camera, psi)):
            half = min(side, kernel.shape[0]) // 2
            middle, own = side // 2, kernel.shape[0] // 2
            part = kernel[own - half : own + half + 1, own - half : own + half + 1]
            sheet[middle - half : middle + half + 1, middle - half : middle + half + 1, channel] = part / part.max()
        axes[row, column].imshow(sheet**0.5, extent=(-10.5, 10.5, -10.5, 10.5))
        axes[row, column].set_title(f"{camera.name}, ψ = {psi:g} rad", fontsize=9)
        axes[row, column].set_xlabel("pixels", fontsize=8)
figure.suptitle("Point spread functions, square root of the intensity")
figure.savefig("lens-psf.png", dpi=80)

# %% [markdown]
# ## Contrast
# At a quarter of the lens's limit. A coded lens keeps contrast in one colour where another has none.

# %%
figure, axes = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained", sharey=True)
frequency = np.array([140.0])
psis = np.linspace(0.0, 8.0, 17)
for axis, camera in zip(axes, [mine, clear]):
    for channel in ("red", "green", "blue"):
        contrast = [edof.mtf(camera, psi, channel, cycles_per_mm=frequency)[1][0] for psi in psis]
        axis.plot(psis, contrast, color=f"tab:{channel}", label=channel)
    axis.set(title=f"{camera.name}: contrast at 140 cycles per mm", xlabel="ψ (rad)", ylabel="MTF (1)")
    axis.legend()
figure.savefig("lens-contrast.png", dpi=80)

# %% [markdown]
# ## A scene at four depths, and its raw frame
# The clear lens is sharp at its focus alone. The picture behind the coded lens is reconstructed by the network that was trained for `ring-outer`.

# %%
scene = edof.Scene.draw("chart-4", 192, 288, camera=mine)
clear_shot = edof.capture(scene, clear, bit_depth=12, noise="sensor:gain=1")
coded_shot = edof.capture(scene, "ring-outer", bit_depth=12, noise="sensor:gain=1")
sharp = edof.reconstruct(coded_shot.raw, "edof-t4w12-outer-light", bit_depth=12)
shown = {
    "scene": scene.sharp(),
    "clear lens": edof.demosaic(clear_shot.raw, bit_depth=12),
    "ring-outer": edof.demosaic(coded_shot.raw, bit_depth=12),
    "ring-outer, reconstructed": sharp,
}
figure, axes = plt.subplots(2, 2, figsize=(10, 7), layout="constrained")
for axis, (name, light) in zip(axes.flat, shown.items()):
    axis.imshow(edof.encode(np.clip(light, 0.0, 1.0)).transpose(1, 2, 0))
    db = edof.psnr(scene.sharp(), light)
    axis.set(title=name if name == "scene" else f"{name}: {db:.1f} dB", xlabel="column (pixels)", ylabel="row (pixels)")
figure.savefig("lens-pictures.png", dpi=80)
assert edof.psnr(scene.sharp(), sharp) > edof.psnr(scene.sharp(), shown["ring-outer"])
