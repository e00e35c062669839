"""The gate of a page that others can reach: nothing of it is seen without the token."""

import contextlib
import http.client
import socket
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from harness.base.errors import UsageError
from harness.base.interrupt import StopRequest
from harness.episode.helm import Helm
from harness.spec.live import LiveOptions
from harness.spec.run import Run
from harness.view.live.gate import Gate
from harness.view.live.page import LivePage
from tests.support.waiting import PATIENCE

TOKEN = "a-secret-of-ours"  # noqa: S105 - of this test


class Page(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Length", "4")
        self.end_headers()
        self.wfile.write(b"page")
        if self.path == "/more":
            with contextlib.suppress(OSError):
                while True:
                    self.wfile.write(b"page" * 4096)

    def log_message(self, *_: object) -> None: ...


@pytest.fixture
def behind() -> Iterator[int]:
    with ThreadingHTTPServer(("127.0.0.1", 0), Page) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server.server_address[1]
        server.shutdown()
        thread.join()


def asked(port: int, path: str = "/", **headers: str) -> tuple[int, str, bytes]:
    """Status, cookie and body of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30.0)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    cookie, body = answer.getheader("Set-Cookie", ""), answer.read()
    connection.close()
    return answer.status, cookie, body


def test_who_knows_the_token_gets_a_cookie_and_with_it_the_page(behind: int) -> None:
    with Gate("127.0.0.1", 0, TOKEN, behind) as gate:
        assert asked(gate.port) == (403, "", b"")
        assert asked(gate.port, "/?token=a-guess-of-ours")[0] == 403
        assert asked(gate.port, Cookie="rover_live=a-guess-of-ours")[0] == 403
        assert asked(gate.port, Cookie="other=1; rover_live=")[0] == 403
        status, cookie, _ = asked(gate.port, f"/?token={TOKEN}")
        assert (status, "HttpOnly" in cookie, "SameSite=Strict" in cookie) == (303, True, True)
        assert asked(gate.port, cookie=f"other=1; {cookie.partition(';')[0]}") == (200, "", b"page")
        with pytest.raises(UsageError, match="cannot be served"):
            Gate("127.0.0.1", gate.port, TOKEN, behind)
    with pytest.raises(OSError, match="refused"):
        asked(gate.port)


def test_without_a_token_everybody_of_the_host_gets_the_page(behind: int) -> None:
    with Gate("127.0.0.1", 0, "", behind) as gate:
        assert asked(gate.port) == (200, "", b"page")
        pytest.importorskip("viser", reason="needs the extra [live]")
        with pytest.raises(UsageError, match=f"--live 127.0.0.1:{gate.port} cannot be served"):
            LivePage(Run.of(), Helm(None, StopRequest()), LiveOptions(live=f":{gate.port}"))


def test_who_does_not_read_what_is_sent_keeps_no_run_from_its_end(behind: int) -> None:
    gate = Gate("127.0.0.1", 0, "", behind)
    with socket.create_connection(("127.0.0.1", gate.port)) as browser:
        browser.sendall(b"GET /more HTTP/1.1\r\nHost: here\r\n\r\n")
        assert browser.recv(4)  # the page is on its way
        leaving = threading.Thread(target=gate.__exit__, daemon=True)
        leaving.start()
        leaving.join(PATIENCE)
        assert not leaving.is_alive()
