"""`dermatome serve --ros`, heard by another DDS than its own: what arrives is what the program printed.

    check.py PROGRAM [--bounds]

PROGRAM is built with `--features ros`. With --bounds, late messages fail, which says something of a release build on a
computer without other work. Needs the packages of requirements.txt. Nothing leaves this computer.
"""

import json
import math
import os
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

from listener import LASTING, USUAL, Listener

MODEL = Path(__file__).parents[4] / "models" / "square-50mm" / "skin.toml"
CALIBRATION = '\n[calibration]\nstrength = [0.1, 0.5]\npressure = ["2 kPa", "10 kPa"]\nload_share = 1.0\n'
# Two seconds untouched, then two under a finger that moves, again and again.
PATH = "time_s,finger,x_m,y_m,radius_m,depth\n2,1,0,0.01,0.005,0.6\n4,1,0.01,0.01,0.005,0.6\n"
ROBOT = """
name = "arm"
[[patches]]
name = "palm"
skin = "palm.toml"
port = "tcp:127.0.0.1:{palm}"
link = "hand/palm.left"
position = ["120 mm", -0.03, "0.5 m"]
orientation = [0.5, 0.5, 0.5, 0.5]
[[patches]]
name = "elbow"
skin = "elbow.toml"
port = "tcp:127.0.0.1:{elbow}"
link = "forearm"
position = ["0 mm", "0 mm", "40 mm"]
orientation = [0, 0, 0, 1]
"""
SECONDS = 15
# Of the end of a scan to here with --bounds, ms.
MOST_MEDIAN, MOST_99 = 5, 15
# A stamp of another clock is off by more, ms.
SAME_CLOCK = 1000
GAIN_AS_IT_IS = 255
NAN = math.nan


def free_port():
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        return listening.getsockname()[1]


class Desk:
    """A robot of two skins that the program serves, a listener, and what both have said."""

    def __init__(self, program):
        self.program = program
        self.folder = tempfile.TemporaryDirectory(prefix="dermatome-ros-")
        unittest.addModuleCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name)
        # Others that test on this computer have other domains.
        self.domain = 1 + os.getpid() % 200
        self.ports = {"palm": free_port(), "elbow": free_port()}
        # Coarse, so that boards are simulated at their frame rate even where the computer has other work.
        skin = MODEL.read_text().replace('edge_length = "1.2 mm"', 'edge_length = "3 mm"')
        (self.path / "palm.toml").write_text(skin + CALIBRATION)
        (self.path / "elbow.toml").write_text(skin)
        (self.path / "path.csv").write_text(PATH)
        (self.path / "robot.toml").write_text(ROBOT.format(**self.ports))
        self.board = self.start_board("palm", "--path", "path.csv")
        # The finger of a board without a path is always on the skin.
        self.start_board("elbow")
        for skin in self.ports:
            self.wait_for_board(skin)
            self.run("build", f"{skin}.toml", "-o", f"{skin}.dermatome")
            self.run("flash", f"{skin}.dermatome", "--port", self.port(skin))
        self.listener = Listener(self.domain)
        unittest.addModuleCleanup(self.listener.stop)
        self.listen()
        self.printed = (self.path / "printed.jsonl").open("w")
        unittest.addModuleCleanup(self.printed.close)
        self.served = self.serve()

    def run(self, *arguments):
        ran = subprocess.run(
            [self.program, *arguments], cwd=self.path, stdin=subprocess.DEVNULL, capture_output=True, text=True
        )
        assert ran.returncode == 0, ran.stderr

    def port(self, skin):
        return f"tcp:127.0.0.1:{self.ports[skin]}"

    def start_board(self, skin, *more):
        arguments = [f"{skin}.toml", "--listen", self.port(skin), "--store", f"{skin}.store", *more]
        return self.start("simulate", *arguments, stdout=subprocess.DEVNULL)

    def wait_for_board(self, skin):
        begun = time.monotonic()
        while time.monotonic() < begun + 20:
            with socket.socket() as trial:
                if trial.connect_ex(("127.0.0.1", self.ports[skin])) == 0:
                    return
            time.sleep(0.1)
        raise TimeoutError("the simulated board does not listen")

    def serve(self):
        environment = {
            "ROS_DOMAIN_ID": str(self.domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp",
        }
        return self.start("serve", "robot.toml", "--ros", stdout=self.printed, env=os.environ | environment)

    def start(self, *arguments, **options):
        with (self.path / f"{arguments[0]}.log").open("a") as errors:
            started = subprocess.Popen(
                [self.program, *arguments], cwd=self.path, stdin=subprocess.DEVNULL, stderr=errors, **options
            )
        unittest.addModuleCleanup(kill, started)
        return started

    def listen(self):
        for skin in ["palm", "elbow"]:
            self.listener.listen(f"/arm/{skin}/contacts", "dermatome_msgs/msg/SkinContactArray")
            self.listener.listen(f"/arm/{skin}/pressure", "sensor_msgs/msg/PointCloud2")
            self.listener.listen(f"/arm/{skin}/markers", "visualization_msgs/msg/MarkerArray")
        for link in ["hand_palm_left", "forearm"]:
            self.listener.listen(f"/arm/{link}/wrench", "geometry_msgs/msg/WrenchStamped")
        self.listener.listen("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", USUAL)

    def lines(self):
        """What the program printed of frames, by skin and number."""
        text = (self.path / "printed.jsonl").read_text()
        lines = [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()]
        return {(line["patch"], line["sequence"]): line for line in lines if "sequence" in line}


def kill(process):
    process.kill()
    process.wait()


def setUpModule():
    global desk, heard
    desk = Desk(PROGRAM)
    heard = desk.listener
    try:
        for skin in ["palm", "elbow"]:
            heard.wait(f"/arm/{skin}/contacts", seconds=60)
    except TimeoutError:
        print((desk.path / "serve.log").read_text(), file=sys.stderr)
        raise
    time.sleep(SECONDS)
    # Before the tests decode what came, which keeps this program from hearing the next.
    desk.undisturbed = {skin: list(heard.received[f"/arm/{skin}/contacts"]) for skin in ["palm", "elbow"]}


def most_of(values):
    """The 99 % quantile."""
    return sorted(values)[int(0.99 * len(values))]


def nanoseconds(stamp):
    return stamp.sec * 1_000_000_000 + stamp.nanosec


def place(point):
    return [point.x, point.y, point.z]


def known(value):
    """A number as JSON has it."""
    return None if math.isnan(value) else value


class A_Frames(unittest.TestCase):
    """Each frame, as it came and as it was printed."""

    def pairs(self, skin):
        lines = desk.lines()
        arrays = heard.of(f"/arm/{skin}/contacts")
        pairs = [(array, lines[skin, array.sequence]) for array in arrays if (skin, array.sequence) in lines]
        self.assertGreater(len(pairs), 10 * SECONDS)
        return pairs

    def test_contacts_are_those_that_were_printed(self):
        for skin, link in [("palm", "hand/palm.left"), ("elbow", "forearm")]:
            pairs = self.pairs(skin)
            for array, line in pairs:
                self.assertEqual((array.header.frame_id, array.patch), (link, skin))
                self.assertAlmostEqual(nanoseconds(array.header.stamp) * 1e-9, line["time_s"], places=5)
                self.assertAlmostEqual(array.device_time_us * 1e-6, line["device_time_s"], places=6)
                self.assertEqual(array.valid, line["valid"])
                self.assertEqual(len(array.contacts), len(line["contacts"]))
                for contact, shown in zip(array.contacts, line["contacts"]):
                    self.check_contact(contact, shown)
            self.assertTrue(any(array.contacts for array, _ in pairs))

    def check_contact(self, it, shown):
        self.assertEqual(it.contact.id, shown["id"])
        np.testing.assert_allclose(place(it.contact.position), shown["position_m"], rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(place(it.contact.normal), shown["normal"], rtol=1e-6, atol=1e-9)
        self.assertEqual(np.float32(it.contact.strength), np.float32(shown["strength"]))
        np.testing.assert_allclose(place(it.geometric_centre), shown["geometric_centre_m"], rtol=1e-12)
        self.assertEqual(list(it.pixels), shown["pixels"])
        self.assertEqual(it.has_wrench, shown["wrench"] is not None)
        if it.has_wrench:
            self.assertEqual(place(it.wrench.force), shown["wrench"]["force_n"])
            self.assertEqual(place(it.wrench.torque), shown["wrench"]["moment_n_m"])

    def test_hardly_a_frame_is_lost(self):
        for skin in ["palm", "elbow"]:
            came = {array.sequence for array in heard.of(f"/arm/{skin}/contacts") if array.sequence}
            first, last = min(came), max(came)
            printed = {number for name, number in desk.lines() if name == skin and first <= number <= last}
            lost = printed - came
            print(f"{skin}: {len(came)} arrays of contacts came, {len(lost)} did not")
            self.assertLess(len(lost), 0.01 * len(printed) + 2)

    def test_a_link_tells_what_presses_on_it(self):
        lines = {round(line["time_s"] * 1e6): line for (skin, _), line in desk.lines().items() if skin == "palm"}
        wrenches = heard.of("/arm/hand_palm_left/wrench")
        self.assertGreater(len(wrenches), 10 * SECONDS)
        pressed = 0
        for stamped in wrenches:
            line = lines.get(round(nanoseconds(stamped.header.stamp) * 1e-3))
            if line:
                self.assertEqual(stamped.header.frame_id, "hand/palm.left")
                self.assertEqual(place(stamped.wrench.force), line["wrench"]["force_n"])
                self.assertEqual(place(stamped.wrench.torque), line["wrench"]["moment_n_m"])
                pressed += any(line["wrench"]["force_n"])
        self.assertGreater(pressed, SECONDS)
        # Of a skin whose calibration tells no forces.
        forces = [place(stamped.wrench.force) for stamped in heard.of("/arm/forearm/wrench")]
        self.assertTrue(all(force == [0.0] * 3 or all(map(math.isnan, force)) for force in forces))

    def test_images_come_as_points(self):
        for skin, link in [("palm", "hand/palm.left"), ("elbow", "forearm")]:
            # One without points says that images are over.
            clouds = [cloud for cloud in heard.of(f"/arm/{skin}/pressure") if cloud.width]
            self.assertGreater(len(clouds), 5 * SECONDS)
            stamps = {nanoseconds(array.header.stamp) for array in heard.of(f"/arm/{skin}/contacts")}
            for cloud in clouds:
                fields = [(field.name, field.offset, field.datatype) for field in cloud.fields]
                self.assertEqual(fields, [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 12, 7)])
                self.assertEqual((cloud.height, cloud.width, cloud.point_step), (1, 28 * 28, 16))
                self.assertEqual((cloud.header.frame_id, len(cloud.data)), (link, 16 * 28 * 28))
                points = np.frombuffer(bytes(cloud.data), "<f4")
                self.assertTrue(np.isfinite(points).all())
            self.assertGreater(sum(nanoseconds(cloud.header.stamp) in stamps for cloud in clouds), 0.9 * len(clouds))

    def test_each_contact_is_a_sphere_an_arrow_and_a_text(self):
        by_stamp = {nanoseconds(array.header.stamp): array for array in heard.of("/arm/palm/contacts")}
        drawn = 0
        for array in heard.of("/arm/palm/markers"):
            clear, *markers = array.markers
            self.assertEqual(clear.action, 3)
            contacts = by_stamp.get(nanoseconds(clear.header.stamp))
            if contacts:
                self.assertEqual([marker.type for marker in markers], [2, 0, 9] * len(contacts.contacts))
                drawn += len(markers)
        self.assertGreater(drawn, 0)

    def test_the_end_of_a_scan_is_soon_heard(self):
        for skin in ["palm", "elbow"]:
            # Before, the offset between the clocks is not known yet.
            arrivals = desk.undisturbed[skin][100:]
            late = [(it.came - nanoseconds(it.message.header.stamp)) * 1e-6 for it in arrivals]
            median, most = statistics.median(late), most_of(late)
            print(
                f"{skin}: end of scan to a DDS subscriber: median {median:.2f} ms, 99 % {most:.2f} ms, "
                f"largest {max(late):.2f} ms, of {len(late)} frames"
            )
            self.assertLess(abs(median), SAME_CLOCK)
            if BOUNDS:
                self.assertLessEqual(median, MOST_MEDIAN)
                self.assertLessEqual(most, MOST_99)


class B_Robot(unittest.TestCase):
    """What is told of the robot."""

    def test_who_comes_later_hears_where_the_skins_lie(self):
        heard.listen("/tf_static", "tf2_msgs/msg/TFMessage", LASTING)
        begun = time.monotonic()
        while not heard.received["/tf_static"] and time.monotonic() < begun + 10:
            time.sleep(0.01)
        [message] = heard.of("/tf_static")
        palm, elbow = message.transforms
        self.assertEqual((palm.header.frame_id, palm.child_frame_id), ("hand/palm.left", "arm/palm"))
        self.assertEqual(place(palm.transform.translation), [0.12, -0.03, 0.5])
        rotation = palm.transform.rotation
        self.assertEqual([rotation.x, rotation.y, rotation.z, rotation.w], [0.5] * 4)
        self.assertEqual((elbow.header.frame_id, elbow.child_frame_id), ("forearm", "arm/elbow"))

    def test_diagnostics_come_once_a_second(self):
        arrivals = [it.came for it in heard.received["/diagnostics"]]
        gaps = np.diff(arrivals) * 1e-9
        self.assertGreater(len(gaps), 5)
        self.assertAlmostEqual(statistics.median(gaps), 1.0, delta=0.1)
        palm, elbow = heard.of("/diagnostics")[-1].status
        self.assertEqual((palm.name, palm.level, palm.message), ("arm: palm", 0, "all is well"))
        self.assertEqual(palm.hardware_id, desk.port("palm"))
        self.assertEqual(elbow.name, "arm: elbow")
        values = {value.key: value.value for value in palm.values}
        self.assertEqual(values["open electrodes"], "")
        self.assertGreater(int(values["frames"]), 10 * SECONDS)


class C_Services(unittest.TestCase):
    """What can be asked for."""

    def test_a_tare_is_answered_when_it_is_made(self):
        message = self.done(lambda: self.tare("palm"))
        self.assertEqual(message, "the reference is made")

    def test_a_tare_under_a_finger_says_that_it_waits(self):
        success, message = self.tare("elbow")
        self.assertFalse(success)
        self.assertIn("something presses on the skin", message)

    def done(self, ask):
        """What is said once it is done: the finger may be on the skin when it is asked for."""
        begun, success = time.monotonic(), False
        while not success:
            success, message = ask()
            self.assertTrue(success or "something presses on the skin" in message, message)
            self.assertLess(time.monotonic(), begun + 30, message)
        return message

    def tare(self, skin):
        outcome = heard.call(f"/arm/{skin}/tare", "std_srvs/srv/Trigger", 0)
        return outcome.success, outcome.message

    def drive(self, *arguments):
        outcome = heard.call("/arm/palm/drive", "dermatome_msgs/srv/Drive", *arguments)
        return outcome.success, outcome.message

    def test_a_drive_is_answered_when_the_board_has_it(self):
        # Each asks for a new reference, so that some come while one is being made.
        for rate in [40.0, 50.0] * 10:
            message = self.done(lambda: self.drive(NAN, NAN, rate, GAIN_AS_IT_IS))
            self.assertIn(f"{rate:.0f} frames a second", message)
            time.sleep(0.15)

    def test_a_drive_that_makes_no_sense_is_refused_in_words(self):
        for arguments, words in [
            ((-1.0, NAN, NAN, GAIN_AS_IT_IS), "`frequency` is -1 Hz; allowed: more than 0 Hz"),
            ((NAN, NAN, 0.0, GAIN_AS_IT_IS), "`frame_rate` is 0 a second; allowed: more than 0"),
            ((NAN, NAN, NAN, 3), "`gain` is 3; allowed: automatic, 1, 2, 4"),
        ]:
            success, message = self.drive(*arguments)
            self.assertFalse(success)
            self.assertTrue(message.startswith(words), message)


class D_Loss(unittest.TestCase):
    """A board that is lost, and comes back."""

    def test_what_a_lost_board_said_is_over(self):
        heard.wait("/arm/palm/contacts", lambda array: array.valid)
        since = len(heard.received["/arm/palm/contacts"])
        kill(desk.board)
        over = heard.wait("/arm/palm/contacts", lambda array: not array.valid, since=since)
        self.assertEqual((list(over.contacts), over.header.frame_id), ([], "hand/palm.left"))
        # What is said on several topics comes in any order.
        self.wait_for_last("/arm/hand_palm_left/wrench", lambda stamped: math.isnan(stamped.wrench.force.x))
        self.wait_for_last("/arm/palm/markers", lambda array: [marker.action for marker in array.markers] == [3])
        diagnosed = heard.wait("/diagnostics", lambda array: array.status[0].level == 2)
        self.assertEqual(diagnosed.status[1].name, "arm: elbow")
        desk.board = desk.start_board("palm", "--path", "path.csv")
        heard.wait("/arm/palm/contacts", lambda array: array.valid)

    def wait_for_last(self, topic, is_so):
        begun = time.monotonic()
        while not is_so(heard.of(topic)[-1]):
            self.assertLess(time.monotonic(), begun + 5, topic)
            time.sleep(0.01)


class E_End(unittest.TestCase):
    """The program ends."""

    def test_all_contacts_are_over(self):
        topics = [f"/arm/{skin}/contacts" for skin in ["palm", "elbow"]]
        before = [len(heard.received[topic]) for topic in topics]
        desk.served.terminate()
        for topic, since in zip(topics, before):
            heard.wait(topic, lambda array: not array.valid and not array.contacts, since=since)
        self.assertEqual(desk.served.wait(20), 0)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    BOUNDS = "--bounds" in sys.argv
    if BOUNDS:
        sys.argv.remove("--bounds")
    PROGRAM = Path(sys.argv.pop(1)).resolve()
    unittest.main()
