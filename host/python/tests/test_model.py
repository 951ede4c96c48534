"""Models: EIDORS' numbers on EIDORS' own meshes, and what `dermatome export` and `reconstruct` compute of a skin."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import DISC, EIDORS, SQUARE, run
from numpy.typing import NDArray

import dermatome

# Name, and whether electrodes are complete.
MODELS = [("a2c_pem", False), ("b2C_cem", True), ("c2c_pem", False), ("c2c_cem", True), ("hemi_256_pem", False)]


def eidors(name: str) -> dict[str, NDArray[Any]]:
    with np.load(EIDORS / f"{name}.npz") as arrays:
        return dict(arrays)


def mesh_of(reference: dict[str, NDArray[Any]], is_complete: bool) -> dermatome.Mesh:
    """EIDORS counts from 1; electrodes are nodes, of which the edges of the rim are the complete model's."""
    nodes = reference["elec_nodes"].reshape(16, -1) - 1
    electrodes = list(nodes) if is_complete else [int(touched[0]) for touched in nodes]
    return dermatome.Mesh(reference["nodes"], reference["elems"] - 1, electrodes)


def error(found: NDArray[Any], expected: NDArray[Any]) -> float:
    """Largest difference over the largest value."""
    return float(np.abs(found - expected.reshape(found.shape)).max() / np.abs(expected).max())


@pytest.mark.parametrize(("name", "is_complete"), MODELS)
def test_voltages_and_jacobian_are_those_of_eidors(name: str, is_complete: bool) -> None:
    reference = eidors(name)
    mesh, steps = mesh_of(reference, is_complete), dermatome.pattern(16)
    impedance = reference["z_contact"].ravel()
    assert error(mesh.forward(steps, contact_impedance=impedance), reference["vh"]) < 1e-10
    sigma = reference["sigma_i"].ravel()
    assert error(mesh.forward(steps, sigma, impedance), reference["vi"]) < 1e-10
    assert error(mesh.jacobian(steps, None, impedance), reference["J"]) < 1e-10


def test_a_complex_conductivity_gives_complex_voltages() -> None:
    reference = eidors("c2c_cem")
    mesh, steps = mesh_of(reference, True), dermatome.pattern(16)
    impedance = float(reference["z_contact"].ravel()[0])
    real = mesh.forward(steps, contact_impedance=impedance)
    # Where all admittivities turn by the same angle, voltages turn back by it.
    turn = np.exp(0.3j)
    turned = mesh.forward(steps, np.full(len(mesh.elements), turn), impedance / turn)
    assert turned.dtype == np.complex128 and real.dtype == np.float64
    assert np.abs(turned * turn - real).max() < 1e-12 * np.abs(real).max()
    assert mesh.jacobian(steps, np.full(len(mesh.elements), turn), impedance / turn).dtype == np.complex128


def test_the_jacobian_is_the_slope_of_the_voltages() -> None:
    reference = eidors("a2c_pem")
    mesh, steps = mesh_of(reference, False), dermatome.pattern(16)
    sigma = np.linspace(0.5, 1.5, len(mesh.elements))
    step = 1e-5 * np.eye(len(sigma))[7]
    slope = (mesh.forward(steps, sigma + step) - mesh.forward(steps, sigma - step)) / 2e-5
    assert mesh.jacobian(steps, sigma)[:, 7] == pytest.approx(slope, rel=1e-6, abs=1e-9)


def test_a_mesh_gives_back_what_it_was_made_of() -> None:
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    mesh = dermatome.Mesh(square, [[0, 1, 2], [0, 2, 3]], [0, [1, 2], [[2, 3]], 3])
    assert mesh.nodes.tolist() == [[x, y, 0] for x, y in square]
    assert mesh.elements.dtype == np.int64 and mesh.elements.shape == (2, 3)
    assert [electrode.tolist() for electrode in mesh.electrodes] == [[0], [[1, 2]], [[2, 3]], [3]]
    assert mesh.electrode_centre.tolist() == [[0, 0, 0], [1, 0.5, 0], [0.5, 1, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"nodes": [[0, 0], [1, 0], [1, 1], [0, np.nan]]}, "node 3 lies nowhere"),
        ({"nodes": [[0], [1]]}, "nodes must be rows of 3 numbers"),
        ({"elements": [[0, 1, 4]]}, "elements name node 4; allowed: 0 to 3"),
        ({"elements": [[0, 1, 0.5]]}, "elements must be rows of 3 numbers"),
        ({"electrodes": [0, -1]}, "electrodes name node -1"),
        ({"electrodes": [[0, 2], 1]}, "no edge of the rim lies between"),
    ],
)
def test_a_mesh_that_is_none_is_refused(change: dict[str, Any], words: str) -> None:
    whole = {
        "nodes": [[0, 0], [1, 0], [1, 1], [0, 1]],
        "elements": [[0, 1, 2], [0, 2, 3]],
        "electrodes": [0, 1, 2, 3],
    }
    with pytest.raises(ValueError, match=words):
        dermatome.Mesh(**{**whole, **change})


def test_what_does_not_fit_a_mesh_is_refused() -> None:
    mesh = dermatome.Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]], [0, 1, 2, 3])
    with pytest.raises(ValueError, match=r"step 0 is \[0, 1, 2, 4\]; allowed: electrodes 0 to 3"):
        mesh.forward([[0, 1, 2, 4]])
    with pytest.raises(dermatome.Error, match="2 elements need as many conductivities, got 3"):
        mesh.forward([[0, 1, 2, 3]], [1, 1, 1])
    with pytest.raises(dermatome.Error, match="the system matrix is singular"):
        mesh.forward([[0, 1, 2, 3]], [1, -1])


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """What the program computes of the disc."""
    folder = tmp_path_factory.mktemp("exported") / "disc"
    ran = run("export", DISC, "--out", folder)
    assert ran.returncode == 0, ran.stderr
    contents = json.loads((folder / "export.json").read_text())
    return contents, {name: np.load(folder / entry["file"]) for name, entry in contents["arrays"].items()}


def test_a_skins_model_is_what_the_program_exports(
    disc: dermatome.Skin, exported: tuple[dict[str, Any], dict[str, NDArray[Any]]]
) -> None:
    contents, arrays = exported
    model = disc.model()
    names = [
        "voltages", "jacobian", "reconstruction_matrix", "stimulation", "step_measurement", "step_sign",
        "pixel_centre", "pixel_normal", "pixel_area",
    ]  # fmt: skip
    for name in names:
        assert np.array_equal(getattr(model, name), arrays[name]), name
    assert np.array_equal(model.mesh.nodes, arrays["nodes"])
    assert np.array_equal(model.mesh.elements, arrays["elements"])
    assert np.array_equal(np.concatenate(model.mesh.electrodes), arrays["electrode_edges"][:, 1:])
    assert model.hyperparameter == contents["hyperparameter"]
    assert disc.volts_per_unit == contents["volts_per_unit"]
    assert np.array_equal(disc.jacobian(), model.jacobian)
    assert np.array_equal(disc.forward(), model.voltages)
    assert np.array_equal(disc.steps, model.stimulation)
    assert model.noise_figure > 0


def test_difference_data_and_images_are_those_of_the_documentation(disc: dermatome.Skin) -> None:
    """docs/interchange.md, "From steps to an image"."""
    model = disc.model()
    conductivity = np.ones(len(disc.mesh().elements))
    conductivity[100:140] = 1.5
    reference, frame = disc.forward(), disc.forward(conductivity)
    mean = np.zeros((104, 208))
    mean[model.step_measurement, np.arange(208)] = model.step_sign
    mean /= np.abs(mean).sum(1, keepdims=True)
    r, v = mean @ reference, mean @ frame
    assert model.difference(frame, reference) == pytest.approx((v - r) / r, rel=1e-9, abs=1e-15)
    image = model.image(frame, reference)
    assert image == pytest.approx(model.reconstruction_matrix @ ((v - r) / r), rel=1e-9, abs=1e-12)
    several = model.image(np.stack([reference, frame]), reference)
    assert np.array_equal(several[1], image) and not several[0].any()
    with pytest.raises(ValueError, match="frame has 104 steps, the skin 208"):
        model.image(v, reference)


def test_frames_of_others_become_the_image_that_the_program_finds(disc: dermatome.Skin, tmp_path: Path) -> None:
    source = EIDORS / "c2c_cem.npz"
    reference, frames = dermatome.read_frames(f"{source}:vh"), dermatome.read_frames(f"{source}:vi")
    assert frames.shape == (1, 208)
    [image] = disc.model().image(frames, reference[0])
    report = tmp_path / "report.json"
    ran = run("reconstruct", DISC, "--reference", f"{source}:vh", "--frames", f"{source}:vi", "--json", report)
    assert ran.returncode == 0, ran.stderr
    [found] = json.loads(report.read_text())["frames"]
    assert image.max() == pytest.approx(found["peak"], rel=1e-9)


def test_a_patch_is_the_one_that_the_program_builds(tmp_path: Path) -> None:
    by_program, by_us = tmp_path / "program.dermatome", tmp_path / "us.dermatome"
    ran = run("build", SQUARE, "--output", by_program)
    assert ran.returncode == 0, ran.stderr
    patch = dermatome.Skin.load(SQUARE).build_patch(by_us)
    assert by_us.read_bytes() == by_program.read_bytes() == bytes(patch)
    assert np.array_equal(patch.steps, dermatome.Skin.load(SQUARE).steps)
    assert patch.pixel_area.sum() == pytest.approx(0.05**2, rel=1e-6)
    assert patch.pixel_normal == pytest.approx(np.tile([0, 0, 1], (784, 1)))
    assert patch.drive.frame_rate == 50
    with pytest.raises(ValueError, match="image has 3 pixels, the patch 784"):
        patch.picture([1, 2, 3])
