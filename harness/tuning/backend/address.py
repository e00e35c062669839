"""Where a cluster is, as a user writes it, and whether it is there.

It is tried in a process of its own, which can be given up: clients of Ray and Dask retry for minutes,
log that, and crash on what is not their own; none of this may happen to who has mistyped an address.
"""

import re
import socket
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from harness.errors import UsageError

HIGHEST_PORT = 65535
TCP_PATIENCE, PATIENCE = 3.0, 10.0  # [s] for a connection; for a cluster's answer
FORM = re.compile(r"(?:(?P<scheme>\w+)://)?(?P<host>[\w.-]+|\[[0-9A-Fa-f:.]+\]):(?P<port>\d{1,5})")


@dataclass(frozen=True, slots=True)
class Address:
    """A host and a port.

    Attributes:
        text: As the user wrote it.
        host: Empty where `text` is a name that the cluster's own client looks up.
        port: Likewise 0.
    """

    text: str
    host: str = ""
    port: int = 0


def parse_address(text: str, schemes: Sequence[str], names: Sequence[str] = ()) -> Address:
    """Returns the address in HOST:PORT or SCHEME://HOST:PORT.

    Args:
        text: What a user wrote.
        schemes: Those that are valid.
        names: What is valid instead of an address.

    Raises:
        UsageError: It is neither.
    """
    if text in names:
        return Address(text)
    found = FORM.fullmatch(text)
    if (
        found is None
        or not 0 < int(found["port"]) <= HIGHEST_PORT
        or found["scheme"] not in (None, *schemes)
    ):
        forms = ["HOST:PORT", *(f"{scheme}://HOST:PORT" for scheme in schemes), *names]
        raise UsageError(f"address '{text}' is not valid; give one of: {', '.join(forms)}")
    return Address(text, found["host"].strip("[]"), int(found["port"]))


def check_workers(address: Address, code: str, what: str, mend: str) -> None:
    """Makes sure that a cluster has workers.

    Args:
        address: Of the cluster.
        code: Python that connects to sys.argv[1] and prints how many it has.
        what: The kind of cluster, as messages name it.
        mend: What to do if it is not there.

    Raises:
        UsageError: It does not answer, or has no worker; within seconds.
    """
    try:
        if address.host:
            socket.create_connection((address.host, address.port), timeout=TCP_PATIENCE).close()
        answer = _answer(address, code)
    except OSError as error:
        message = f"no {what} answers at {address.text} ({error.strerror or error}); {mend}"
        raise UsageError(message) from error
    if not answer:
        raise UsageError(f"the {what} at {address.text} has no worker; start some")


def _answer(address: Address, code: str) -> float:
    try:
        tried = subprocess.run(
            [sys.executable, "-c", code, address.text],
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
        return float(tried.stdout.split()[-1])
    except subprocess.TimeoutExpired as error:
        last = _last_line((error.stderr or b"").decode(errors="replace"))
        message = f"a connection, but no answer within {PATIENCE:g} s" + (last and f": {last}")
        raise TimeoutError(message) from error
    except (IndexError, ValueError) as error:
        raise ConnectionError(_last_line(tried.stderr) or "it left without a word") from error


def _last_line(told: str) -> str:
    """What a process said last, without a log's preamble."""
    lines = told.strip().splitlines()
    return re.sub(r"^\[[^]]*\]\s*", "", lines[-1]) if lines else ""
