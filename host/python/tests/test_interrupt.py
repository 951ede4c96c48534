"""Ctrl-C ends whatever waits, at once."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import time

import pytest
from conftest import SQUARE

WAITS = {
    "a stream that goes on": """
        with dermatome.open("sim:{skin}") as board:
            for frame in board.stream():
                ready()
    """,
    "a stream of which nothing comes": """
        with dermatome.simulate("{skin}", []) as board:
            board.tare()
            stream = board.stream(every=60000)
            ready()
            next(stream)
    """,
    "a tare": """
        with dermatome.simulate("{skin}", []) as board:
            ready()
            board.tare(1000)
    """,
    "a board that does not answer": """
        ready()
        dermatome.open("tcp:127.0.0.1:{port}")
    """,
}


@pytest.mark.parametrize("wait", WAITS)
def test_ctrl_c_ends(wait: str) -> None:
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        lines = WAITS[wait].format(skin=SQUARE, port=silent.getsockname()[1])
        program = f"""
import dermatome

def ready():
    print("ready", flush=True)

try:
    if True:
{lines}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
        with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
            time.sleep(0.3)
            process.send_signal(signal.SIGINT)
            sent = time.monotonic()
            rest, _ = process.communicate(timeout=30)
            assert rest.splitlines()[-1] == "interrupted"
            assert process.returncode == 0
            assert time.monotonic() - sent < 3
