"""What goes wrong says so in the words of the command."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest
from conftest import DISC, SQUARE, run

import dermatome


def words_of(*arguments: str | Path) -> str:
    """What the program says in the end."""
    ran = run(*arguments)
    assert ran.returncode != 0
    return ran.stderr.strip().removeprefix("error: ")


def test_ports_that_are_none() -> None:
    for port in ["usb:1", "tcp:", "sim:", "replay:"]:
        with pytest.raises(dermatome.Error, match=f"`{port}`.*allowed"):
            dermatome.open(port)


def test_a_serial_port_that_is_not_there() -> None:
    with pytest.raises(dermatome.Error) as raised:
        dermatome.open("/dev/ttyNOWHERE")
    assert str(raised.value) == "port `/dev/ttyNOWHERE` does not exist"
    assert words_of("tare", "--port", "/dev/ttyNOWHERE").startswith(str(raised.value))


def test_a_tcp_port_where_nobody_listens() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = f"tcp:127.0.0.1:{free.getsockname()[1]}"
    with pytest.raises(dermatome.Error) as raised:
        dermatome.open(port)
    assert str(raised.value) == words_of("tare", "--port", port)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("missing.toml", None),
        ("no-toml.toml", "name = ["),
        ("wrong.toml", SQUARE.read_text().replace("count = 16", "count = 3")),
        ("not-made.toml", SQUARE.read_text().replace("columns = 28", "columns = 0")),
    ],
)
def test_skin_files(tmp_path: Path, name: str, text: str | None) -> None:
    path = tmp_path / name
    if text is not None:
        path.write_text(text)
    with pytest.raises(dermatome.Error) as raised:
        dermatome.Skin.load(path).build_patch()
    assert str(path) in str(raised.value)
    assert str(raised.value) == words_of("build", path, "--output", tmp_path / "patch.dermatome")
    with pytest.raises(dermatome.Error) as simulated:
        dermatome.open(f"sim:{path}")
    assert str(simulated.value) == str(raised.value)


def test_recordings(tmp_path: Path) -> None:
    for name, content in [("missing.mcap", None), ("text.mcap", b"no recording"), ("empty.mcap", b"")]:
        path = tmp_path / name
        if content is not None:
            path.write_bytes(content)
        with pytest.raises(dermatome.Error) as raised:
            dermatome.Recording(path)
        with pytest.raises(dermatome.Error) as played:
            dermatome.open(f"replay:{path}")
        assert str(played.value) == str(raised.value)
        assert str(raised.value) == words_of("stream", "--port", f"replay:{path}")


def test_patches(tmp_path: Path) -> None:
    path = tmp_path / "patch.dermatome"
    with pytest.raises(dermatome.Error, match="cannot read patch file `.*patch.dermatome`"):
        dermatome.Patch.load(path)
    path.write_bytes(b"no patch")
    with pytest.raises(dermatome.Error) as raised:
        dermatome.Patch.load(path)
    assert str(raised.value) in words_of("inspect", path)


def test_frames_of_others(tmp_path: Path) -> None:
    path = tmp_path / "frames.csv"
    with pytest.raises(dermatome.Error) as raised:
        dermatome.read_frames(path)
    assert str(raised.value) in words_of("reconstruct", DISC, "--frames", path, "--reference", path)


def test_a_closed_board_says_so() -> None:
    board = dermatome.simulate(SQUARE)
    board.close()
    board.close()
    with pytest.raises(dermatome.Error, match="the board is closed"):
        board.tare()
    with pytest.raises(dermatome.Error, match="the board is closed"):
        board.stream()


def test_what_a_simulated_board_cannot_be() -> None:
    with pytest.raises(dermatome.Error, match="press field `radius` is -1"):
        dermatome.simulate(SQUARE, [(0, 0, -1, 1)])
    with pytest.raises(ValueError, match="noise_db is -1; allowed: 0 to 200 dB"):
        dermatome.simulate(SQUARE, noise_db=-1)
    with pytest.raises(ValueError, match="exclude each other"):
        dermatome.simulate(SQUARE, [], script="fingers.csv")


def test_a_board_that_refuses_says_why() -> None:
    with dermatome.simulate(SQUARE) as board, pytest.raises(dermatome.Error, match="allowed are 1 to 1000"):
        board.tare(2000)
