"""Touches a skin in MuJoCo, and lets a simulated Dermatome board feel it.

    dermatome mjcf add arm.xml forearm-skin/skin.toml --body forearm -o arm-with-skin.xml
    python3 docs/mujoco_skin.py arm-with-skin.xml forearm-skin/skin.toml

needs `pip install mujoco` and the program `dermatome` (option --program). A ball presses the skin at some places. Each
line shows where MuJoCo says that it touches, where the board says so, in the frame of the skin's link, and how far the
two are apart. `contacts` and `Board` are meant to be used in programs of your own.
"""

import argparse
import json
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
from pathlib import Path

import mujoco
import numpy as np

# Radius of the skin that a finger touches, m, which MuJoCo's contacts, being points, do not tell.
TOUCHED = 0.008
# Relative change of the conductivity in the middle of what is touched, for each newton, on a sheet of no material.
CHANGE = 0.2
# Where the skin is touched, as shares of half its size.
PLACES = [[0, 0], [0.5, 0], [-0.4, 0.4], [0, -0.6], [0.3, -0.3]]
# Of the guide that holds the finger, N/m and N s/m.
STIFFNESS, DAMPING = 2000, 20


def body_of(model, skin):
    """The skin's own body, which may have another name."""
    return int(model.site(skin).bodyid[0])


def contacts(model, data, skin):
    """What touches the skin: for each other body where, m, in the skin's frame, and with which normal force, N."""
    body = body_of(model, skin)
    turn, origin = data.xmat[body].reshape(3, 3), data.xpos[body]
    found = {}
    for at, contact in enumerate(data.contact[: data.ncon]):
        bodies = [model.geom_bodyid[geom] for geom in contact.geom]
        if body not in bodies:
            continue
        other = bodies[0] if bodies[1] == body else bodies[1]
        force = np.zeros(6)
        mujoco.mj_contactForce(model, data, at, force)
        if force[0] > 0:
            found.setdefault(other, []).append((turn.T @ (contact.pos - origin), force[0]))
    sums = [(sum(place * force for place, force in of), sum(force for _, force in of)) for of in found.values()]
    return [(moment / force, force) for moment, force in sums]


def in_link(model, skin, place):
    """A place of the skin's frame in that of the body it lies on."""
    body = body_of(model, skin)
    turned = np.zeros(3)
    mujoco.mju_rotVecQuat(turned, place, model.body_quat[body])
    return turned + model.body_pos[body]


class Board:
    """A simulated board whose skin is pressed by what `press` says, and the frames that it streams.

    A material, as in models/materials, has a memory, as a real one: touches leave weak contacts behind for minutes.
    """

    def __init__(self, skin_file, material=None, program="dermatome"):
        self.frame, self.frames, self.has_material = {"contacts": []}, 0, material is not None
        simulate = [program, "simulate", skin_file, "--listen", "tcp:127.0.0.1:0", "--live"]
        of_material = ["--material", material] if material else []
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self.stream = None
        self.simulated = subprocess.Popen([*simulate, *of_material], **pipes)
        try:
            self._start(skin_file, program)
        except BaseException:
            self.close()
            raise

    def _start(self, skin_file, program):
        said = self.simulated.stdout.readline()
        if " listens at " not in said:
            sys.exit("the board did not start")
        port = said.split(" listens at ")[1].strip()
        with tempfile.TemporaryDirectory() as folder:
            patch = Path(folder) / "skin.dermatome"
            at_port = ["--port", port]
            for command in [["build", skin_file, "-o", patch], ["flash", patch, *at_port], ["tare", *at_port]]:
                subprocess.run([program, *command], check=True, stdout=subprocess.DEVNULL)
        stream = [program, "stream", "--port", port, "--skin", skin_file]
        self.stream = subprocess.Popen(stream, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self.stream.stdout:
            frame = json.loads(line)
            if "contacts" in frame:
                self.frame, self.frames = frame, self.frames + 1

    def press(self, touches):
        """Presses with these places, m, in the skin's frame, and forces, N, and nothing else, from now on."""
        load = lambda force: {"force_n": force} if self.has_material else {"depth": CHANGE * force}
        presses = [{"x_m": x, "y_m": y, "radius_m": TOUCHED, **load(force)} for (x, y, _), force in touches]
        self.simulated.stdin.write(json.dumps({"presses": presses}) + "\n")
        self.simulated.stdin.flush()

    def settle(self, frames=15):
        """Waits for so many frames: a board averages still ones."""
        end, patience = self.frames + frames, time.monotonic() + 60
        while self.frames < end:
            if self.stream.poll() is not None or time.monotonic() > patience:
                sys.exit("the board does not stream any more")
            time.sleep(0.01)

    def strongest(self):
        """Place of the strongest contact of the newest frame, m, in the frame of the skin's link."""
        found = max(self.frame["contacts"], key=lambda contact: contact["strength"], default=None)
        return None if found is None else np.array(found["position_m"])

    def close(self):
        processes = [process for process in [self.stream, self.simulated] if process]
        for process in processes:
            process.terminate()
        for process in processes:
            process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def with_finger(file, skin):
    """The model with a ball that can be pushed onto the skin, along its frame's axes."""
    spec = mujoco.MjSpec.from_file(str(file))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    body = body_of(model, skin)
    finger = spec.worldbody.add_body(name="finger", pos=data.xpos[body], quat=data.xquat[body], gravcomp=1)
    finger.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.012, 0, 0], mass=0.05, contype=1, conaffinity=1)
    for axis, name in zip(np.eye(3), "xyz"):
        finger.add_joint(name=f"finger_{name}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    return spec.compile()


def touch(model, skin, place, force, seconds=1.5, data=None):
    """Where and how hard the finger touches after it has been pushed down onto a place of the skin's frame."""
    data = data or mujoco.MjData(model)
    sideways, down = [model.joint(f"finger_{name}") for name in "xy"], model.joint("finger_z")
    for joint, value in zip([*sideways, down], [*place, 0.05]):
        data.qpos[joint.qposadr] = value
    for _ in range(int(seconds / model.opt.timestep)):
        for joint, value in zip(sideways, place):
            data.qfrc_applied[joint.dofadr] = STIFFNESS * (value - data.qpos[joint.qposadr])
        data.qfrc_applied[down.dofadr] = -force
        for joint in [*sideways, down]:
            data.qfrc_applied[joint.dofadr] -= DAMPING * data.qvel[joint.dofadr]
        mujoco.mj_step(model, data)
    return contacts(model, data, skin)


def compare(model, skin, board, shares, force):
    """Touches the skin at some places, and prints and returns what MuJoCo and the board say."""
    site = model.site(skin)
    found = []
    print("            MuJoCo, mm               force/N           board, mm               apart/mm")
    for share in shares:
        place = site.pos[:2] + np.array(share) * site.size[:2]
        touches = touch(model, skin, place, force)
        board.press(touches)
        board.settle()
        felt = board.strongest()
        board.press([])
        board.settle()
        if not touches:
            sys.exit(f"the finger does not touch the skin at {share}")
        where, normal = touches[0]
        where = in_link(model, skin, where)
        apart = None if felt is None else float(np.linalg.norm(felt - where))
        seen = None if felt is None else felt.tolist()
        found.append({"touched_m": where.tolist(), "force_n": normal, "felt_m": seen, "apart_m": apart})
        shown = lambda place: " ".join(f"{1e3 * value:8.2f}" for value in place)
        seen = "nothing" if felt is None else f"{shown(felt)}   {1e3 * apart:8.2f}"
        print(f"{shown(where)}   {normal:8.2f}   {seen}", flush=True)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", type=Path, help="MJCF file with the skin")
    parser.add_argument("skin", type=Path, help="skin file")
    parser.add_argument("--material", type=Path, help="of the simulated sheet, one of models/materials")
    parser.add_argument("--name", help="of the skin in the model, if it is not that in the skin file")
    parser.add_argument("--program", default="dermatome")
    parser.add_argument("--force", type=float, default=3.0, help="with which the finger presses, N")
    parser.add_argument("--json", type=Path, help="also write what was found there")
    parser.add_argument(
        "--at",
        action="append",
        type=lambda text: [float(number) for number in text.split(",")],
        help="a place X,Y, as a share of half the skin's size; may be repeated",
    )
    options = parser.parse_args()
    # What ends this program ends its board too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    skin = options.name or tomllib.loads(options.skin.read_text())["name"]
    model = with_finger(options.model, skin)
    with Board(options.skin, options.material, options.program) as board:
        found = compare(model, skin, board, options.at or PLACES, options.force)
    if options.json:
        options.json.write_text(json.dumps(found))


if __name__ == "__main__":
    main()
