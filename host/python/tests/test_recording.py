"""Recordings: arrays, frames, what the program prints of them, and what a reader of others finds."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import DISC, SQUARE, Recorded, run
from mcap.reader import SeekingReader
from mcap.writer import CompressionType, Writer
from mcap_ros2.decoder import DecoderFactory

import dermatome


def messages(path: Path, topic: str) -> list[Any]:
    """Messages on a topic, by a reader of others."""
    with path.open("rb") as file:
        reader = SeekingReader(file, decoder_factories=[DecoderFactory()])
        return [message for *_, message in reader.iter_decoded_messages(topics=[topic])]


@pytest.fixture(scope="module")
def long(recorded: Recorded, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The messages of a recording fifty times over."""
    path = tmp_path_factory.mktemp("long") / "long.mcap"
    with recorded.path.open("rb") as source, path.open("wb") as target:
        reader = SeekingReader(source)
        writer = Writer(target, chunk_size=512 * 1024, compression=CompressionType.LZ4)
        writer.start("", "")
        for metadata in reader.iter_metadata():
            writer.add_metadata(metadata.name, metadata.metadata)
        for item in reader.iter_attachments():
            writer.add_attachment(item.create_time, item.log_time, item.name, item.media_type, item.data)
        summary = reader.get_summary()
        assert summary is not None
        schemas = {
            number: writer.register_schema(schema.name, schema.encoding, schema.data)
            for number, schema in summary.schemas.items()
        }
        channels = {
            number: writer.register_channel(channel.topic, channel.message_encoding, schemas[channel.schema_id])
            for number, channel in summary.channels.items()
        }
        messages = [message for *_, message in reader.iter_messages()]
        for message in messages * 50:
            writer.add_message(
                channels[message.channel_id], message.log_time, message.data, message.publish_time, message.sequence
            )
        writer.finish()  # type: ignore[no-untyped-call]
    return path


def test_more_than_20_000_frames_a_second_become_arrays(recorded: Recorded, long: Path) -> None:
    """Of the processor's time, which does not depend on what else runs; benches/throughput.py measures by the clock."""
    recording = dermatome.Recording(long)

    def seconds() -> float:
        begun = time.process_time()
        recording.read()
        return time.process_time() - begun

    images = recording.images()
    assert len(images) == 50 * len(dermatome.Recording(recorded.path).times()) == 6000
    rate = len(images) / min(seconds() for _ in range(5))
    print(f"{rate:,.0f} frames per second")
    assert rate > 20_000


def test_arrays_have_a_row_for_each_frame(recorded: Recorded) -> None:
    recording = dermatome.Recording(recorded.path)
    frames = list(recording)
    assert len(frames) >= 120, "100, and those of the reference"
    arrays = recording.read()
    assert arrays.frames.dtype == dermatome.FRAME
    assert arrays.frames["sequence"].tolist() == [frame.sequence for frame in frames]
    assert arrays.frames["time"].tolist() == [frame.time for frame in frames]
    received = arrays.frames["received"].astype("int64") / 1e9
    assert received == pytest.approx(np.array([frame.received for frame in frames]), abs=1e-6)
    assert arrays.images is not None and arrays.measurements is not None and arrays.quadrature is not None
    assert arrays.measurements.dtype == np.int32
    assert np.array_equal(arrays.measurements, [frame.measurements for frame in frames])  # type: ignore[arg-type]
    images = [np.full(784, np.nan) if frame.image is None else frame.image for frame in frames]
    assert np.array_equal(arrays.images, images, equal_nan=True)
    assert arrays.images.dtype == np.float32
    # While a reference is averaged there is no image.
    assert np.isnan(arrays.images).any(axis=1).sum() == 20
    contacts = np.concatenate([frame.contacts for frame in frames if frame.contacts is not None])
    assert arrays.contacts is not None and arrays.contacts.dtype == dermatome.CONTACT
    assert arrays.contacts.tobytes() == contacts.tobytes()
    assert arrays.frames["reference"].tolist() == [1] * len(frames)


def test_each_array_by_itself_is_the_same(recorded: Recorded) -> None:
    recording = dermatome.Recording(recorded.path)
    arrays = recording.read()
    assert recording.frames().tobytes() == arrays.frames.tobytes()
    assert np.array_equal(recording.times(), arrays.frames["time"])
    assert np.array_equal(recording.measurements(), arrays.measurements)  # type: ignore[arg-type]
    assert np.array_equal(recording.quadrature(), arrays.quadrature)  # type: ignore[arg-type]
    assert np.array_equal(recording.images(), arrays.images, equal_nan=True)  # type: ignore[arg-type]
    assert recording.contacts().tobytes() == arrays.contacts.tobytes()  # type: ignore[union-attr]
    without = recording.read(images=False, contacts=False)
    assert (without.images, without.contacts) == (None, None)


def test_a_reader_of_others_finds_the_same_numbers(recorded: Recorded) -> None:
    arrays = dermatome.Recording(recorded.path).read()
    raw = messages(recorded.path, "/dermatome/measurements")
    assert np.array_equal([message.in_phase for message in raw], arrays.measurements)  # type: ignore[arg-type]
    images = messages(recorded.path, "/dermatome/image")
    values = [np.array(message.mantissas) * 2.0 ** -message.exponent for message in images]
    assert arrays.images is not None
    assert np.array_equal(values, arrays.images[~np.isnan(arrays.images).any(axis=1)])
    found = [contact for message in messages(recorded.path, "/dermatome/contacts") for contact in message.contacts]
    contacts = arrays.contacts
    assert contacts is not None and len(contacts) == len(found) > 50
    for name in ["id", "area", "strength", "peak", "significance", "position_deviation", "strength_deviation"]:
        assert contacts[name].tolist() == [getattr(contact, name) for contact in found], name
    for name in ["position", "normal", "velocity"]:
        of_others = [[getattr(contact, name).x, getattr(contact, name).y, getattr(contact, name).z] for contact in found]
        assert np.array_equal(contacts[name], np.array(of_others, dtype=np.float32)), name


def test_the_program_replays_and_had_printed_the_same_contacts(recorded: Recorded) -> None:
    ran = run("replay", recorded.path)
    assert ran.returncode == 0 and "bit for bit" in ran.stderr, ran.stderr
    replayed = [line.split("\t") for line in ran.stdout.splitlines()]
    printed = [line.split("\t")[:10] for line in recorded.printed]
    assert [fields[:9] for fields in replayed] == [fields[:9] for fields in printed]
    contacts = dermatome.Recording(recorded.path).contacts()
    lines = [
        [str(at["sequence"]), f"{at['time']:.6f}", *(f"{1e3 * x:.3f}" for x in at["position"].astype(float))]
        for at in contacts
    ]
    numbers = np.array([fields[:5] for fields in replayed], dtype=float)
    assert np.array(lines, dtype=float) == pytest.approx(numbers, abs=1.1e-3)
    strengths = np.array([fields[6] for fields in replayed], dtype=float)
    assert contacts["strength"] == pytest.approx(strengths, abs=1e-6)


def test_contacts_lie_on_the_link_where_the_recording_was_made_with_its_skin_file(
    recorded_on_link: Recorded,
) -> None:
    recording = dermatome.Recording(recorded_on_link.path)
    skin = recording.skin
    assert skin is not None and skin.name == "square-50mm"
    assert skin.pose is not None and skin.pose.position == (0.12, -0.03, 0.5)
    printed = [json.loads(line) for line in recorded_on_link.printed]
    places = [contact["position_m"] for frame in printed for contact in frame["contacts"]]
    assert np.array_equal(recording.contacts()["position"], np.array(places, dtype=np.float32))


def test_a_recording_tells_what_it_is_of(recorded: Recorded) -> None:
    recording = dermatome.Recording(str(recorded.path))
    assert (recording.board, recording.frame_source) == ("simulated", "simulated")
    assert recording.port == f"sim:{recorded.skin_file}"
    assert recording.patch.skin == "square-50mm" and recording.patch.pixels == 784
    assert recording.skin is None, "it was made without --skin"
    assert recording.path == recorded.path
    assert repr(recording) == f"<Recording {recorded.path}: square-50mm on simulated>"


def test_a_recording_that_was_cut_gives_what_it_holds(recorded: Recorded, tmp_path: Path) -> None:
    whole = dermatome.Recording(recorded.path).measurements()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(recorded.path.read_bytes()[: recorded.path.stat().st_size * 3 // 5])
    found = dermatome.Recording(cut).measurements()
    assert 0 < len(found) < len(whole)
    assert np.array_equal(found, whole[: len(found)])


def test_one_of_several_skins_is_named_behind_the_file(tmp_path: Path) -> None:
    path, body = tmp_path / "run.mcap", tmp_path / "body.toml"
    place = 'link = "wrist_3"\nposition = [0, 0, 0.04]\norientation = [0, 0, 0, 1]\n'
    skins = [("palm", DISC), ("back", SQUARE)]
    tables = [f"[[patches]]\nname = '{name}'\nskin = '{skin}'\nport = 'sim:{skin}'\n{place}" for name, skin in skins]
    body.write_text('name = "arm"\n' + "".join(tables))
    ran = run("serve", body, "--record", path, "--duration", "8")
    assert ran.returncode == 0, ran.stderr
    for name, skin, pixels in [("palm", "disc-210mm", 812), ("back", "square-50mm", 784)]:
        recording = dermatome.Recording(f"{path}:{name}")
        assert (recording.patch.skin, recording.board) == (skin, "simulated")
        arrays = recording.read()
        assert arrays.images is not None and arrays.images.shape == (len(arrays.frames), pixels)
        assert np.all(np.diff(arrays.frames["sequence"].astype(np.int64)) == 1)
        found = recording.skin
        assert found is not None and found.pose is not None and found.pose.link == "wrist_3"
    with pytest.raises(dermatome.Error, match="allowed: one of them behind the file's name: `:palm`, `:back`"):
        dermatome.Recording(path)
    with pytest.raises(dermatome.Error, match="not of a skin `foot`"):
        dermatome.Recording(f"{path}:foot")
