# %% [markdown]
# # Speed against error in ten lines
#
# Every method on the same raw frame: PSNR against CPU seconds per megapixel.

# %%
import time

import matplotlib.pyplot as plt

import edof

# %%
truth = edof.Scene.draw("leaves", 256, 384, psi=[0.0], seed=5).sharp()
raw = edof.capture(truth, "ring-outer", 6.0, bit_depth=16, noise="sensor:gain=1").raw
fixed, network = edof.FixedNetwork.load("edof-t4w12-outer-light"), edof.Network.load("edof-t4w12-outer-light")
kernels = edof.psf("ring-outer", 6.0)
methods = {f"network, stride {stride}": lambda stride=stride: edof.reconstruct(raw, network, stride=stride) for stride in (8, 4, 2)}
methods |= {"integers": lambda: edof.reconstruct(raw, fixed), "demosaicing": lambda: edof.demosaic(raw)}
methods["demosaicing and Wiener"] = lambda: __import__("numpy").stack(
    [edof.wiener(plane, kernel, noise_to_contrast=0.01) for plane, kernel in zip(edof.demosaic(raw), kernels)]
)
rows = []
for name, method in methods.items():
    start = time.process_time()
    rows.append((name, edof.psnr(truth, method()), (time.process_time() - start) / (raw.size / 1e6)))

# %%
figure, axis = plt.subplots(figsize=(8, 4.2), layout="constrained")
for name, db, seconds in rows:
    axis.semilogx(seconds, db, "o")
    axis.annotate(name, (seconds, db), textcoords="offset points", xytext=(6, 4), fontsize=8)
    print(f"{name:24} {db:6.2f} dB {seconds:8.3f} s per megapixel")
axis.set(xlabel="CPU time (s per megapixel)", ylabel="PSNR (dB, light)", title="Leaves behind ring-outer at ψ = 6 rad")
axis.margins(x=0.45)
figure.savefig("speed.png", dpi=80)
assert rows[0][1] > rows[-2][1], "the network is better than demosaicing"
