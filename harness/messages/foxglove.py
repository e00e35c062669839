"""A run's topics over the WebSocket that Foxglove opens, by its SDK (extra [foxglove]).

Each message goes out as it is recorded: the same bytes, schema and time. The run waits for no client: of
one that is slower, the SDK drops what is oldest beyond its queue.
"""

import socket
import time
from contextlib import AbstractContextManager

import foxglove
from foxglove.websocket import Capability, ChannelView, Client, ServerListener, WebSocketServer

from harness.base.errors import UsageError
from harness.messages.cdr import without_padding
from harness.messages.outlets import CLOCK
from harness.messages.recorder import full_definition
from harness.messages.sink import Endpoint, Intake
from harness.spec.ros import foxglove_address

GOODBYE = 0.5  # [s] for the SDK to send what it has: it forgets that as it stops
BACKLOG = 32_768  # messages that a client may be behind: a minute of the usual topics at --rate 1


class Foxglove(ServerListener, AbstractContextManager["Foxglove"]):
    """Serves topics on a host and port from the first message on, until it is left; a Sink.

    Raises:
        UsageError: It cannot be served there.
    """

    def __init__(self, where: str) -> None:
        self._where = host, port = foxglove_address(where)
        try:
            socket.create_server((host, port)).close()
        except OSError as error:
            raise self._refused(str(error.strerror)) from error
        self._context = foxglove.Context()
        self._server: WebSocketServer | None = None
        self._latched: dict[int, tuple[foxglove.Channel, int, bytes]] = {}  # the last message of each
        self._is_heard = False

    def __exit__(self, *_: object) -> None:
        if self._server is not None:
            time.sleep(GOODBYE * self._is_heard)
            self._server.stop()

    def _refused(self, reason: str) -> UsageError:
        host, port = self._where
        mend = f"name another port, e.g. --foxglove {host}:{port + 1}"
        return UsageError(f"--foxglove {host}:{port} cannot be served: {reason}; {mend}")

    def _serve(self) -> WebSocketServer:
        """Serves the topics opened so far: a client may ask for one before the server has it."""
        host, port = self._where
        try:
            server = foxglove.start_server(
                name="rover",
                host=host,
                port=port,
                capabilities=[Capability.Time],
                server_listener=self,
                context=self._context,
                message_backlog_size=BACKLOG,
            )
        except RuntimeError as error:  # somebody has taken the port since it was tried
            raise self._refused(str(error)) from error
        shown = f"[{host}]" if ":" in host else host
        print(f"foxglove: ws://{shown}:{port}, or {server.app_url()}", flush=True)
        return server

    def open(self, endpoint: Endpoint) -> Intake:
        """Returns where the messages of a topic go."""
        kind = endpoint.message_type
        is_clock = kind == CLOCK.message_type  # under whatever name
        schema = foxglove.Schema(name=kind, encoding="ros2msg", data=full_definition(kind).encode())
        channel = foxglove.Channel(
            endpoint.topic, schema=schema, message_encoding="cdr", context=self._context
        )

        def take(time_ns: int, data: bytes) -> None:
            if self._server is None:
                self._server = self._serve()
            sent = without_padding(data, kind) if endpoint.is_foreign else data
            if endpoint.latched:
                self._latched[channel.id()] = channel, time_ns, sent
            channel.log(sent, log_time=time_ns)
            if is_clock:
                self._server.broadcast_time(time_ns)

        # The time goes to all clients, also to those that do not subscribe to /clock.
        return Intake(take, (lambda: True) if is_clock else channel.has_sinks)

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Sends a late subscriber the last message of a latched topic, on a thread of the server."""
        self._is_heard = True
        if channel.id in self._latched:
            sender, time_ns, data = self._latched[channel.id]
            sender.log(data, log_time=time_ns, sink_id=client.id)
