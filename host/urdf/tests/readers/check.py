"""Robots with skins, read by programs of others, and a simulated skin that is touched in MuJoCo.

    check.py PROGRAM

Needs the packages of requirements.txt, and `check_urdf` (Debian: liburdfdom-tools).
"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import mujoco
import numpy as np
import trimesh
import yourdfpy

ROOT = Path(__file__).parents[4]
sys.path.insert(0, str(ROOT / "docs"))
import mujoco_skin

LINK = ROOT / "models" / "hemisphere-210mm" / "hemisphere.stl"
SKIN = "elbow-skin"
# Shares of half the skin's size at which the finger touches; nothing was chosen by them.
PLACES = [[0, 0], [0.45, 0.1], [-0.35, 0.4], [0.1, -0.55], [-0.5, -0.2], [0.3, 0.45]]
URDF = """<?xml version="1.0" encoding="utf-8"?>
<!-- An arm of one link -->
<robot name="arm">
  <link name="base"/>
  <link name="dome">
    <visual><geometry><mesh filename="hemisphere.stl" scale="0.001 0.001 0.001"/></geometry></visual>
    <inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/> <child link="dome"/>
    <origin xyz="0 0 0.2" rpy="0.3 0 0"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>
"""
# Its defaults are not those that a skin needs.
MJCF = """<mujoco model="arm">
  <!-- An arm of one link -->
  <compiler angle="radian" meshdir="assets"/>
  <default><mesh scale="0.001 0.001 0.001"/><geom contype="0" conaffinity="0"/></default>
  <asset><mesh name="dome" file="hemisphere.stl" inertia="shell"/></asset>
  <worldbody>
    <body name="dome" pos="0 0 0.2" euler="0.3 0 0">
      <joint name="shoulder" axis="0 0 1" damping="10"/>
      <geom name="dome" type="mesh" mesh="dome" mass="1" contype="1" conaffinity="1"/>
    </body>
  </worldbody>
</mujoco>
"""
TABLE = """<mujoco>
  <worldbody><body name="table"><geom type="box" size=".15 .15 .05"/></body></worldbody>
</mujoco>
"""
TABLE_POSE = '\n[pose]\nlink = "table"\nposition = [0, 0, "5 cm"]\norientation = [0, 0, 0, 1]\n'


def run(*words):
    ran = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, cwd=desk)
    assert ran.returncode == 0, f"{words}: {ran.stdout}{ran.stderr}"
    return ran.stdout


def setUpModule():
    global folder, desk, cut
    folder = tempfile.TemporaryDirectory(prefix="dermatome-robots-")
    desk = Path(folder.name)
    (desk / "assets").mkdir()
    for place in [desk, desk / "assets"]:
        (place / "hemisphere.stl").write_bytes(LINK.read_bytes())
    (desk / "arm.urdf").write_text(URDF)
    (desk / "arm.xml").write_text(MJCF)
    region = ["--around", "0,-74,74", "--radius", "50", "--edge-length", "2.3"]
    run(PROGRAM, "cut", LINK, "--unit", "mm", *region, "--frame", "dome", "--out", SKIN, "--json", "cut.json")
    cut = json.loads((desk / "cut.json").read_text())
    run(PROGRAM, "urdf", "add", "arm.urdf", f"{SKIN}/skin.toml", "-o", "skin.urdf")
    run(PROGRAM, "mjcf", "add", "arm.xml", f"{SKIN}/skin.toml", "--taxels", "16", "-o", "skin.xml")


def tearDownModule():
    folder.cleanup()


def pose():
    """Takes points of the skin's frame to the link's, by what `cut` has said."""
    x, y, z, w = cut["pose"]["orientation_xyzw"]
    matrix = trimesh.transformations.quaternion_matrix([w, x, y, z])
    matrix[:3, 3] = cut["pose"]["position_m"]
    return matrix


class Urdf(unittest.TestCase):
    def test_check_urdf_finds_the_skin_under_its_link(self):
        said = run("check_urdf", "skin.urdf")
        tree = [line.strip() for line in said.splitlines() if "child" in line]
        self.assertEqual(tree, ["root Link: base has 1 child(ren)", "child(1):  dome", f"child(1):  {SKIN}"])
        self.assertNotIn("rror", said)

    def test_yourdfpy_finds_the_skin_where_it_was_cut(self):
        robot = yourdfpy.URDF.load(str(desk / "skin.urdf"))
        self.assertTrue(robot.validate(), robot.errors)
        np.testing.assert_allclose(robot.get_transform(SKIN, "dome"), pose(), atol=1e-8)
        self.assertEqual(list(robot.link_map), ["base", "dome", SKIN])

    def test_its_mesh_lies_on_the_link(self):
        skin = trimesh.load(desk / f"{SKIN}.stl")
        self.assertTrue(skin.is_watertight)
        self.assertAlmostEqual(skin.volume / (cut["mesh"]["area"] * 1e-3), 1, delta=0.03)
        radii = np.linalg.norm(trimesh.transform_points(skin.vertices, pose()), axis=1)
        # The link is a half sphere of 105 mm; the skin is 1 mm thick.
        self.assertGreater(radii.min(), 0.1045)
        self.assertLess(radii.max(), 0.1061)

    def test_mujoco_reads_it_too(self):
        self.assertEqual(mujoco.MjModel.from_xml_path(str(desk / "skin.urdf")).njnt, 1)


class Mjcf(unittest.TestCase):
    def setUp(self):
        self.before = mujoco.MjModel.from_xml_path(str(desk / "arm.xml"))
        self.model = mujoco_skin.with_finger(desk / "skin.xml", SKIN)

    def test_the_robot_moves_as_before(self):
        model = mujoco.MjModel.from_xml_path(str(desk / "skin.xml"))
        self.assertEqual((model.nq, model.nbody), (self.before.nq, self.before.nbody + 1))
        self.assertEqual(model.body_mass.sum(), self.before.body_mass.sum())
        data, before = mujoco.MjData(model), mujoco.MjData(self.before)
        data.qvel[:] = before.qvel[:] = 1
        for _ in range(300):
            mujoco.mj_step(model, data)
            mujoco.mj_step(self.before, before)
        self.assertEqual(data.ncon, 0)
        np.testing.assert_allclose(data.qpos, before.qpos)

    def test_the_skin_lies_where_it_was_cut(self):
        place = pose()
        origin = mujoco_skin.in_link(self.model, SKIN, np.zeros(3))
        np.testing.assert_allclose(origin, place[:3, 3], atol=1e-8)
        np.testing.assert_allclose(mujoco_skin.in_link(self.model, SKIN, np.eye(3)[0]) - origin, place[:3, 0], atol=1e-7)

    def test_a_finger_touches_the_skin_with_its_force(self):
        site, thick = self.model.site(SKIN), 1e-3
        for share in PLACES:
            with self.subTest(share):
                place = site.pos[:2] + np.array(share) * site.size[:2]
                [(where, force)] = mujoco_skin.touch(self.model, SKIN, place, 3.0)
                self.assertTrue(2 < force < 4, force)
                radius = np.linalg.norm(mujoco_skin.in_link(self.model, SKIN, where))
                self.assertAlmostEqual(radius, 0.105 + thick / 2, delta=thick)

    def test_sensors_feel_it_there(self):
        data = mujoco.MjData(self.model)
        site = self.model.site(SKIN)
        mujoco_skin.touch(self.model, SKIN, site.pos[:2] + 0.4 * site.size[:2], 3.0, data=data)
        [(where, force)] = mujoco_skin.contacts(self.model, data, SKIN)
        self.assertAlmostEqual(data.sensor(SKIN).data[0], force)
        felt = [at for at in range(16) if data.sensor(f"{SKIN}_{at}").data[0] > 0]
        self.assertTrue(0 < len(felt) < 8, felt)
        for at in felt:
            taxel = self.model.site(f"{SKIN}_{at}")
            self.assertLess(np.linalg.norm(taxel.pos - where), 2 * taxel.size[0])
        away = mujoco.MjData(self.model)
        mujoco_skin.touch(self.model, SKIN, [0.09, 0], 3.0, data=away)
        self.assertEqual((away.sensor(SKIN).data[0], mujoco_skin.contacts(self.model, away, SKIN)), (0, []))


class Twice(unittest.TestCase):
    """One skin file on a robot under two names."""

    def add(self, kind, robot, flag):
        links = {"left": "dome", "right": "base" if kind == "urdf" else "world"}
        (desk / f"twice-{robot}").write_text((desk / robot).read_text())
        for name, link in links.items():
            run(PROGRAM, kind, "add", f"twice-{robot}", f"{SKIN}/skin.toml", "--name", name, flag, link)
        return f"twice-{robot}"

    def test_ros_reads_both(self):
        robot = self.add("urdf", "arm.urdf", "--link")
        self.assertIn("all is well", run(PROGRAM, "urdf", "check", robot, f"{SKIN}/skin.toml"))
        said = run("check_urdf", robot)
        self.assertTrue("  left" in said and "  right" in said, said)
        robot = yourdfpy.URDF.load(str(desk / robot))
        self.assertTrue(robot.validate(), robot.errors)
        for name, link in [("left", "dome"), ("right", "base")]:
            np.testing.assert_allclose(robot.get_transform(name, link), pose(), atol=1e-8)

    def test_mujoco_reads_both(self):
        model = mujoco.MjModel.from_xml_path(str(desk / self.add("mjcf", "arm.xml", "--body")))
        self.assertEqual([model.site(name).name for name in ["left", "right"]], ["left", "right"])
        self.assertEqual([model.sensor(at).name for at in range(model.nsensor)], ["left", "right"])


class Board(unittest.TestCase):
    """A contact in MuJoCo is one of the simulated board."""

    def feel(self, model, skin):
        example = [sys.executable, ROOT / "docs" / "mujoco_skin.py", model, skin, "--program", PROGRAM]
        print(run(*example, "--json", "felt.json", *(f"--at={x},{y}" for x, y in PLACES)))
        apart = [touch["apart_m"] for touch in json.loads((desk / "felt.json").read_text())]
        self.assertEqual(len(apart), len(PLACES))
        self.assertNotIn(None, apart)
        self.assertLess(max(apart), 5e-3)
        self.assertLess(np.median(apart), 2e-3)

    def test_on_a_skin_that_was_cut_out_of_a_robot(self):
        self.feel("skin.xml", f"{SKIN}/skin.toml")

    def test_on_a_flat_skin(self):
        (desk / "disc.toml").write_text((ROOT / "models" / "disc-210mm" / "skin.toml").read_text() + TABLE_POSE)
        (desk / "table.xml").write_text(TABLE)
        run(PROGRAM, "mjcf", "add", "table.xml", "disc.toml")
        self.feel("table.xml", "disc.toml")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    PROGRAM = Path(sys.argv.pop(1)).resolve()
    unittest.main()
