"""What a process has in shared memory: DDS' files outlive one that does not end DDS."""

import re
from pathlib import Path

# Of a run's own: lttng's is the user's, DDS's ports are the machine's, whoever opened them first.
SHARED_MEMORY = re.compile(r"/dev/shm/(?!lttng|\S*_port\d)\S+")  # noqa: S108 - to be looked at


def shared_memory(process: str | int) -> set[str]:
    """Files in /dev/shm that a process has mapped."""
    try:
        return set(SHARED_MEMORY.findall(Path(f"/proc/{process}/maps").read_text()))
    except OSError:  # gone meanwhile
        return set()
