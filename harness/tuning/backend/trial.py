"""Tries a cluster in a process of its own, which can be given up.

The clients of Ray and Dask retry for minutes, log that, and crash on what is not their own; none of
this may happen to a user who has mistyped an address.
"""

import re
import socket
import subprocess
import sys

from harness.errors import UsageError
from harness.tuning.backend.address import Address

TCP_PATIENCE, PATIENCE = 3.0, 10.0  # [s] for a connection; for a cluster's answer


def workers_at(address: Address, code: str, what: str, mend: str) -> float:
    """How many workers a cluster has.

    Args:
        address: Of the cluster.
        code: Python that connects to sys.argv[1] and prints the number.
        what: The kind of cluster, for people.
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
    return answer


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
