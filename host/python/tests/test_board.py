"""Boards: simulated ones, and recordings played as ports."""

from __future__ import annotations

import itertools
import subprocess
import threading
import time
from typing import Any

import numpy as np
import pytest
from conftest import DISC, POSE, SQUARE, Recorded, program
from numpy.typing import NDArray

import dermatome

# x, y, radius in m, and relative change of conductivity.
FINGER = (0.04, 0.03, 0.0126, 1.0)


@pytest.fixture(scope="module")
def pressed(disc: dermatome.Skin) -> list[dermatome.Frame]:
    """Frames of a disc on which a finger rests."""
    with dermatome.simulate(disc, [FINGER], paced=False) as board:
        board.tare()
        return list(itertools.islice(board.stream(measurements=True, health=True), 50))


def test_a_press_at_a_known_place_is_found_there(pressed: list[dermatome.Frame]) -> None:
    for frame in pressed[-10:]:
        assert frame.contacts is not None
        [contact] = frame.contacts
        assert np.linalg.norm(contact["position"] - [0.04, 0.03, 0]) < 0.003
        assert contact["normal"] == pytest.approx([0, 0, 1])
        assert contact["sequence"] == frame.sequence
        assert contact["significance"] > 20
        assert np.isnan(contact["force"]), "the skin is not calibrated"


def test_its_image_is_strongest_there(disc: dermatome.Skin, pressed: list[dermatome.Frame]) -> None:
    patch = disc.build_patch()
    image = pressed[-1].image
    assert image is not None and image.dtype == np.float32 and image.shape == (patch.pixels,)
    strongest = patch.pixel_centre[np.argmax(image)]
    assert np.linalg.norm(strongest - [0.04, 0.03, 0]) < 0.01
    picture = patch.picture(image)
    assert picture is not None and patch.extent is not None
    left, right, bottom, top = patch.extent
    row, column = np.unravel_index(np.nanargmax(picture), picture.shape)
    pitch = (right - left) / picture.shape[1]
    assert (left + (column + 0.5) * pitch, top - (row + 0.5) * pitch) == pytest.approx(strongest[:2], abs=1e-6)
    assert np.count_nonzero(~np.isnan(picture)) == patch.pixels
    assert pitch == pytest.approx((top - bottom) / picture.shape[0])


def test_all_parts_of_a_frame_are_arrays(disc: dermatome.Skin, pressed: list[dermatome.Frame]) -> None:
    frame = pressed[-1]
    assert frame.measurements is not None and frame.quadrature is not None and frame.health is not None
    assert frame.measurements.dtype == np.int32 and frame.measurements.shape == (len(disc.steps),)
    assert len(frame.health.contact_impedance) == disc.electrodes
    assert (frame.health.open, frame.health.shorted, frame.flags) == ([], [], [])
    sequences = [frame.sequence for frame in pressed]
    assert sequences == list(range(sequences[0], sequences[0] + 50)), "an unpaced board loses nothing"
    assert np.diff([frame.time for frame in pressed]) == pytest.approx(0.02, abs=1e-6)
    assert abs(frame.received - time.time()) < 60


def test_the_same_comes_of_the_voltages_and_the_model(
    disc: dermatome.Skin, pressed: list[dermatome.Frame]
) -> None:
    """The board's images are those of its own codes, by the matrix in double precision, up to their noise."""
    with dermatome.simulate(disc, [], paced=False) as board:
        untouched = list(itertools.islice(board.stream(measurements=True), 40))

    def mean(values: list[NDArray[Any] | None]) -> NDArray[np.float64]:
        return np.asarray(np.array(values).mean(axis=0), dtype=np.float64)

    codes = [mean([frame.measurements for frame in frames]) for frames in (pressed[20:], untouched)]
    image = disc.model().image(*codes)
    of_board = mean([frame.image for frame in pressed[20:]])
    assert np.abs(image - of_board).max() < 0.05 * np.abs(of_board).max()


def test_only_what_is_asked_for_comes() -> None:
    with dermatome.simulate(SQUARE, paced=False) as board, board.stream(images=False) as stream:
        frame = next(stream)
        assert frame.contacts is not None
        assert (frame.image, frame.measurements, frame.health) == (None, None, None)
    with dermatome.simulate(SQUARE, paced=False) as board:
        with pytest.raises(ValueError, match="a stream of nothing"):
            board.stream(images=False, contacts=False)
        sequences = [frame.sequence for frame in itertools.islice(board.stream(every=5), 4)]
        assert np.diff(sequences).tolist() == [5, 5, 5]


def test_a_board_says_what_it_is_and_holds(disc: dermatome.Skin) -> None:
    with dermatome.open(f"sim:{DISC}") as board:
        info = board.info
        assert (info.board, info.skin, info.frame_source) == ("simulated", "disc-210mm", "simulated")
        assert (info.electrodes, info.steps, info.measurements, info.pixels) == (16, 208, 104, 812)
        assert not info.tared
        board.tare(30)
        assert board.info.tared
        patch = board.patch()
        assert bytes(patch) == bytes(disc.build_patch()) and patch.crc == info.patch_crc
        assert board.port == f"sim:{DISC}"


def test_a_patch_is_flashed(tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("patch") / "square.dermatome"
    patch = dermatome.Skin.load(SQUARE).build_patch(path)
    with dermatome.simulate(DISC) as board:
        board.flash(path)
        assert (board.info.skin, board.info.patch_crc) == ("square-50mm", patch.crc)
        board.flash(dermatome.Patch.load(path))


def test_a_board_of_another_process_is_reached_by_tcp_and_says_when_it_has_gone(disc: dermatome.Skin) -> None:
    arguments = ["simulate", str(DISC), "--listen", "tcp:127.0.0.1:0", "--press", "0.04,0.03,0.0126,1"]
    with subprocess.Popen([program(), *arguments], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        port = process.stdout.readline().split()[-1]
        with dermatome.open(port) as board:
            assert board.info.skin is None
            with pytest.raises(dermatome.Error, match=f"the board holds no patch.*{port}"):
                board.tare()
            board.flash(disc.build_patch())
            board.tare()
            stream = board.stream()
            frames = list(itertools.islice(stream, 30))
            contacts = frames[-1].contacts
            assert contacts is not None and len(contacts) == 1
            assert np.linalg.norm(contacts[0]["position"] - [0.04, 0.03, 0]) < 0.003
            process.kill()
            with pytest.raises(dermatome.Error, match=f"the link to `{port}` was cut"):
                list(stream)


def test_the_drive_is_changed_and_given_back() -> None:
    with dermatome.simulate(SQUARE) as board:
        of_patch = board.drive
        drive = board.set_drive(amplitude=5e-5, gain=2, component="magnitude")
        assert drive.amplitude == pytest.approx(5e-5)
        assert (drive.gain, drive.component) == (2, "magnitude")
        assert drive.frequency == of_patch.frequency
        assert board.reset_drive().amplitude == of_patch.amplitude
        with pytest.raises(ValueError, match="drive.integration"):
            board.set_drive(integration=200)
        with pytest.raises(ValueError, match='allowed: "automatic"'):
            board.set_drive(gain="much")  # type: ignore[arg-type] # pyright: ignore[reportArgumentType]


def test_a_board_is_asked_while_it_streams_and_a_new_stream_ends_the_one_before() -> None:
    with dermatome.simulate(SQUARE, [], paced=False) as board:
        first = board.stream()
        next(first)
        assert board.info.tared
        board.tare(5)
        assert next(first).sequence > 0
        second = board.stream()
        assert next(second).image is not None
        assert len(list(first)) < 3000, "what was still waiting"
        second.close()
        assert len(list(second)) < 3000
        assert second.lost == 0


def test_frames_that_nobody_fetches_are_dropped_and_counted_but_not_of_a_board_that_can_wait() -> None:
    with dermatome.simulate(SQUARE, [], paced=False) as board:
        board.tare()
        stream = board.stream(images=False)
        first = next(stream)
        time.sleep(0.5)
        assert next(stream).sequence == first.sequence + 1
        assert (stream.dropped, stream.lost) == (0, 0)


def test_contacts_are_in_the_frame_of_the_link_where_the_skin_lies(tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("link") / "skin.toml"
    path.write_text(SQUARE.read_text() + POSE)
    skin = dermatome.Skin.load(path)
    assert skin.pose is not None and skin.pose.link == "wrist_3"
    with dermatome.simulate(skin, [(0.01, 0.005, 0.004, 1.0)], paced=False) as board:
        frames = list(itertools.islice(board.stream(skin=skin), 50))
        contacts = frames[-1].contacts
        assert contacts is not None and len(contacts) == 1
        [there] = skin.pose.points([[0.01, 0.005, 0.0]])
        assert np.linalg.norm(contacts[0]["position"] - there) < 0.002
        assert contacts[0]["normal"] == pytest.approx([1, 0, 0], abs=1e-6)
        with pytest.raises(dermatome.Error, match="`pose` is missing"):
            board.stream(skin=DISC)
        path.write_text(DISC.read_text() + POSE)
        with pytest.raises(dermatome.Error, match='`name` is "disc-210mm"; allowed: "square-50mm"'):
            board.stream(skin=path)
        path.write_text(SQUARE.read_text().replace("columns = 28", "columns = 24") + POSE)
        with pytest.raises(dermatome.Error, match="its pixels do not lie where those of the patch do"):
            board.stream(skin=path)


def test_a_finger_goes_round_and_other_threads_run_meanwhile() -> None:
    counted = 0

    def count() -> None:
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    done = threading.Event()
    with dermatome.open(f"sim:{SQUARE}") as board:
        board.tare()
        thread = threading.Thread(target=count)
        thread.start()
        frames = list(itertools.islice(board.stream(), 60))
        done.set()
        thread.join()
    assert counted > 200, "the interpreter's lock is free while a frame is waited for"
    places = np.concatenate([frame.contacts for frame in frames[20:] if frame.contacts is not None])
    assert len(places) > 20
    # Half way to the rim of 25 mm, an eighth of a turn a second.
    assert np.linalg.norm(places["position"], axis=1) == pytest.approx(0.0125, abs=0.002)


def test_a_recording_is_played_as_a_port_and_ends(recorded: Recorded) -> None:
    with dermatome.open(f"replay:{recorded.path}") as board:
        assert board.info.board == "replay"
        # It counts anew; times are those of the recording.
        played = {frame.time: frame for frame in board.stream(measurements=True)}
    same = 0
    for frame in dermatome.Recording(recorded.path):
        if frame.image is None or frame.contacts is None:
            continue
        again = played[frame.time]
        assert again.image is not None and again.contacts is not None
        assert np.array_equal(again.image, frame.image)
        again.contacts["sequence"] = frame.sequence
        assert again.contacts.tobytes() == frame.contacts.tobytes()
        same += 1
    assert same == 100
