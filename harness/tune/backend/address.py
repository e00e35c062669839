"""Where a cluster is, as a user writes it, and whether it is there.

It is tried in a process of its own, which can be given up: clients of Ray and Dask retry for minutes,
log that, and crash on what is not their own; none of this may happen to who has mistyped an address.
"""

import re
import socket
import subprocess
import sys
from dataclasses import dataclass

from harness.base.errors import UsageError

HIGHEST_PORT = 65535
TCP_PATIENCE, PATIENCE = 3.0, 10.0  # [s] for a connection; for a cluster's answer
FORM = re.compile(r"(?:(?P<scheme>\w+)://)?(?P<host>[\w.-]+|\[[0-9A-Fa-f:.]+\]):(?P<port>\d{1,5})")


@dataclass(frozen=True, kw_only=True)
class ClusterKind:
    """How clusters of a kind are addressed and found.

    Attributes:
        name: As messages name it.
        schemes: Of its addresses.
        names: What is valid instead of an address; the cluster's own client looks it up.
        trial: Python that connects to sys.argv[1] and prints the number of workers.
        mend: What to do if there is none.
    """

    name: str
    schemes: tuple[str, ...]
    names: tuple[str, ...] = ()
    trial: str
    mend: str

    def place(self, address: str) -> tuple[str, int] | None:
        """Returns host and port in HOST:PORT or SCHEME://HOST:PORT, None for a name.

        Raises:
            UsageError: It is neither.
        """
        if address in self.names:
            return None
        found = FORM.fullmatch(address)
        if (
            found is None
            or not 0 < int(found["port"]) <= HIGHEST_PORT
            or found["scheme"] not in (None, *self.schemes)
        ):
            forms = ["HOST:PORT", *(f"{scheme}://HOST:PORT" for scheme in self.schemes), *self.names]
            raise UsageError(f"address '{address}' is not valid; give one of: {', '.join(forms)}")
        return found["host"].strip("[]"), int(found["port"])

    def check(self, address: str) -> None:
        """Makes sure that a cluster has workers.

        Raises:
            UsageError: It does not answer, or has no worker; within seconds.
        """
        place = self.place(address)
        try:
            if place is not None:
                socket.create_connection(place, timeout=TCP_PATIENCE).close()
            workers = _answer(self.trial, address)
        except OSError as error:
            reason = error.strerror or error
            raise UsageError(f"no {self.name} answers at {address} ({reason}); {self.mend}") from error
        if not workers:
            raise UsageError(f"the {self.name} at {address} has no worker; start some")


def _answer(code: str, address: str) -> float:
    words = [sys.executable, "-c", code, address]
    try:
        tried = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, check=False)
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
