"""The way in for others: who does not know the token sees nothing of the page behind it.

A browser tells the token once, in the address; the cookie that it gets for it opens everything else.
"""

import asyncio
import hmac
from contextlib import AbstractContextManager, suppress
from http.cookies import CookieError, SimpleCookie
from threading import Thread
from urllib.parse import parse_qs, urlsplit

from harness.base.errors import UsageError

COOKIE = "rover_live"
GOODBYE = 1.0  # [s] for a browser to take what was sent to it
PATIENCE = 10.0  # [s] for a browser to say what it wants
LONGEST_HEAD, PART = 65_536, 65_536  # [B] of a request; of what is passed on at once
NOBODY = b"HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
WELCOME = (
    "HTTP/1.1 303 See Other\r\nLocation: /\r\nContent-Length: 0\r\nConnection: close\r\n"
    f"Set-Cookie: {COOKIE}={{token}}; HttpOnly; SameSite=Strict; Path=/\r\n\r\n"
)


class Gate(AbstractContextManager["Gate"]):
    """Passes on, to a port of this machine, those who know the token.

    Args:
        host: Where others come.
        port: Of that host; 0 for any.
        token: What they must know; "" lets everybody in.
        behind: The port of this machine.

    Attributes:
        port: Where it listens.

    Raises:
        UsageError: Nobody can listen there.
    """

    def __init__(self, host: str, port: int, token: str, behind: int) -> None:
        self._token, self._behind = token, behind
        self._loop = asyncio.new_event_loop()
        opened = asyncio.start_server(self._admit, host, port, limit=LONGEST_HEAD)
        try:
            self._server = self._loop.run_until_complete(opened)
        except OSError as error:
            self._loop.close()
            raise UsageError(f"--live {host}:{port} cannot be served: {error.strerror}") from error
        self.port: int = self._server.sockets[0].getsockname()[1]
        self._thread = Thread(target=self._loop.run_forever, name="live gate", daemon=True)
        self._thread.start()

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._server.close()
        self._loop.run_until_complete(_cancel_others())
        self._loop.close()

    async def _admit(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            with suppress(OSError, TimeoutError, asyncio.IncompleteReadError, asyncio.LimitOverrunError):
                head = await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), PATIENCE)
                if self._knows(head):
                    await self._pass_on(head, reader, writer)
                else:
                    writer.write(self._answer(head))
                    await writer.drain()
        finally:
            await _close(writer)

    async def _pass_on(
        self, head: bytes, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        own_reader, own_writer = await asyncio.open_connection("127.0.0.1", self._behind)
        own_writer.write(head)
        try:
            await asyncio.gather(_pump(reader, own_writer), _pump(own_reader, writer))
        finally:
            await _close(own_writer)

    def _knows(self, head: bytes) -> bool:
        """Whether a request has the cookie, if there must be one."""
        lines = head.decode("latin-1").split("\r\n")[1:]
        sent = [line.partition(":")[2] for line in lines if line.lower().startswith("cookie:")]
        with suppress(CookieError):
            cookie = SimpleCookie("".join(sent)).get(COOKIE)
            return not self._token or self._is_right("" if cookie is None else cookie.value)
        return False

    def _answer(self, head: bytes) -> bytes:
        target = head.decode("latin-1").split(" ")[1:2]
        (token,) = parse_qs(urlsplit("".join(target)).query).get("token", [""])[:1]
        return WELCOME.format(token=self._token).encode() if self._is_right(token) else NOBODY

    def _is_right(self, token: str) -> bool:
        return hmac.compare_digest(token.encode(), self._token.encode())


async def _cancel_others() -> None:
    tasks = asyncio.all_tasks() - {asyncio.current_task()}
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


async def _close(writer: asyncio.StreamWriter) -> None:
    """Closes a connection; what its other end does not take in time is dropped."""
    writer.close()
    try:
        await asyncio.wait_for(writer.wait_closed(), GOODBYE)
    except (OSError, TimeoutError):
        writer.transport.abort()


async def _pump(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Passes on until one side ends; what is slow is waited for."""
    while data := await reader.read(PART):
        writer.write(data)
        await writer.drain()
    writer.close()
