"""Where a cluster is, as a user writes it."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from harness.errors import UsageError

HIGHEST_PORT = 65535
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
    """Reads HOST:PORT or SCHEME://HOST:PORT.

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
