"""Whoever has opened a page of viser, without a browser: what it is shown, and what it does."""

import threading
from contextlib import AbstractContextManager
from typing import Any

import msgspec
import numpy as np
import viser
import zstandard
from numpy.typing import NDArray
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from tests.support.waiting import wait_until

CAMERA = {
    "wxyz": (1.0, 0.0, 0.0, 0.0), "position": (0.0, 0.0, 1.0), "look_at": (1.0, 0.0, 0.0), "fov": 1.0,
    "up_direction": (0.0, 0.0, 1.0), "near": 0.1, "far": 99.0, "image_width": 64, "image_height": 64,
}  # fmt: skip


class Visitor(AbstractContextManager["Visitor"]):
    """Speaks what a browser speaks with the server; parts of the page go by their labels."""

    def __init__(self, address: str) -> None:
        self._socket = connect(
            address.replace("http", "ws", 1).rstrip("/"),
            subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item] # a NewType of str
            max_size=None,
        )
        self._parts: dict[str, dict[str, Any]] = {}
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self._send("ViewerCamera", **CAMERA)

    def __exit__(self, *_: object) -> None:
        self._socket.close()
        self._reader.join()

    @property
    def texts(self) -> str:
        """What stands on the page as text."""
        return "\n".join(part["_markdown"] for part in [*self._parts.values()] if "_markdown" in part)

    def charts(self) -> dict[str, list[NDArray[np.float64]]]:
        """What each chart draws: times and values."""
        return {part["title"]: part["data"] for part in [*self._parts.values()] if "data" in part}

    def value(self, label: str) -> Any:  # noqa: ANN401 - whatever it holds
        """What a control shows."""
        return self._parts[self._called(label)]["value"]

    def press(self, label: str) -> None:
        self._send("GuiUpdate", uuid=self._called(label), updates={"value": True})

    def choose(self, label: str, value: object) -> None:
        self._send("GuiUpdate", uuid=self._called(label), updates={"value": value})

    def command(self, label: str) -> None:
        self._send("CommandTrigger", uuid=self._called(label))

    def click(self, x: float, y: float) -> None:
        """Clicks, with Shift, what is below a place of the scene [m]."""
        ray = {"ray_origin": (x, y, 50.0), "ray_direction": (0.0, 0.0, -1.0)}
        self._send("ScenePointer", event_type="click", screen_pos=((0.5, 0.5),), modifier="shift", **ray)

    def _called(self, label: str) -> str:
        def known() -> list[str]:
            return [uuid for uuid, part in self._parts.copy().items() if part.get("label") == label]

        wait_until(lambda: bool(known()))
        return known()[0]

    def _send(self, kind: str, **fields: object) -> None:
        self._socket.send(msgspec.msgpack.encode({"type": f"{kind}Message", **fields}))

    def _read(self) -> None:
        try:
            for data in self._socket:
                assert isinstance(data, bytes)
                self._take(data)
        except ConnectionClosed:
            pass

    def _take(self, data: bytes) -> None:
        """A window of messages: sizes, msgpack in zstd, then arrays, each from a multiple of 8 bytes."""
        end = 16 + int.from_bytes(data[8:16], "little")
        content = msgspec.msgpack.decode(zstandard.ZstdDecompressor().decompress(data[16:end]))
        arrays, at = list[bytes](), end
        for length in content["binaryBufferLengths"]:
            at += -at % 8
            arrays.append(data[at : at + length])
            at += length
        for message in content["messages"]:
            fields: dict[str, Any] = message.get("props") or message.get("updates") or {}
            fields |= {"value": message["value"]} if "value" in message else {}  # of a new control
            if "uuid" in message:
                own = self._parts.setdefault(message["uuid"], {})
                own |= {name: _filled(value, arrays) for name, value in fields.items()}


def _filled(value: Any, arrays: list[bytes]) -> Any:  # noqa: ANN401 - as of msgpack
    if isinstance(value, list):
        return [_filled(part, arrays) for part in value]
    if isinstance(value, dict) and "__binary_index" in value:
        return np.frombuffer(arrays[value["__binary_index"]], value["dtype"])
    return value
