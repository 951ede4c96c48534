"""`dermatome serve --zenoh`, heard by Zenoh's Python package: what arrives is what the program printed.

    check.py PROGRAM [--bounds]

PROGRAM is built with `--features zenoh`. With --bounds, late messages fail, which says something of a release build on a
computer without other work. Needs the packages of requirements.txt. Nothing leaves this computer.
"""

import json
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import messages
import zenoh

MODEL = Path(__file__).parents[4] / "models" / "square-50mm" / "skin.toml"
CALIBRATION = '\n[calibration]\nstrength = [0.1, 0.5]\npressure = ["2 kPa", "10 kPa"]\nload_share = 1.0\n'
ROBOT = """
name = "arm"
[[patches]]
name = "palm"
skin = "palm.toml"
port = "tcp:127.0.0.1:{port}"
link = "hand/palm.left"
position = ["120 mm", -0.03, "0.5 m"]
orientation = [0.5, 0.5, 0.5, 0.5]
"""
SPACE = "dermatome/arm/hand:palm.left/palm"
SECONDS = 12
# Of the end of a scan to here with --bounds, ms.
MOST_MEDIAN, MOST_99 = 5, 15
# A stamp of another clock is off by more, ms.
SAME_CLOCK = 1000


def free_port():
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        return listening.getsockname()[1]


def most_of(values):
    """The 99 % quantile."""
    return sorted(values)[int(0.99 * len(values))]


def setUpModule():
    global desk
    desk = Desk(PROGRAM)
    unittest.addModuleCleanup(desk.close)
    desk.wait_for("contacts", 60)
    time.sleep(SECONDS)
    # Before the tests decode what came, which keeps this program from hearing the next.
    desk.undisturbed = list(desk.came["contacts"])


def listens(port):
    with socket.socket() as trial:
        return trial.connect_ex(("127.0.0.1", port)) == 0


def start_board(program, path, port):
    """A simulated board with the skin's patch, whose finger is always on the skin."""
    address, options = f"tcp:127.0.0.1:{port}", {"cwd": path, "stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL}
    board = subprocess.Popen([program, "simulate", "palm.toml", "--listen", address], **options)
    unittest.addModuleCleanup(board.kill)
    begun = time.monotonic()
    while not listens(port):
        assert time.monotonic() < begun + 30, "the simulated board does not listen"
        time.sleep(0.1)
    for arguments in [["build", "palm.toml", "-o", "palm.dermatome"], ["flash", "palm.dermatome", "--port", address]]:
        subprocess.run([program, *arguments], check=True, **options)
    return board


class Desk:
    """A skin that the program serves, and what has come of it: topic, stamp, bytes, and when."""

    def __init__(self, program):
        self.folder = tempfile.TemporaryDirectory(prefix="dermatome-zenoh-")
        path = Path(self.folder.name)
        # Coarse, so that the board is simulated at its frame rate even where the computer has other work.
        skin = MODEL.read_text().replace('edge_length = "1.2 mm"', 'edge_length = "3 mm"')
        self.skin = skin + CALIBRATION
        (path / "palm.toml").write_text(self.skin)
        port = free_port()
        (path / "robot.toml").write_text(ROBOT.format(port=port))
        self.board = start_board(program, path, port)
        endpoint = f"tcp/127.0.0.1:{free_port()}"
        config = zenoh.Config()
        config.insert_json5("listen/endpoints", json.dumps([endpoint]))
        config.insert_json5("scouting/multicast/enabled", "false")
        self.session = zenoh.open(config)
        self.came = {"contacts": [], "image": [], "health": [], "state": []}
        self.subscriber = self.session.declare_subscriber(f"{SPACE}/*", self.hear)
        self.printed = path / "printed.jsonl"
        with self.printed.open("w") as printed, (path / "serve.log").open("w") as errors:
            arguments = [program, "serve", "robot.toml", "--zenoh-orders", "--zenoh-connect", endpoint]
            self.served = subprocess.Popen(
                arguments, cwd=path, stdin=subprocess.DEVNULL, stdout=printed, stderr=errors
            )

    def hear(self, sample):
        now = time.time_ns()
        topic = str(sample.key_expr).rsplit("/", 1)[1]
        stamp = messages.stamp(sample.attachment.to_bytes())
        self.came[topic].append((stamp, sample.payload.to_bytes(), now))

    def wait_for(self, topic, seconds):
        begun = time.monotonic()
        while not self.came[topic]:
            if time.monotonic() > begun + seconds or self.served.poll() is not None:
                raise TimeoutError((Path(self.folder.name) / "serve.log").read_text())
            time.sleep(0.01)

    def of(self, topic):
        return [getattr(messages, topic)(payload) for _, payload, _ in list(self.came[topic])]

    def ask(self, topic):
        replies = [reply.ok for reply in self.session.get(f"{SPACE}/{topic}", timeout=5)]
        assert len(replies) == 1, replies
        return replies[0].payload.to_bytes()

    def lines(self):
        text = self.printed.read_text()
        lines = [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()]
        return {line["sequence"]: line for line in lines if "sequence" in line}

    def close(self):
        for process in [self.served, self.board]:
            process.kill()
            process.wait()
        self.session.close()
        self.folder.cleanup()


class A_Frames(unittest.TestCase):
    """Each frame, as it came and as it was printed."""

    def test_contacts_are_those_that_were_printed(self):
        frames, lines = desk.of("contacts"), desk.lines()
        pairs = [(frame, lines[frame.sequence]) for frame in frames if frame.sequence in lines]
        self.assertGreater(len(pairs), 10 * SECONDS)
        for frame, line in pairs:
            self.assertAlmostEqual(frame.ended_ns * 1e-9, line["time_s"], places=5)
            self.assertAlmostEqual(frame.timestamp_us * 1e-6, line["device_time_s"], places=6)
            self.assertEqual(len(frame.contacts), len(line["contacts"]))
            for found, shown in zip(frame.contacts, line["contacts"]):
                self.assertEqual(found.identity and found.identity.number, shown["id"])
                for ours, theirs in [(found.position, "position_m"), (found.normal, "normal")]:
                    for a, b in zip(ours, shown[theirs]):
                        self.assertAlmostEqual(a, b, places=6)
                self.assertAlmostEqual(found.strength, shown["strength"], places=6)
                self.assertEqual(found.geometric_centre, shown["geometric_centre_m"])
                self.assertEqual(found.wrench, shown["wrench"]["force_n"] + shown["wrench"]["moment_n_m"])
                self.assertEqual(found.pixels, shown["pixels"])
        self.assertTrue(any(frame.contacts for frame, _ in pairs))

    def test_none_is_lost(self):
        for topic in ["contacts", "image", "health", "state"]:
            stamps = [stamp for stamp, _, _ in list(desk.came[topic])]
            numbers = [stamp.number for stamp in stamps]
            self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))))
            self.assertEqual(len({(stamp.run, stamp.version) for stamp in stamps}), 1)

    def test_images_are_those_of_frames(self):
        images = desk.of("image")
        self.assertGreater(len(images), 5 * SECONDS)
        ended = {frame.sequence: frame.ended_ns for frame in desk.of("contacts")}
        for image in images:
            self.assertEqual(len(image.mantissas), 28 * 28)
            self.assertEqual(image.ended_ns, ended[image.sequence])

    def test_the_end_of_a_scan_is_soon_heard(self):
        # Before, the offset between the clocks is not known yet.
        frames = [(messages.contacts(payload), came) for _, payload, came in desk.undisturbed[100:]]
        late = [(came - frame.ended_ns) * 1e-6 for frame, came in frames]
        median, most = statistics.median(late), most_of(late)
        print(
            f"end of scan to a Zenoh subscriber in Python: median {median:.2f} ms, 99 % {most:.2f} ms, "
            f"largest {max(late):.2f} ms, of {len(late)} frames"
        )
        self.assertLess(abs(median), SAME_CLOCK)
        if BOUNDS:
            self.assertLessEqual(median, MOST_MEDIAN)
            self.assertLessEqual(most, MOST_99)


class B_Questions(unittest.TestCase):
    """What those who come later ask for."""

    def test_the_skin(self):
        skin = messages.skin(desk.ask("skin"))
        self.assertEqual(skin.file, desk.skin)
        self.assertEqual((skin.position, skin.orientation), ([0.12, -0.03, 0.5], [0.5] * 4))
        self.assertEqual(len(skin.centres), 28 * 28)

    def test_the_last_tare(self):
        tare = messages.tare(desk.ask("tare"))
        self.assertEqual(len(tare.voltages), 104)
        # The board has been tared when the program began to serve it.
        self.assertLess(abs(time.time_ns() - tare.made_ns), 300e9)

    def test_the_state(self):
        state = messages.state(desk.ask("state"))
        self.assertEqual((state.phase, state.text), ("live", ""))
        self.assertEqual(state.computer, socket.gethostname())

    def test_to_drive(self):
        outcome = self.order("drive", messages.drive(frame_rate=40))
        # The finger is always on the skin.
        self.assertFalse(outcome.success)
        self.assertIn("its new drive waits until it is free", outcome.message)
        for payload, words in [
            (messages.drive(frequency=-1), "`frequency` is -1"),
            (messages.drive(gain=3), "`gain` is 3; allowed: "),
            (b"\x01", "the request is not read: 1 bytes"),
            (None, "the request is not read: 0 bytes"),
        ]:
            outcome = self.order("drive", payload)
            self.assertFalse(outcome.success)
            self.assertTrue(outcome.message.startswith(words), outcome.message)
        other = bytes([99]) + bytes(10)
        outcome = self.order("drive", messages.drive(frame_rate=50), attachment=other)
        self.assertIn("messages of version 99/", outcome.message)
        outcome = self.order("*", None)
        self.assertEqual((outcome.success, outcome.message), (False, "allowed: `ask/tare` or `ask/drive`"))

    def test_tares_are_read_without_asking_for_one(self):
        [reply] = list(desk.session.get("dermatome/arm/**/tare", timeout=5))
        self.assertTrue(str(reply.ok.key_expr).endswith("/palm/tare"))
        time.sleep(1)
        self.assertNotIn("taring", [state.phase for state in desk.of("state")][-2:])

    def order(self, name, payload, **more):
        asked = desk.session.get(f"dermatome/arm/*/palm/ask/{name}", payload=payload, timeout=20, **more)
        [reply] = list(asked)
        return messages.outcome(reply.ok.payload.to_bytes())

    def test_who_serves_is_alive_and_then_not(self):
        alive = f"{SPACE}/alive/*"
        [reply] = self.alive(alive)
        [(stamp, _, _)] = desk.came["contacts"][-1:]
        self.assertTrue(str(reply.ok.key_expr).endswith(f"/{stamp.run:016x}"))
        desk.served.kill()
        time.sleep(1)
        self.assertEqual(self.alive(alive), [])

    def alive(self, key):
        return list(desk.session.liveliness().get(key, timeout=2))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    BOUNDS = "--bounds" in sys.argv
    if BOUNDS:
        sys.argv.remove("--bounds")
    PROGRAM = Path(sys.argv.pop(1)).resolve()
    unittest.main()
