"""Names of ROS: of rovers, which are in those of their topics, and of namespaces."""

import re

from harness.base.errors import UsageError
from rover_metrics.errors import shown

NAME = re.compile(r"(?!.*__)[A-Za-z][A-Za-z0-9_]{0,99}")
NAMESPACE, LONGEST_NAMESPACE = re.compile(r"(?!.*__)[A-Za-z_]\w*(/[A-Za-z_]\w*)*", re.ASCII), 100
NAMES = "give letters, digits and single _, a letter first, at most 100"


def check_name(name: str) -> None:
    """Checks the name of a rover, which may be empty; UsageError if it is none in ROS."""
    if name and not NAME.fullmatch(name):
        raise UsageError(f"'{shown(name)}' is no name in ROS; {NAMES}")


def namespace_of(text: str, flag: str = "--namespace") -> str:
    """Returns a namespace, or a node's name, of ROS without the slashes around it; "" for the root.

    Raises:
        UsageError: ROS has no such name; the flag is named.
    """
    names = text.strip("/")
    if names and not (NAMESPACE.fullmatch(names) and len(names) <= LONGEST_NAMESPACE):
        raise UsageError(
            f"{flag} '{shown(text)}' is no name in ROS; give letters, digits and single _, no digit "
            f"first, / between names, at most {LONGEST_NAMESPACE} characters"
        )
    return names
