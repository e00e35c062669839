"""Where a run can be watched while it goes on."""

import ipaddress
import re
from contextlib import suppress
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from harness.base.errors import UsageError
from harness.spec.value import Option, Value, checked

HERE, PORT, FOXGLOVE_PORT = "127.0.0.1", 8080, 8765
TOKEN = re.compile(r"[A-Za-z0-9_-]{8,}")  # what a cookie and an address can hold as it is


def address_of(text: str, flag: str = "--live", default: int = PORT) -> tuple[str, int]:
    """Returns host and port of an address.

    Args:
        text: [HOST][:PORT], e.g. 0.0.0.0:8080.
        flag: The option, for the message.
        default: The port where none is given.

    Raises:
        UsageError: It is no address.
    """
    host, colon, port = text.rpartition(":") if ":" in text or text.isdigit() else (text, "", "")
    if (colon and not port) or (port and not (port.isdigit() and 0 < int(port) < 65536)) or " " in text:
        form = f"give HOST, PORT or HOST:PORT, e.g. {HERE}:{default}"
        raise UsageError(f"{flag} '{text}' is not valid; {form}")
    return host.strip("[]") or HERE, int(port or default)


def is_local(host: str) -> bool:
    """Returns whether nobody but this machine can reach a host's address."""
    with suppress(ValueError):
        return ipaddress.ip_address(host).is_loopback
    return host == "localhost"


class LiveOptions(Value):
    """Where a run can be watched and steered; nowhere if there is no `live`."""

    live: Annotated[
        Annotated[str, AfterValidator(checked(address_of))] | None,
        Option("[HOST:]PORT", bare=f"{HERE}:{PORT}"),
    ] = Field(
        default=None,
        description="serve a page on which the run is watched and steered, at --rate 1 unless another "
        f"is given (extra [live]); bare: at {HERE}:{PORT}, or the next free port; default: none",
    )
    live_token: Annotated[str, Option("TOKEN")] = Field(
        default="",
        description="whoever opens the page must know it; needed where others can reach the host; "
        "default: none",
    )

    @property
    def rate(self) -> float | None:
        """Times real time at which a run goes unless it is told another; None for as fast as it can."""
        return None if self.live is None else 1.0

    def served(self) -> "LiveOptions":
        """Returns the same options of what is a page in any case: here, if nothing else is said."""
        return self if self.live is not None else LiveOptions(live=f"{HERE}:{PORT}")

    @model_validator(mode="after")
    def _is_guarded(self) -> Self:
        if self.live_token and not TOKEN.fullmatch(self.live_token):
            raise ValueError("--live-token: give 8 or more letters, digits, - or _")
        if self.live is None:
            if self.live_token:
                raise ValueError("--live-token is for --live; add it, or leave the token out")
        elif not is_local(address_of(self.live)[0]) and not self.live_token:
            raise ValueError(
                f"--live {self.live}: others can reach it; add --live-token TOKEN, or serve {HERE}"
            )
        return self


NOWHERE = LiveOptions.model_construct()
