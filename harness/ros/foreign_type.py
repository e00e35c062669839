"""Message types that no wheel ships, such as tf2_msgs: bytes of rosbags under the type's own name.

rclpy publishes bytes as they are, and rosbags knows the types and serialises them. What is missing is
a type support: where the middleware asks for name and hash of a type. It is made of another type's for
Fast DDS, in which name and hash are replaced. Its functions still are the other type's, so messages of
such a class are published as bytes and received raw, never as objects; only the hash is given of the
type, no definition (Fast DDS would send the other's).
"""

import ctypes
from contextlib import suppress
from functools import cache
from importlib import import_module
from importlib.metadata import version
from typing import Any

from geometry_msgs.msg import PoseArray
from rclpy.utilities import get_rmw_implementation_identifier

from harness.base.message_types import typestore

FAST_DDS = "rmw_fastrtps_cpp"
TYPE_SUPPORT = b"rosidl_typesupport_fastrtps_c"
DEFINITION = b"rosidl_typesupport_introspection_c"
FORMER = int(version("rclpy").split(".")[0]) < 9  # before Kilted
DONOR = PoseArray  # of no fixed size, as a TFMessage


class _Callbacks(ctypes.Structure):
    """message_type_support_callbacks_t of rosidl_typesupport_fastrtps_cpp."""

    _fields_ = (
        ("message_namespace", ctypes.c_char_p),
        ("message_name", ctypes.c_char_p),
        ("functions", ctypes.c_void_p * 4),
        ("key_callbacks", ctypes.c_void_p),  # from Kilted on; without them nobody reads it
    )


class _Hash(ctypes.Structure):
    """rosidl_type_hash_t."""

    _fields_ = (("version", ctypes.c_uint8), ("value", ctypes.c_uint8 * 32))


class _Support(ctypes.Structure):
    """rosidl_message_type_support_t, as it is since Iron."""


_Find = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p)
_GetHash = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)
_Support._fields_ = (
    ("identifier", ctypes.c_char_p),
    ("data", ctypes.POINTER(_Callbacks)),
    ("find", _Find),
    ("get_type_hash", _GetHash),
    ("get_description", ctypes.c_void_p),
    ("get_sources", ctypes.c_void_p),
)

_python = ctypes.pythonapi
_python.PyCapsule_GetName.restype = ctypes.c_char_p
_python.PyCapsule_GetPointer.restype = ctypes.c_void_p
_python.PyCapsule_New.restype = ctypes.py_object
_kept: list[object] = []  # the middleware holds addresses of them, as long as the process lives


@cache
def message_type(name: str) -> type | None:
    """Returns the class of a type such as tf2_msgs/msg/TFMessage; one not installed is for bytes only.

    Returns:
        None if it is not installed and the middleware is not Fast DDS, or nobody knows it.
    """
    package, _, kind = name.split("/")
    try:
        installed: type = getattr(import_module(f"{package}.msg"), kind)
    except (ImportError, AttributeError):
        if get_rmw_implementation_identifier() != FAST_DDS or name not in typestore().types:
            return None
        return _made(package, kind)
    return installed


def forget_missing_definition() -> None:
    """Clears the error in which rmw notes that a made type has no definition to be sent.

    Call it when a publisher or subscription has been created: else the next error finds this one there
    and rcutils prints both.
    """
    with suppress(OSError):  # it would only be printed
        ctypes.CDLL("librcutils.so").rcutils_reset_error()


def _made(package: str, kind: str) -> type:
    """A class that rclpy takes for that of a message."""
    digest = typestore().hash_rihs01(f"{package}/msg/{kind}").removeprefix("RIHS01_")
    capsule = _capsule(f"{package}::msg".encode(), kind.encode(), bytes.fromhex(digest))
    functions = {name: getattr(type(DONOR), name) for name in vars(type(DONOR)) if name[1:].isupper()}
    metaclass: Any = type(f"Metaclass_{kind}", (type,), functions | {"_TYPE_SUPPORT": capsule})
    made: type = metaclass(kind, (), {"__module__": f"{package}.msg"})
    return made


def _capsule(namespace: bytes, name: bytes, digest: bytes) -> object:
    """The type support of Fast DDS under another name and hash, as rclpy wants it."""
    type(DONOR).__import_type_support__()
    donor = type(DONOR)._TYPE_SUPPORT  # noqa: SLF001 - rclpy's interface to generated classes
    label = _python.PyCapsule_GetName(ctypes.py_object(donor))
    label = None if label is None else ctypes.create_string_buffer(label)
    address = _python.PyCapsule_GetPointer(ctypes.py_object(donor), label)
    whole = _Support.from_address(address)
    support = _Support.from_buffer_copy(_Support.from_address(whole.find(address, TYPE_SUPPORT)))
    callbacks = _Callbacks.from_buffer_copy(support.data.contents)
    callbacks.message_namespace, callbacks.message_name = namespace, name
    type_hash = _Hash(1, (ctypes.c_uint8 * 32)(*digest))
    support.data = ctypes.pointer(callbacks)
    if FORMER:  # creates nothing without a definition, and sends none
        fields = whole.find(address, DEFINITION)
        handles = {TYPE_SUPPORT: ctypes.addressof(support), DEFINITION: fields}
        support.find = _Find(lambda _, identifier: handles.get(identifier))
    # No Python of ours may run there: a signal's handler would raise in it, which nobody could catch.
    support.get_type_hash = _GetHash({ctypes.addressof(support): ctypes.addressof(type_hash)}.get)
    _kept.extend((support, callbacks, type_hash, label))
    capsule: object = _python.PyCapsule_New(ctypes.c_void_p(ctypes.addressof(support)), label, None)
    return capsule
