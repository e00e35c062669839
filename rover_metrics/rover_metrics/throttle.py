"""When a repeated message is worth a line: at the 1st, 2nd, 4th, 8th ... time."""


def is_worth_a_line(before: int, now: int) -> bool:
    """Whether a count has passed a power of two on its way from `before` to `now`."""
    return now.bit_length() > before.bit_length()
