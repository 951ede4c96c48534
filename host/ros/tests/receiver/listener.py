"""A participant of DDS, with Cyclone DDS, that keeps all that it receives on this computer."""

import functools
import threading
import time

from cyclonedds._clayer import ddspy_take
from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from types_of_ros import message, service

# Without multicast, which the loopback interface does not have, and as ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST has it.
LOOPBACK = """<CycloneDDS><Domain id="any">
<General><AllowMulticast>false</AllowMulticast><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""

RELIABLE = Policy.Reliability.Reliable(duration(seconds=1))
SENSOR_DATA = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5))
USUAL = Qos(RELIABLE, Policy.History.KeepLast(10))
LASTING = Qos(RELIABLE, Policy.Durability.TransientLocal, Policy.History.KeepLast(1))
ANY = ViewState.Any | SampleState.Any | InstanceState.Any


class Received:
    """A message, decoded when it is looked at: what arrives meanwhile does not wait for it."""

    def __init__(self, kind, data):
        # ns since 1970.
        self.came = time.time_ns()
        self.kind, self.data = kind, data

    @functools.cached_property
    def message(self):
        return self.kind.deserialize(self.data)


class Listener:
    """Receives topics from its start on, in a thread: `received[topic]`."""

    def __init__(self, domain):
        self.domain = Domain(domain, LOOPBACK)
        self.participant = DomainParticipant(domain)
        self.received = {}
        self.readers = {}
        self.writers = {}
        self.waits = WaitSet(self.participant)
        self.lock = threading.Lock()
        self.is_over = False
        self.calls = 0
        self.thread = threading.Thread(target=self.receive, daemon=True)
        self.thread.start()

    def listen(self, topic, kind, qos=SENSOR_DATA):
        """Receives messages of this type, as ROS' topic of this name."""
        self.read(f"rt{topic}", topic, message(kind), qos)

    def read(self, name, topic, kind, qos):
        reader = DataReader(self.participant, Topic(self.participant, name, kind), qos)
        with self.lock:
            self.received[topic] = []
            self.readers[topic] = (reader, kind, ReadCondition(reader, ANY))
            self.waits.attach(self.readers[topic][2])

    def receive(self):
        while not self.is_over:
            self.waits.wait(duration(milliseconds=100))
            with self.lock:
                for topic, (reader, kind, _) in self.readers.items():
                    for data, info in ddspy_take(reader._ref, ANY, 64):
                        if info.valid_data:
                            self.received[topic].append(Received(kind, data))

    def of(self, topic):
        """The messages that have come."""
        return [it.message for it in list(self.received[topic])]

    def wait(self, topic, is_wanted=lambda _: True, seconds=20, since=None):
        """The first message that is wanted, from now on or after so many."""
        begun, seen = time.monotonic(), len(self.received[topic]) if since is None else since
        while time.monotonic() < begun + seconds:
            for it in self.received[topic][seen:]:
                if is_wanted(it.message):
                    return it.message
            time.sleep(0.01)
        raise TimeoutError(f"{topic}: nothing of {len(self.received[topic]) - seen} messages is what was waited for")

    def call(self, name, kind, *arguments, seconds=20):
        """Asks a service as rmw_cyclonedds_cpp does."""
        request, reply = service(kind, "Request"), f"{name} reply"
        if reply not in self.received:
            self.read(f"rr{name}Reply", reply, service(kind, "Response"), USUAL)
            self.writers[name] = DataWriter(self.participant, Topic(self.participant, f"rq{name}Request", request), USUAL)
            # Until both have found each other.
            time.sleep(2)
        self.calls += 1
        call, since = (0x0102030405060708, self.calls), len(self.received[reply])
        self.writers[name].write(request(*call, *arguments))
        return self.wait(reply, lambda response: (response.guid, response.number) == call, seconds, since)

    def stop(self):
        self.is_over = True
        self.thread.join()
