"""Short names for logs, unique and safe to print, whatever their files are called."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

_LONGEST = 40  # characters


def labels(paths: Sequence[Path]) -> list[str]:
    """Name logs by the ends of their paths, as many folders as it takes to tell them apart.

    Args:
        paths: Different files.

    Returns:
        One name a path, without control characters, at most 40 characters and a number.
    """
    parts = [(*path.absolute().parts[1:-1], path.stem) for path in paths]
    depths = [1] * len(paths)
    names = [_joined(part, 1) for part in parts]
    while True:
        counts = Counter(names)
        longer = [i for i, name in enumerate(names) if counts[name] > 1 and depths[i] < len(parts[i])]
        if not longer:
            return _numbered([_printable(name) for name in names])
        for i in longer:
            depths[i] += 1
            names[i] = _joined(parts[i], depths[i])


def _joined(parts: Sequence[str], depth: int) -> str:
    return "/".join(parts[-depth:])


def _printable(name: str) -> str:
    text = "".join(letter if letter.isprintable() else "?" for letter in name)
    return (
        text if len(text) <= _LONGEST else f"{text[: _LONGEST // 2 - 2]}...{text[-_LONGEST // 2 + 1 :]}"
    )


def _numbered(names: Sequence[str]) -> list[str]:
    counts = Counter(names)
    seen: Counter[str] = Counter()
    unique = []
    for name in names:
        seen[name] += 1
        unique.append(f"{name} ({seen[name]})" if counts[name] > 1 else name)
    return unique
