"""Dermatome: a pressure-sensing robot skin by electrical impedance tomography, with NumPy.

    with dermatome.open("sim:skin.toml") as board:      # or /dev/ttyACM0, tcp:HOST:PORT, replay:run.mcap
        board.tare()
        for frame in board.stream():
            print(frame.contacts["position"], frame.contacts["force"])

    recording = dermatome.Recording("run.mcap")         # arrays, a row for each frame
    model = dermatome.Skin.load("skin.toml").model()    # mesh, Jacobian, reconstruction matrix

Units are SI; everything counts from 0. What goes wrong is a `dermatome.Error`, in the words of the command `dermatome`.
"""

from ._native import (
    CONTACT,
    FRAME,
    NO_CODE,
    Arrays,
    Board,
    Drive,
    Error,
    Frame,
    Health,
    Info,
    Mesh,
    Model,
    Patch,
    Pose,
    Recording,
    RecordingIterator,
    Skin,
    Stream,
    __version__,
    open,
    pattern,
    read_frames,
    simulate,
)

__all__ = [
    "CONTACT",
    "FRAME",
    "NO_CODE",
    "Arrays",
    "Board",
    "Drive",
    "Error",
    "Frame",
    "Health",
    "Info",
    "Mesh",
    "Model",
    "Patch",
    "Pose",
    "Recording",
    "RecordingIterator",
    "Skin",
    "Stream",
    "__version__",
    "open",
    "pattern",
    "read_frames",
    "simulate",
]
