"""Recordings of the program, read by programs of others: they find what the program printed meanwhile.

    check.py PROGRAM

Needs the packages of requirements.txt, and Node with those of host/page/web.
"""

import json
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from mcap.exceptions import McapError
from mcap.reader import SeekingReader
from rosbags.rosbag2 import Reader, ReaderError
from rosbags.typesys import Stores, get_typestore

import readers

MODEL = Path(__file__).parents[4] / "models" / "square-50mm" / "skin.toml"
ARM = MODEL.parents[1] / "arm" / "robot.toml"
# A third of a turn about the diagonal, and a shift.
POSE = '\n[pose]\nlink = "wrist_3"\nposition = ["120 mm", -0.03, "0.5 m"]\norientation = [0.5, 0.5, 0.5, 0.5]\n'
FRAMES = 100
PATCH_MAGIC = b"DSKP"
TYPES = {
    "/dermatome/skin": "dermatome_msgs/msg/Skin",
    "/dermatome/status": "dermatome_msgs/msg/Status",
    "/dermatome/reference": "dermatome_msgs/msg/Reference",
    "/dermatome/measurements": "dermatome_msgs/msg/Measurements",
    "/dermatome/health": "dermatome_msgs/msg/Health",
    "/dermatome/image": "dermatome_msgs/msg/Image",
    "/dermatome/contacts": "dermatome_msgs/msg/ContactArray",
    "/dermatome/scope": "dermatome_msgs/msg/Scope",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/dermatome/pressure": "sensor_msgs/msg/PointCloud2",
    "/dermatome/markers": "visualization_msgs/msg/MarkerArray",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}
# The releases of ROS 2 whose messages ours are.
RELEASES = [Stores.ROS2_JAZZY, Stores.ROS2_KILTED, Stores.LATEST]
STANDARD = get_typestore(Stores.ROS2_JAZZY)


class Desk:
    """A folder with a recording of a simulated skin that lies on a robot's link, and what the program printed."""

    def __init__(self, program):
        self.folder = tempfile.TemporaryDirectory(prefix="dermatome-readers-")
        self.path = Path(self.folder.name)
        self.skin_file = self.path / "skin.toml"
        self.skin_file.write_text(MODEL.read_text() + POSE)
        self.whole = self.path / "whole.mcap"
        options = ["--port", f"sim:{self.skin_file}", "--skin", self.skin_file, "--record", self.whole]
        ran = subprocess.run(
            [program, "stream", *options, "--frames", str(FRAMES)],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )
        assert ran.returncode == 0, ran.stderr
        self.printed = [json.loads(line) for line in ran.stdout.splitlines()]

    def cut(self, length):
        """The first bytes of the recording, as a file."""
        path = self.path / f"cut-{length}.mcap"
        path.write_bytes(self.whole.read_bytes()[:length])
        return path


def setUpModule():
    global desk, content
    desk = Desk(PROGRAM)
    content = readers.mcap_by_index(desk.whole)


def tearDownModule():
    desk.folder.cleanup()


def summary():
    with desk.whole.open("rb") as file:
        return SeekingReader(file).get_summary()


def narrow(values):
    """As single precision, in which the board gives them."""
    return [np.float32(value) for value in values]


def place(point):
    return narrow([point["x"], point["y"], point["z"]])


def difference(found, wanted, where=""):
    """Where two messages, or more, first differ; none where they are the same."""
    if isinstance(found, dict) and isinstance(wanted, dict) and found.keys() == wanted.keys():
        pairs = [(f"{where}.{key}", found[key], wanted[key]) for key in wanted]
    elif isinstance(found, list) and isinstance(wanted, list) and len(found) == len(wanted):
        pairs = [(f"{where}[{at}]", *pair) for at, pair in enumerate(zip(found, wanted))]
    else:
        return None if found == wanted else f"{where}: {str(found):.200} instead of {str(wanted):.200}"
    differences = (difference(left, right, inner) for inner, left, right in pairs)
    return next(filter(None, differences), None)


def without_numbers(messages):
    return {topic: [[time, message] for _, time, message in of_topic] for topic, of_topic in messages.items()}


class WholeRecording(unittest.TestCase):
    """A recording that ended as it was meant to."""

    def test_every_reader_finds_the_same_in_it(self):
        ways = {
            "mcap, from its start on": readers.mcap_from_start(desk.whole),
            "@mcap/core, from its start on": readers.node("stream", desk.whole),
            "@mcap/core, by its index": readers.node("index", desk.whole),
        }
        for way, found in ways.items():
            with self.subTest(way):
                self.assertIsNone(difference(vars(found), vars(content)))

    def test_rosbags_finds_the_same_messages(self):
        found = readers.rosbags_by_index(desk.whole)
        self.assertEqual(found.types, {topic: [name, "MSG", "cdr"] for topic, name in TYPES.items()})
        messages, wanted = without_numbers(found.messages), without_numbers(content.messages)
        self.assertIsNone(difference(messages, wanted))

    def test_topics_have_their_types(self):
        self.assertEqual(content.types, {topic: [name, "ros2msg", "cdr"] for topic, name in TYPES.items()})
        with desk.whole.open("rb") as file:
            self.assertEqual(SeekingReader(file).get_header().profile, "ros2")

    def test_what_lasts_is_published_again_to_those_who_come_later(self):
        lasting = {"/dermatome/skin", "/dermatome/status", "/tf_static"}
        with Reader(desk.whole) as reader:
            for connection in reader.connections:
                [quality] = connection.ext.offered_qos_profiles
                self.assertEqual(quality.reliability.name, "RELIABLE")
                durability = "TRANSIENT_LOCAL" if connection.topic in lasting else "VOLATILE"
                self.assertEqual(quality.durability.name, durability, connection.topic)

    def test_its_index_counts_what_is_in_it(self):
        channels, statistics = summary().channels, summary().statistics
        counts = {channels[id].topic: count for id, count in statistics.channel_message_counts.items()}
        found = {topic: len(messages) for topic, messages in content.messages.items() if messages}
        self.assertEqual(counts, found)

    def test_messages_on_a_topic_are_numbered(self):
        for topic, messages in content.messages.items():
            self.assertEqual([number for number, _, _ in messages], list(range(len(messages))), topic)

    def test_every_frame_is_there_once_from_the_reference_on(self):
        [reference] = content.of("/dermatome/reference")
        frames = content.of("/dermatome/measurements")
        first, count = reference["first_sequence"], reference["frames"] + FRAMES
        self.assertEqual([frame["sequence"] for frame in frames], list(range(first, first + count)))
        last = desk.printed[-1]["sequence"]
        self.assertEqual(frames[-1]["sequence"], last)
        [skin] = content.of("/dermatome/skin")
        for frame in frames:
            self.assertEqual(len(frame["in_phase"]), len(skin["steps"]) // 4)

    def test_images_have_each_pixel_of_the_skin(self):
        [skin] = content.of("/dermatome/skin")
        images = content.of("/dermatome/image")
        self.assertEqual(len(skin["pixel_areas"]), 28 * 28)
        self.assertEqual({len(image["mantissas"]) for image in images}, {28 * 28})
        printed = [frame["sequence"] for frame in desk.printed]
        self.assertEqual([image["sequence"] for image in images], printed)

    def test_contacts_are_those_that_the_program_printed(self):
        recorded = content.of("/dermatome/contacts")
        self.assertEqual(len(recorded), len(desk.printed))
        for frame, printed in zip(recorded, desk.printed):
            self.assertEqual(frame["sequence"], printed["sequence"])
            self.assertEqual(frame["header"]["frame_id"], "wrist_3")
            self.assertEqual(len(frame["contacts"]), len(printed["contacts"]))
            for contact, shown in zip(frame["contacts"], printed["contacts"]):
                self.assertEqual(contact["id"], shown["id"])
                self.assertEqual(place(contact["position"]), narrow(shown["position_m"]))
                self.assertEqual(place(contact["normal"]), narrow(shown["normal"]))
                self.assertEqual(place(contact["velocity"]), narrow(shown["velocity_m_s"]))
                self.assertEqual(np.float32(contact["strength"]), np.float32(shown["strength"]))
                self.assertEqual(contact["pressure"], "nan")
        self.assertTrue(any(frame["contacts"] for frame in recorded))

    def test_points_are_the_pixels_of_the_image_that_came_with_them(self):
        [skin] = content.of("/dermatome/skin")
        centres = np.array(skin["pixel_centres"], np.float32).reshape(-1, 3)
        images = {time: image for _, time, image in content.messages["/dermatome/image"]}
        clouds = content.messages["/dermatome/pressure"]
        self.assertGreater(len(clouds), 10)
        for _, time, cloud in clouds:
            fields = [(field["name"], field["offset"], field["datatype"]) for field in cloud["fields"]]
            self.assertEqual(fields, [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 12, 7)])
            self.assertEqual((cloud["height"], cloud["width"], cloud["point_step"]), (1, len(centres), 16))
            points = np.frombuffer(bytes(cloud["data"]), "<f4").reshape(-1, 4)
            image = images[time]
            change = np.array(image["mantissas"]) * 2.0 ** -image["exponent"]
            np.testing.assert_array_equal(points[:, :3], centres)
            np.testing.assert_array_equal(points[:, 3], change.astype(np.float32))

    def test_each_contact_is_a_sphere_an_arrow_and_a_text(self):
        contacts = {time: frame["contacts"] for _, time, frame in content.messages["/dermatome/contacts"]}
        for _, time, array in content.messages["/dermatome/markers"]:
            clear, *drawn = array["markers"]
            # With a name it would clear those of that name only.
            self.assertEqual((clear["action"], clear["ns"]), (3, ""))
            self.assertEqual([marker["type"] for marker in drawn], [2, 0, 9] * len(contacts[time]))
            for contact, sphere, arrow, text in zip(contacts[time], drawn[::3], drawn[1::3], drawn[2::3]):
                self.assertEqual(sphere["pose"]["position"], contact["position"])
                self.assertEqual(arrow["points"][1], contact["position"])
                self.assertTrue(text["text"].startswith(f"#{contact['id']} "))

    def test_the_skin_lies_where_its_file_says(self):
        [message] = content.of("/tf_static")
        [stamped] = message["transforms"]
        self.assertEqual(stamped["header"]["frame_id"], "wrist_3")
        self.assertEqual(stamped["child_frame_id"], "square-50mm")
        self.assertEqual(stamped["transform"]["translation"], {"x": 0.12, "y": -0.03, "z": 0.5})
        self.assertEqual(stamped["transform"]["rotation"], {"x": 0.5, "y": 0.5, "z": 0.5, "w": 0.5})

    def test_diagnostics_say_that_all_is_well(self):
        for array in content.of("/diagnostics"):
            [status] = array["status"]
            self.assertEqual((status["level"], status["message"]), (0, "all is well"))
            self.assertEqual(status["name"], "dermatome: square-50mm")
            self.assertIn({"key": "open electrodes", "value": ""}, status["values"])

    def test_patch_and_skin_file_are_in_it(self):
        with desk.whole.open("rb") as file:
            attached = {item.name: item for item in SeekingReader(file).iter_attachments()}
        self.assertEqual(list(attached), ["patch.dermatome", "skin.toml"])
        patch = attached["patch.dermatome"].data
        self.assertTrue(patch.startswith(PATCH_MAGIC), patch[:8])
        self.assertGreater(len(patch), 100_000)
        self.assertEqual(attached["skin.toml"].data, desk.skin_file.read_bytes())

    def test_it_tells_what_it_is_of(self):
        metadata = content.metadata["dermatome"]
        self.assertEqual(metadata["skin"], "square-50mm")
        self.assertEqual(metadata["frame_source"], "simulated")
        self.assertEqual(metadata["port"], f"sim:{desk.skin_file}")


class StandardTypes(unittest.TestCase):
    """What we call by ROS' names is what ROS calls so."""

    def test_their_definitions_are_those_of_ros(self):
        with Reader(desk.whole) as reader:
            ours = readers.types_of(reader)
        shared = [name for name in ours.fielddefs if not name.startswith("dermatome_msgs/")]
        self.assertEqual(len(shared), 21)
        for release in RELEASES:
            theirs = get_typestore(release)
            for name in shared:
                with self.subTest(release=release.value, type=name):
                    self.assertEqual(ours.hash_rihs01(name), theirs.hash_rihs01(name))
                    constants, _ = ours.fielddefs[name]
                    self.assertEqual(constants, theirs.fielddefs[name][0])

    def test_their_messages_are_what_ros_writes_bit_for_bit(self):
        types = set()
        with Reader(desk.whole) as reader:
            for connection, _, data in reader.messages():
                if connection.msgtype in STANDARD.types:
                    types.add(connection.msgtype)
                    message = STANDARD.deserialize_cdr(data, connection.msgtype)
                    self.assertEqual(STANDARD.serialize_cdr(message, connection.msgtype), data)
        self.assertEqual(types, {name for name in TYPES.values() if not name.startswith("dermatome_msgs/")})

    def test_messages_of_our_own_are_encoded_as_ros_would(self):
        with Reader(desk.whole) as reader:
            ours = readers.types_of(reader)
            for connection, _, data in reader.messages():
                message = ours.deserialize_cdr(data, connection.msgtype)
                self.assertEqual(ours.serialize_cdr(message, connection.msgtype), data, connection.topic)


def served(body, file, seconds):
    """What is in the recording that `serve` makes of a body."""
    ran = subprocess.run(
        [PROGRAM, "serve", body, "--record", file, "--duration", str(seconds)],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
    )
    assert ran.returncode == 0, ran.stderr
    return readers.mcap_by_index(file)


class BodyRecording(unittest.TestCase):
    """A recording of all skins of a body, one of whose boards was not there."""

    @classmethod
    def setUpClass(cls):
        cls.file = desk.path / "body.mcap"
        patches = [("palm", f"sim:{MODEL}"), ("back", f"sim:{MODEL}"), ("gone", "tcp:127.0.0.1:1")]
        place = 'link = "wrist_3"\nposition = [0, 0, 0.04]\norientation = [0, 0, 0, 1]\n'
        table = "[[patches]]\nname = '{}'\nskin = '{}'\nport = '{}'\n{}"
        body = "".join(table.format(name, MODEL, port, place) for name, port in patches)
        (desk.path / "body.toml").write_text(f'name = "arm"\n{body}')
        cls.content = served(desk.path / "body.toml", cls.file, seconds=8)

    def test_every_reader_finds_the_same_in_it(self):
        # Frames of one skin's tare come into the file when it is over, after later ones of another skin.
        wanted = {topic: sorted(messages) for topic, messages in self.content.messages.items()}
        for found in [readers.mcap_from_start(self.file), readers.node("stream", self.file), readers.node("index", self.file)]:
            found.messages = {topic: sorted(messages) for topic, messages in found.messages.items()}
            self.assertIsNone(difference(vars(found), {**vars(self.content), "messages": wanted}))
        found = readers.rosbags_by_index(self.file)
        self.assertIsNone(difference(without_numbers(found.messages), without_numbers(self.content.messages)))

    def test_topics_of_each_skin_are_in_its_space(self):
        wanted = {}
        for topic, name in TYPES.items():
            for space in ["arm/palm", "arm/back"]:
                wanted[topic.replace("/dermatome/", f"/{space}/")] = [name, "ros2msg", "cdr"]
        self.assertEqual(self.content.types, wanted)

    def test_frames_of_each_skin_are_there_once_from_its_reference_on(self):
        for space in ["arm/palm", "arm/back"]:
            sequences = [frame["sequence"] for frame in self.content.of(f"/{space}/measurements")]
            self.assertGreater(len(sequences), 50)
            self.assertEqual(sequences, list(range(sequences[0], sequences[0] + len(sequences))))
            references = self.content.of(f"/{space}/reference")
            self.assertIn(references[0]["first_sequence"], sequences)

    def test_messages_on_a_topic_are_numbered_also_where_skins_share_it(self):
        for topic, messages in self.content.messages.items():
            self.assertEqual(sorted(number for number, _, _ in messages), list(range(len(messages))), topic)
        # Each message tells of all, as who seeks takes the last one.
        for message in self.content.of("/tf_static"):
            frames = [transform["child_frame_id"] for transform in message["transforms"]]
            self.assertEqual(frames, ["arm/palm", "arm/back", "arm/gone"])

    def test_what_lasts_is_published_again(self):
        with Reader(self.file) as reader:
            [quality] = [it.ext.offered_qos_profiles[0] for it in reader.connections if it.topic == "/tf_static"]
        self.assertEqual((quality.durability.name, quality.depth), ("TRANSIENT_LOCAL", 1))

    def test_it_tells_of_the_body_and_of_each_skin_that_was_there(self):
        self.assertEqual(self.content.metadata["dermatome"]["patches"], "palm back gone")
        self.assertEqual(set(self.content.metadata), {"dermatome", "arm/palm/dermatome", "arm/back/dermatome"})
        attached = {f"arm/{patch}/{name}" for patch in ["palm", "back"] for name in ["patch.dermatome", "skin.toml"]}
        self.assertEqual(set(self.content.attachments), attached)


class RobotRecording(unittest.TestCase):
    """A recording of a robot whose description is known."""

    @classmethod
    def setUpClass(cls):
        cls.file = desk.path / "robot.mcap"
        cls.content = served(ARM, cls.file, seconds=8)

    def test_every_reader_finds_the_same_of_the_robot(self):
        topics = ["/links", "/tf", "/tf_static"]
        wanted = {topic: self.content.messages[topic] for topic in topics}
        for found in [readers.mcap_from_start(self.file), readers.node("stream", self.file)]:
            self.assertIsNone(difference({topic: found.messages[topic] for topic in topics}, wanted))
        found = readers.rosbags_by_index(self.file).messages
        found = without_numbers({topic: found[topic] for topic in topics})
        self.assertIsNone(difference(found, without_numbers(wanted)))

    def test_links_joints_and_skins_make_one_tree(self):
        [links] = self.content.of("/links")
        shown = {marker["header"]["frame_id"] for marker in links["markers"]}
        self.assertLessEqual({"upper_arm", "forearm", "hand"}, shown)
        parents = {}
        moving = self.content.of("/tf")
        self.assertGreater(len(moving), 40)
        for message in moving[:1] + self.content.of("/tf_static")[-1:]:
            for transform in message["transforms"]:
                parents[transform["child_frame_id"]] = transform["header"]["frame_id"]
        skins = {f"arm/{skin}" for skin in ["upper_arm", "forearm", "hand"]}

        def root(frame):
            return root(parents[frame]) if frame in parents else frame

        self.assertEqual(len({root(frame) for frame in skins | shown}), 1, parents)


class CutRecording(unittest.TestCase):
    """A recording whose end is missing: read from its start on, by those who can."""

    def test_without_its_last_1000_bytes_all_messages_are_there(self):
        cut = desk.cut(desk.whole.stat().st_size - 1000)
        for found in [readers.mcap_from_start(cut), readers.node("stream", cut)]:
            self.assertFalse(found.is_whole)
            found.is_whole = True
            self.assertIsNone(difference(vars(found), vars(content)))

    def test_cut_in_the_middle_it_ends_with_its_last_whole_chunk(self):
        length = desk.whole.stat().st_size * 3 // 5
        chunks = summary().chunk_indexes
        whole = [chunk for chunk in chunks if chunk.chunk_start_offset + chunk.chunk_length <= length]
        self.assertTrue(0 < len(whole) < len(chunks))
        cut = desk.cut(length)
        found, by_node = readers.mcap_from_start(cut), readers.node("stream", cut)
        self.assertIsNone(difference(vars(found), vars(by_node)))
        self.assertFalse(found.is_whole)
        end = max(chunk.message_end_time for chunk in whole)
        frames = [frame for frame in content.messages["/dermatome/measurements"] if frame[1] <= end]
        self.assertIsNone(difference(found.messages["/dermatome/measurements"], frames))
        self.assertEqual(found.attachments, content.attachments)

    def test_those_who_need_the_index_refuse_it(self):
        cut = desk.cut(desk.whole.stat().st_size - 1000)
        with self.assertRaises((McapError, struct.error)):
            readers.mcap_by_index(cut)
        with self.assertRaises(ReaderError):
            readers.rosbags_by_index(cut)
        with self.assertRaises(ValueError):
            readers.node("index", cut)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    PROGRAM = Path(sys.argv.pop(1)).resolve()
    unittest.main()
