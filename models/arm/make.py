#!/usr/bin/env python3
"""Makes the arm: meshes of its links by formula, its URDF, and three skins cut out of the links.

    cargo build --release
    python3 models/arm/make.py target/release/dermatome

writes meshes/, the folders of the skins and robot.urdf beside this file (or into the folder that is named after the
program). It needs Python's standard library only, and gives the same bytes on every run. robot.toml is written by hand.
"""

import math
import struct
import subprocess
import sys
from pathlib import Path

ROUND = 40  # triangles round a link
ALONG = 12  # rings along its straight part
CAP = 7  # rings of each rounded end

# Link: length between the centres of its ends (m), radius at each end, thickness across y over thickness across x.
LINKS = {
    "upper_arm": (0.26, 0.056, 0.050, 1.0),
    "forearm": (0.24, 0.048, 0.038, 1.0),
    "hand": (0.11, 0.050, 0.042, 0.7),
}
BASE = (0.05, 0.075, 0.075, 1.0)

# Skin: its link, where it is cut out (m in the link's frame), how far it reaches over the surface.
SKINS = {
    "upper-arm-skin": ("upper_arm", "0,0.053,0.13", "0.055"),
    "forearm-skin": ("forearm", "0,0.043,0.12", "0.048"),
    "hand-skin": ("hand", "0,0.032,0.055", "0.04"),
}
# Electrodes of 16, each as wide as this share of the distance between two, and triangles of a third of that.
WIDTH, EDGES = 0.4, 3
# Frames a second: one computer simulates all three boards, and the page's browser draws on it as well.
FRAME_RATE = 25

# Joint: its links, its place on the first one (xyz, rpy), its axis; fixed without one.
JOINTS = {
    "mount": ("world", "base", "0 0 0.075", "0 0 0", None),
    "shoulder": ("base", "upper_arm", "0 0 0.09", "0 0.35 0", "0 1 0"),
    "elbow": ("upper_arm", "forearm", "0 0 0.26", "0 0.75 0", "0 1 0"),
    "wrist": ("forearm", "hand", "0 0 0.25", "0 0.45 0", "0 1 0"),
    "tip": ("hand", "fingertip", "0 0 0.14", "0 0 0", None),
}


def profile(length, first, last):
    """Radius and height of each ring from the lower pole to the upper one."""
    angles = [math.pi / 2 * i / CAP for i in range(CAP)]
    lower = [(first * math.sin(a), -first * math.cos(a)) for a in angles]
    middle = [(first + (last - first) * i / ALONG, length * i / ALONG) for i in range(ALONG + 1)]
    upper = [(last * math.cos(a), length + last * math.sin(a)) for a in angles[1:]]
    return [*lower, *middle, *upper, (0.0, length + last)]


def triangles(length, first, last, flatness):
    """A surface of revolution about z, narrower or wider along y."""

    def point(radius, height, step):
        angle = 2 * math.pi * step / ROUND
        return (radius * math.cos(angle), flatness * radius * math.sin(angle), height)

    rings = profile(length, first, last)
    for (radius, height), (radius_above, height_above) in zip(rings, rings[1:]):
        for step in range(ROUND):
            a, b = point(radius, height, step), point(radius, height, step + 1)
            c, d = point(radius_above, height_above, step + 1), point(radius_above, height_above, step)
            if radius > 0:
                yield a, b, c
            if radius_above > 0:
                yield a, c, d


def normal(a, b, c):
    u, v = ([q - p for p, q in zip(a, corner)] for corner in (b, c))
    cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    length = math.hypot(*cross)
    return [part / length for part in cross]


def write_stl(path, faces):
    faces = list(faces)
    body = b"".join(struct.pack("<12fH", *normal(*face), *sum(face, ()), 0) for face in faces)
    path.write_bytes(b"An arm's link, metres".ljust(80, b"\0") + struct.pack("<I", len(faces)) + body)


def link_xml(name):
    if name in ("world", "fingertip"):
        return f'  <link name="{name}"/>'
    return f"""  <link name="{name}">
    <inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="meshes/{name}.stl"/></geometry></visual>
    <collision><geometry><mesh filename="meshes/{name}.stl"/></geometry></collision>
  </link>"""


def joint_xml(name, parent, child, xyz, rpy, axis):
    kind = "revolute" if axis else "fixed"
    moves = f'\n    <axis xyz="{axis}"/>\n    <limit lower="-1.5" upper="1.5" effort="30" velocity="2"/>' if axis else ""
    return f"""  <joint name="{name}" type="{kind}">
    <parent link="{parent}"/>
    <child link="{child}"/>
    <origin xyz="{xyz}" rpy="{rpy}"/>{moves}
  </joint>"""


def robot_xml():
    links = ["world", "base", *LINKS, "fingertip"]
    parts = [*map(link_xml, links), *(joint_xml(name, *joint) for name, joint in JOINTS.items())]
    return "\n".join(['<?xml version="1.0"?>', "<!-- Made by make.py. -->", '<robot name="arm">', *parts, "</robot>", ""])


def cut(run, folder, skin):
    link, around, radius = SKINS[skin]
    width = 2 * math.pi * float(radius) / 16 * WIDTH
    mesh = folder / "meshes" / f"{link}.stl"
    sizes = ["--width", f"{width:.4f}", "--edge-length", f"{width / EDGES:.4f}"]
    run("cut", mesh, "--unit", "m", f"--around={around}", "--radius", radius, *sizes, "--out", folder / skin, "--force")
    file = folder / skin / "skin.toml"
    text, usual = file.read_text(), 'frame_rate = "50 Hz"'
    assert usual in text, file
    file.write_text(text.replace(usual, f'frame_rate = "{FRAME_RATE} Hz"'))


def main():
    program = Path(sys.argv[1]).resolve()
    folder = Path(sys.argv[2]) if len(sys.argv) > 2 else Path(__file__).parent
    (folder / "meshes").mkdir(parents=True, exist_ok=True)

    def run(*words):
        subprocess.run([program, *words], check=True)

    for name, shape in {"base": BASE, **LINKS}.items():
        write_stl(folder / "meshes" / f"{name}.stl", triangles(*shape))
    robot = folder / "robot.urdf"
    robot.write_text(robot_xml())
    for skin in SKINS:
        cut(run, folder, skin)
        run("urdf", "add", robot, folder / skin / "skin.toml", "--mesh", folder / "meshes" / f"{skin}.stl", "--force")
    run("urdf", "check", robot, *(folder / skin / "skin.toml" for skin in SKINS))


main()
