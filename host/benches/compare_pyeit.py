#!/usr/bin/env python3
"""Times Dermatome and pyEIT side by side on this machine, from skin to reconstruction matrix.

    python3 host/benches/compare_pyeit.py [--all] [--runs N]

Builds Dermatome, installs pyEIT from PyPI into target/pyeit, and runs both in turn at each size, each
run in a process of its own. Prints a table in Markdown: medians of the stages, of their sum and of the
whole process by the clock (start of the program, Python's imports and, for Dermatome, the report of mesh
and image included), and the largest memory of any run.

What is compared: a disc with 16 point electrodes, adjacent stimulation pattern, one pixel for each
element, one-step matrix given the Jacobian. pyEIT's matrix has a column for each of the 208 voltages.
Dermatome runs twice: with `reciprocal = "kept"`, which also has 208, and with "combined", which
averages the two voltages that reciprocity makes equal and so has 104; the ratios printed are those of
both. Priors differ: ours is Laplace in data space, pyEIT's `kotre` in image space. Dermatome's stages may
run side by side, so that their sum can exceed the time they took. At 20,500 elements pyEIT takes minutes
and about 20 GB: only with --all.
"""

import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
VENV = ROOT / "target" / "pyeit"
VERSION = "pyeit==1.2.4"
SIZES = [600, 2_400, 4_080, 20_500]
STAGES = ["mesh", "forward", "jacobian", "matrix"]
# Dermatome's settings with the columns of the matrix that they lead to; pyEIT has 208.
COLUMNS = {"kept": 208, "combined": 104}

SKIN = """
name = "compare"
[shape]
kind = "disc"
diameter = 2
[mesh]
edge_length = {edge}
[material]
sheet_conductivity = 1
[electrodes]
count = 16
placement = "rim"
model = "point"
[drive]
pattern = "adjacent"
reciprocal = "{reciprocal}"
frequency = "50 kHz"
amplitude = "1 mA"
frame_rate = 50
[inverse]
prior = "laplace"
hyperparameter = 0.03
normalised = false
[image]
pixels = "elements"
[contact]
threshold = 0.05
"""


def main():
    arguments = parse()
    if arguments.worker:
        return pyeit_worker(arguments.worker)
    program = build_dermatome()
    python = install_pyeit()
    print(machine())
    print()
    stages = " | ".join(f"{stage} / ms" for stage in STAGES)
    print(f"| elements | program | columns | {stages} | sum of stages / ms | whole process / ms | largest memory / MB |")
    print("|---|---|---|" + "---|" * (len(STAGES) + 3))
    for size in SIZES:
        ours, theirs = {reciprocal: [] for reciprocal in COLUMNS}, []
        with_pyeit = arguments.all or size < 20_000
        for _ in range(arguments.runs):
            for reciprocal, runs in ours.items():
                runs.append(dermatome_run(program, size, reciprocal))
            if with_pyeit and (size < 20_000 or not theirs):
                theirs.append(pyeit_run(python, size))
        for reciprocal, runs in ours.items():
            print(row("Dermatome", COLUMNS[reciprocal], size, runs))
        if with_pyeit:
            print(row("pyEIT", 208, size, theirs), flush=True)
        if theirs and not failure(theirs):
            for reciprocal, runs in ours.items():
                ratios = " and ".join(
                    f"{median(theirs) / median(runs):.0f} times by {name}"
                    for name, median in [("sums of stages", stage_sum), ("whole processes", process)]
                )
                print(f"pyEIT over Dermatome at {size}, {COLUMNS[reciprocal]} columns: {ratios}", file=sys.stderr)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true", help="run pyEIT at 20,500 elements too (20 GB)")
    parser.add_argument("--runs", type=int, default=5, help="runs at each size (default 5)")
    parser.add_argument("--worker", type=int, help=argparse.SUPPRESS)
    return parser.parse_args()


def build_dermatome():
    subprocess.run(["cargo", "build", "--release", "--locked"], cwd=ROOT, check=True)
    return ROOT / "target" / "release" / "dermatome"


def install_pyeit():
    python = VENV / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", VENV], check=True)
    subprocess.run([python, "-m", "pip", "install", "--quiet", VERSION], check=True)
    return python


def dermatome_run(program, size, reciprocal):
    folder = ROOT / "target"
    skin, report = folder / "compare.toml", folder / "compare.json"
    skin.write_text(SKIN.format(edge=math.sqrt(math.pi / (0.433 * size)), reciprocal=reciprocal))
    code, memory, seconds = run([program, "build", skin, "--no-patch", "--json", report])
    if code:
        sys.exit(f"{program} ended with code {code}")
    told = json.loads(report.read_text())
    of_stage = told["stage_seconds"]
    times = {stage: of_stage[stage] for stage in STAGES}
    # pyEIT needs no pixels of its own: what they cost counts as part of the Jacobian.
    times["jacobian"] += of_stage["pixels"]
    return {"elements": told["mesh"]["elements"], "memory": memory, "seconds": seconds, "times": times}


def pyeit_run(python, size):
    """What a worker reports, with the largest memory it had; or the code it ended with."""
    path = ROOT / "target" / "compare-pyeit.json"
    with open(path, "w") as output:
        code, memory, seconds = run([python, __file__, "--worker", size], output)
    return {"code": code} if code else json.loads(path.read_text()) | {"memory": memory, "seconds": seconds}


def run(command, output=subprocess.DEVNULL):
    """Runs a command; returns the code it ended with (a signal is negative), its largest resident memory in MB, and
    how many seconds it took."""
    since = time.perf_counter()
    process = subprocess.Popen([str(word) for word in command], stdout=output)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, usage.ru_maxrss / 1024, time.perf_counter() - since


def pyeit_worker(size):
    import pyeit.eit.jac as jac
    import pyeit.eit.protocol as protocol
    import pyeit.mesh as mesh
    from pyeit.eit.fem import EITForward

    times, since = {}, time.perf_counter()

    def stage(name):
        nonlocal since
        times[name] = time.perf_counter() - since
        since = time.perf_counter()

    disc = mesh.create(16, h0=math.sqrt(7.0 / size))
    stage("mesh")
    pattern = protocol.create(16, dist_exc=1, step_meas=1, parser_meas="std")
    forward = EITForward(disc, pattern)
    forward.solve_eit()
    stage("forward")
    jacobian, _ = forward.compute_jac()
    stage("jacobian")
    solver = jac.JAC(disc, pattern)
    since = time.perf_counter()
    solver.params = {"p": 0.5, "lamb": 0.01, "method": "kotre"}
    solver.H = solver._compute_h(jacobian, 0.5, 0.01, "kotre")
    stage("matrix")
    json.dump({"elements": len(disc.element), "times": times}, sys.stdout)


def failure(runs):
    """The code of the first run that did not finish, or None."""
    return next((run["code"] for run in runs if "code" in run), None)


def row(program, columns, size, runs):
    code = failure(runs)
    if code is not None:
        return f"| {size:,} | {program} | {columns} | did not finish (code {code})" + " |" * (len(STAGES) + 3)
    medians = [statistics.median(run["times"][stage] for run in runs) * 1e3 for stage in STAGES]
    memory = max(run["memory"] for run in runs)
    wholes = [stage_sum(runs), process(runs)]
    cells = [f"{milliseconds:,.1f}" for milliseconds in medians + [whole * 1e3 for whole in wholes]] + [f"{memory:,.0f}"]
    return f"| {runs[0]['elements']:,} | {program} | {columns} | " + " | ".join(cells) + " |"


def stage_sum(runs):
    return statistics.median(sum(run["times"].values()) for run in runs)


def process(runs):
    return statistics.median(run["seconds"] for run in runs)


def machine():
    names = [line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")]
    return f"{len(names)} cores of {names[0]}; medians of the runs" if names else "an unknown machine"


if __name__ == "__main__":
    main()
