"""Programs of others that read recordings: each gives what it found as the same plain data."""

import hashlib
import json
import struct
import subprocess
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from pathlib import Path

import numpy as np
from mcap.exceptions import EndOfFile
from mcap.reader import SeekingReader
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

NODE = Path(__file__).with_name("read.mjs")


@dataclass
class Content:
    """What a reader found in a recording."""

    # Of each topic: its type, how that is written, how messages are encoded.
    types: dict = field(default_factory=dict)
    # Of each topic, in the reader's order: number, time of arrival (ns), message.
    messages: dict = field(default_factory=dict)
    # Of each attachment: its media type, and the SHA-256 of its bytes.
    attachments: dict = field(default_factory=dict)
    metadata: dict = field(default_factory=dict)
    is_whole: bool = True

    def of(self, topic):
        """The messages on a topic."""
        return [message for _, _, message in self.messages[topic]]


def plain(value):
    """A message as dicts, lists and numbers; what is no number in JSON is a word."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (bytes, bytearray)):
        return list(value)
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return value if np.isfinite(value) else str(value)
    if isinstance(value, (bool, int, str)):
        return value
    return {name: plain(getattr(value, name)) for name in names_of(value)}


def names_of(message):
    """The fields of a message of rosbags, where constants are fields with a default, or of mcap_ros2."""
    if is_dataclass(message):
        return [item.name for item in fields(message) if item.default is MISSING]
    return message.__slots__


def take_channel(content, schema, channel):
    content.types[channel.topic] = [schema.name, schema.encoding, channel.message_encoding]
    content.messages.setdefault(channel.topic, [])


def take_message(content, channel, message, decoded):
    content.messages[channel.topic].append([message.sequence, message.log_time, plain(decoded)])


def take_attachment(content, attachment):
    digest = hashlib.sha256(attachment.data).hexdigest()
    content.attachments[attachment.name] = [attachment.media_type, digest]


def mcap_by_index(path):
    """Python's mcap, by the index at the file's end."""
    content = Content()
    with path.open("rb") as file:
        reader = SeekingReader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        for channel in summary.channels.values():
            take_channel(content, summary.schemas[channel.schema_id], channel)
        for _, channel, message, decoded in reader.iter_decoded_messages():
            take_message(content, channel, message, decoded)
        for attachment in reader.iter_attachments():
            take_attachment(content, attachment)
        content.metadata = {record.name: record.metadata for record in reader.iter_metadata()}
    return content


def mcap_from_start(path):
    """Python's mcap, record by record, up to where the file was cut."""
    content, schemas, channels, factory = Content(), {}, {}, DecoderFactory()
    with path.open("rb") as file:
        try:
            for record in StreamReader(file, validate_crcs=True).records:
                match record:
                    case Schema():
                        schemas[record.id] = record
                    case Channel():
                        channels[record.id] = record
                        take_channel(content, schemas[record.schema_id], record)
                    case Message():
                        channel = channels[record.channel_id]
                        decode = factory.decoder_for(channel.message_encoding, schemas[channel.schema_id])
                        take_message(content, channel, record, decode(record.data))
                    case Attachment():
                        take_attachment(content, record)
                    case Metadata():
                        content.metadata[record.name] = record.metadata
        # The latter where it is cut within a number.
        except (EndOfFile, struct.error):
            content.is_whole = False
    return content


def rosbags_by_index(path):
    """rosbags, by the index; it tells neither numbers nor attachments."""
    content = Content()
    with Reader(path) as reader:
        store = types_of(reader)
        for connection in reader.connections:
            encodings = [connection.msgdef.format.name, connection.ext.serialization_format]
            content.types[connection.topic] = [connection.msgtype, *encodings]
            content.messages[connection.topic] = []
        for connection, time, data in reader.messages():
            message = store.deserialize_cdr(data, connection.msgtype)
            content.messages[connection.topic].append([None, time, plain(message)])
    return content


def types_of(reader):
    """The types that a recording describes, as rosbags understands them."""
    store = get_typestore(Stores.EMPTY)
    for connection in reader.connections:
        store.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
    return store


def node(way, path):
    """npm's @mcap/core: `stream`, up to where the file was cut, or `index`."""
    ran = subprocess.run(["node", NODE, way, path], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if ran.returncode != 0:
        raise ValueError(ran.stderr)
    found = json.loads(ran.stdout)
    messages = {
        topic: [[sequence, int(time), message] for sequence, time, message in of_topic]
        for topic, of_topic in found["messages"].items()
    }
    return Content(found["types"], messages, found["attachments"], found["metadata"], found["isWhole"])
