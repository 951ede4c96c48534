"""The example runs as a program, without a window."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from conftest import ROOT

EXAMPLE = Path(__file__).parents[1] / "examples" / "press.py"


def test_the_example_finds_the_finger_and_the_spot() -> None:
    environment = {**os.environ, "MPLBACKEND": "agg"}
    ran = subprocess.run([sys.executable, EXAMPLE], cwd=ROOT, env=environment, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    assert re.search(r"contact \d+ at \((39|40|41)\.\d, (29|30|31)\.\d\) mm", ran.stdout), ran.stdout
    found = re.search(r"the better spot's strongest pixel is at \((.*), (.*)\) mm", ran.stdout)
    assert found is not None, ran.stdout
    x, y = (float(number) for number in found.groups())
    assert abs(x - 41.7) < 10 and abs(y - 31.8) < 10
