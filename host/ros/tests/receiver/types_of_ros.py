"""Message types as DDS has them: made of ROS' own definitions, and of the `.msg` and `.srv` files of dermatome_msgs."""

import types
from dataclasses import dataclass
from pathlib import Path

import cyclonedds.idl.types as idl
from cyclonedds.idl import IdlStruct
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

PACKAGE = Path(__file__).parents[3] / "messages" / "dermatome_msgs"
BASE = {
    "bool": bool,
    "byte": idl.uint8,
    "string": str,
    **{name: getattr(idl, name) for name in ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"]},
    "float32": idl.float32,
    "float64": idl.float64,
}


def definitions():
    """All types by name, `package/msg/Name`; requests and responses of services as well."""
    store = get_typestore(Stores.ROS2_JAZZY)
    for path in sorted(PACKAGE.glob("msg/*.msg")):
        store.register(get_types_from_msg(path.read_text(), f"dermatome_msgs/msg/{path.stem}"))
    for path in sorted(PACKAGE.glob("srv/*.srv")):
        for part, text in zip(["Request", "Response"], path.read_text().split("---")):
            store.register(get_types_from_msg(text, f"dermatome_msgs/msg/{path.stem}_{part}"))
    response = "bool success\nstring message"
    store.register(get_types_from_msg(response, "std_srvs/msg/Trigger_Response"))
    # The byte that an empty message has in DDS.
    empty = "uint8 structure_needs_at_least_one_member"
    store.register(get_types_from_msg(empty, "std_srvs/msg/Trigger_Request"))
    return store.fielddefs


DEFINITIONS = definitions()
made = {}


def field_type(node, args):
    """The type of a field: a number or text, a message, or a list of either."""
    match node.name:
        case "BASE":
            return BASE[args[0]]
        case "NAME":
            return message(args)
        case "ARRAY":
            return idl.array[field_type(*args[0]), args[1]]
        case "SEQUENCE":
            return idl.sequence[field_type(*args[0])]


def message(name, before=()):
    """The type `package/msg/Name`, which DDS calls `package::msg::dds_::Name_`, with fields before its own."""
    if (name, before) not in made:
        package, kind, short = name.split("/")
        fields = [*before, *((field, field_type(*of)) for field, of in DEFINITIONS[name.replace("/srv/", "/msg/")][1])]
        body = {"__annotations__": dict(fields), "__module__": __name__}
        options = {"typename": f"{package}::{kind}::dds_::{short}_"}
        made[name, before] = dataclass(types.new_class(short, (IdlStruct,), options, lambda space: space.update(body)))
    return made[name, before]


# What rmw_cyclonedds_cpp puts before each request and response: who asks, and which of its requests.
CALL = (("guid", idl.uint64), ("number", idl.int64))


def service(name, part):
    """A request or response as rmw_cyclonedds_cpp sends it."""
    return message(f"{name}_{part}", CALL)
