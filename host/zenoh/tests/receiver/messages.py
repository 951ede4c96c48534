"""Messages of `dermatome serve --zenoh`, read from postcard's encoding by src/message.rs."""

import math
import struct
from types import SimpleNamespace


class Reader:
    """Takes values off the front of bytes."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        taken = self.data[self.at : self.at + count]
        if len(taken) < count:
            raise ValueError(f"ends after {len(self.data)} bytes")
        self.at += count
        return taken

    def number(self):
        """Seven bits a byte, the lowest first."""
        value, shift = 0, 0
        while True:
            [byte] = self.take(1)
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
            shift += 7

    def floats(self, count, kind="f"):
        return list(struct.unpack(f"<{count}{kind}", self.take(count * struct.calcsize(kind))))

    def float(self):
        return self.floats(1)[0]

    def maybe(self, read):
        return read() if self.take(1) == b"\1" else None

    def list(self, read):
        return [read() for _ in range(self.number())]

    def text(self):
        return self.take(self.number()).decode()

    def end(self, value):
        if self.at != len(self.data):
            raise ValueError(f"{len(self.data) - self.at} bytes are left")
        return value


def stamp(data):
    it = Reader(data)
    version = (it.number(), it.take(8).hex())
    return it.end(SimpleNamespace(version=version, run=it.number(), number=it.number()))


def contacts(data):
    it = Reader(data)
    sequence, timestamp_us, flags = it.number(), it.number(), it.number()
    frame = SimpleNamespace(sequence=sequence, timestamp_us=timestamp_us, flags=flags)
    frame.ended_ns, frame.missing = it.number(), it.number()
    frame.contacts = it.list(lambda: contact(it))
    return it.end(frame)


def contact(it):
    found = SimpleNamespace(position=it.floats(3), normal=it.floats(3))
    found.area, found.strength, found.peak = it.floats(3)
    found.pressure, found.load_area = it.maybe(it.float), it.maybe(it.float)
    found.evidence = it.maybe(lambda: it.floats(3))
    found.identity = it.maybe(lambda: identity(it))
    found.geometric_centre = it.floats(3, "d")
    found.wrench = it.maybe(lambda: it.floats(6, "d"))
    found.pixels = it.list(it.number)
    return found


def identity(it):
    found = SimpleNamespace(number=it.number(), velocity=it.floats(3))
    found.merged, found.split_from = it.maybe(it.number), it.maybe(it.number)
    return found


def image(data):
    it = Reader(data)
    at = [it.number() for _ in range(4)]
    [exponent] = struct.unpack("b", it.take(1))

    def mantissa():
        value = it.number()
        return (value >> 1) ^ -(value & 1)

    return it.end(SimpleNamespace(sequence=at[0], ended_ns=at[3], exponent=exponent, mantissas=it.list(mantissa)))


PHASES = ["no_board", "lost", "no_patch", "other_patch", "not_tared", "taring", "live", "ended"]


def state(data):
    it = Reader(data)
    found = SimpleNamespace(computer=it.text(), phase=PHASES[it.number()], text=it.text())
    found.frames, found.missing, found.losses = it.number(), it.number(), it.number()
    return it.end(found)


def skin(data):
    it = Reader(data)
    found = SimpleNamespace(file=it.text(), position=it.floats(3, "d"), orientation=it.floats(4, "d"))
    found.centres = it.list(lambda: it.floats(3))
    return it.end(found)


def tare(data):
    it = Reader(data)
    found = SimpleNamespace(made_ns=it.maybe(it.number))
    found.voltages = it.list(lambda: it.floats(1, "d")[0])
    return it.end(found)


def outcome(data):
    it = Reader(data)
    return it.end(SimpleNamespace(success=it.take(1) == b"\1", message=it.text()))


def drive(frequency=math.nan, amplitude=math.nan, frame_rate=math.nan, gain=255):
    """What `ask/drive` takes: Hz, A, 1/s, 0 for an automatic gain; what is left out stays as it is."""
    return struct.pack("<3fB", frequency, amplitude, frame_rate, gain)
