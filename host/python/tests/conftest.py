"""What the tests have in common: the repository's skins, the program, and a recording that it has made."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

import dermatome

ROOT = Path(__file__).resolve().parents[3]
DISC = ROOT / "models" / "disc-210mm" / "skin.toml"
SQUARE = ROOT / "models" / "square-50mm" / "skin.toml"
EIDORS = ROOT / "host" / "tests" / "data" / "eidors"
# A third of a turn about the diagonal, and a shift.
POSE = '\n[pose]\nlink = "wrist_3"\nposition = ["120 mm", -0.03, "0.5 m"]\norientation = [0.5, 0.5, 0.5, 0.5]\n'


def program() -> str:
    """The program `dermatome`."""
    path = os.environ.get("DERMATOME")
    if path is None:
        pytest.skip("not run: DERMATOME names no program")
    return path


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Runs the program."""
    return subprocess.run([program(), *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True)


@dataclass
class Recorded:
    """A recording, and what the program printed while it was made."""

    path: Path
    skin_file: Path
    printed: list[str]


def record(folder: Path, skin_file: Path, *options: str | Path) -> Recorded:
    path = folder / "run.mcap"
    ran = run("stream", "--port", f"sim:{skin_file}", "--frames", "100", "--record", path, *options)
    assert ran.returncode == 0, ran.stderr
    return Recorded(path, skin_file, ran.stdout.splitlines())


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    """Of a skin by itself."""
    return record(tmp_path_factory.mktemp("recorded"), SQUARE)


@pytest.fixture(scope="session")
def recorded_on_link(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    """Of a skin that lies on a robot's link."""
    folder = tmp_path_factory.mktemp("on-link")
    skin_file = folder / "skin.toml"
    skin_file.write_text(SQUARE.read_text() + POSE)
    return record(folder, skin_file, "--skin", skin_file)


@pytest.fixture(scope="session")
def disc() -> dermatome.Skin:
    return dermatome.Skin.load(DISC)
