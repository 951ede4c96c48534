"""Prints how many frames a second a recording gives as NumPy arrays.

    python host/python/benches/throughput.py RUN.mcap

The best of several runs, each from the file on, which the system holds in memory by then.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import dermatome

RUNS = 5
# What the robot asks for, frames a second.
LEAST = 20_000


def seconds(read: Callable[[], object]) -> float:
    """The shortest time that it takes."""

    def once() -> float:
        begun = time.perf_counter()
        read()
        return time.perf_counter() - begun

    return min(once() for _ in range(RUNS))


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    recording = dermatome.Recording(sys.argv[1])
    frames = len(recording.times())
    ways: dict[str, Callable[[], object]] = {
        "times()": recording.times,
        "measurements()": recording.measurements,
        "images()": recording.images,
        "contacts()": recording.contacts,
        "read(), all of them": recording.read,
        "for frame in recording": lambda: list(recording),
    }
    print(f"{recording}, {frames} frames")
    rates = {name: frames / seconds(read) for name, read in ways.items()}
    for name, rate in rates.items():
        print(f"{name:<24}{rate:>10,.0f} frames per second")
    return 0 if min(rates.values()) >= LEAST else 1


if __name__ == "__main__":
    sys.exit(main())
