# %% [markdown]
# # A finger on a simulated skin
#
# From a skin file to an image, and back from voltages that EIDORS computed. Run it in the repository's root, as a notebook
# (VS Code and Jupyter with jupytext read the cells) or as a program: `python host/python/examples/press.py`.

# %%
from itertools import islice

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import ArrayLike

import dermatome

# %% [markdown]
# A skin file describes a sheet with electrodes; its model is computed once, in a tenth of a second.

# %%
skin = dermatome.Skin.load("models/disc-210mm/skin.toml")
model = skin.model()
patch = skin.build_patch()
print(skin, model, patch, sep="\n")

mesh = model.mesh
plt.figure(figsize=(4, 4))
plt.triplot(mesh.nodes[:, 0], mesh.nodes[:, 1], mesh.elements, linewidth=0.3)
plt.plot(*mesh.electrode_centre[:, :2].T, "o")
plt.axis("equal")
plt.title("mesh and electrodes, m")
plt.show()

# %% [markdown]
# A simulated board measures a simulated skin, on which a finger rests while the board streams. A real one opens with
# `dermatome.open("/dev/ttyACM0")`, and everything else stays.

# %%
finger = (0.04, 0.03, 0.0126, 1.0)  # x, y, radius in m, relative change of conductivity
with dermatome.simulate(skin, [finger]) as board:
    print(board.info)
    board.tare()
    frames = list(islice(board.stream(measurements=True), 50))

last = frames[-1]
assert last.image is not None and last.contacts is not None
for contact in last.contacts:
    x, y, _ = contact["position"] * 1e3
    print(f"contact {contact['id']} at ({x:.1f}, {y:.1f}) mm, {contact['significance']:.0f} deviations above the noise")

# %% [markdown]
# An image is one number for each pixel. `picture` lays the pixels of a flat skin onto their grid.


# %%
def show(image: ArrayLike, title: str) -> None:
    picture = patch.picture(image)
    assert picture is not None
    plt.figure(figsize=(4, 4))
    plt.imshow(picture, extent=patch.extent)
    plt.colorbar(label="relative change of conductivity")
    plt.title(title)


show(last.image, "the board's image")
plt.plot(last.contacts["position"][:, 0], last.contacts["position"][:, 1], "w+")
plt.show()

# %% [markdown]
# The same from the frames' codes, in double precision: their mean against that of an untouched skin. `model.image` is
# `reconstruction_matrix @ difference`.

# %%
with dermatome.simulate(skin, []) as board:
    untouched = list(islice(board.stream(images=False, measurements=True), 50))
reference = np.mean([frame.measurements for frame in untouched if frame.measurements is not None], axis=0)
pressed = np.mean([frame.measurements for frame in frames[20:] if frame.measurements is not None], axis=0)

image = model.image(pressed, reference)
assert np.allclose(image, model.reconstruction_matrix @ model.difference(pressed, reference))
print(f"strongest pixel at {1e3 * model.pixel_centre[np.argmax(image)][:2]} mm")

# %% [markdown]
# Voltages of others: EIDORS computed these for a disc with a spot that conducts better, at (41.7, 31.8) mm, and one that
# conducts worse. Any drive pattern, mesh or instrument will do that the skin file describes.

# %%
source = "host/tests/data/eidors/c2c_cem.npz"
vh, vi = dermatome.read_frames(f"{source}:vh"), dermatome.read_frames(f"{source}:vi")
[from_eidors] = model.image(vi, vh[0])
show(from_eidors, "EIDORS' voltages")
plt.show()
x, y, _ = 1e3 * model.pixel_centre[np.argmax(from_eidors)]
print(f"the better spot's strongest pixel is at ({x:.1f}, {y:.1f}) mm")
