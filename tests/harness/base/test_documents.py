"""Files that anybody may have written: what they hold, or one line within a bounded time."""

from pathlib import Path

import pytest

from harness.base import documents
from harness.base.documents import parse_json, read_json, read_mapping
from harness.base.errors import UsageError
from harness.robots.reading import read_rover
from harness.scenario.reading import read_scenario

BOMB = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join([f'*{before}'] * 9)}]\n"
    for before, name in zip("abcdefghijk", "bcdefghijkl", strict=True)
)
HOSTILE = {
    "not valid": b"a: [",
    "no text in UTF-8": "a: 1".encode("utf-16"),
    "more than 100 digits": b"a: " + b"9" * 5001,
    "a number of more than 100 digits": b"a: 0x" + b"f" * 5001,
    "more than 64 deep": b"a: " + b"[\n " * 5000 + b"]" * 5000,
    "comes to more than 100,000 values; give fewer, or no alias": BOMB.encode(),
    "must be text; put it in quotes": b"? [a, b]\n: c\n",
    "key 3 must be text": b"a: [{3: b}]",
    "1_000.5 is no number; leave _ out": b"a: [b, 1_000.5]",
    "1_0 is no number": b"a: 1_0",
    "*a stands for nothing before it": b"a: &a [*a]",
    "larger than 1,048,576 bytes": b"#" * (2**20 + 1),
}


@pytest.mark.parametrize("mend", HOSTILE)
def test_a_yaml_file_beyond_a_bound_is_one_line_with_its_name(mend: str, tmp_path: Path) -> None:
    path = tmp_path / "rover.yaml"
    path.write_bytes(HOSTILE[mend])
    for read in (read_mapping, read_scenario, lambda file: read_rover(file.parent)):
        with pytest.raises(UsageError) as refused:
            read(path)
        assert mend in str(refused.value)
        assert str(path) in str(refused.value)
        assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("content", "mend"),
    [
        (b"[", "not valid JSON"),
        (b"\xff", "no text in UTF-8"),
        (b'{"a": ' + b"9" * 5001 + b"}", "more than 100 digits"),
        (b"[" * 5000 + b"]" * 5000, "more than 64 deep"),
        (b"[" * 100_000, "more than 64 deep"),
        (b"[" * 66 + b"]" * 66, "more than 64 deep"),
        (b" " * 65, "larger than 64 bytes"),
    ],
)
def test_a_json_file_beyond_a_bound_is_one_line_with_its_name(
    content: bytes, mend: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(content)
    with pytest.raises(UsageError, match=mend) as refused:
        read_json(path, 64 if content.isspace() else documents.LARGEST_JSON)
    assert str(path) in str(refused.value)
    with pytest.raises(UsageError, match="Is a directory"):
        read_json(tmp_path)


def test_what_is_within_the_bounds_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text(
        f"a: &a {{b: {'9' * 100}}}\nc: [*a, *a]\nd: {'[' * 62}{']' * 62}\n<<: *a\ne: [a_1, '1_0', _1]\n"
    )
    read = read_mapping(path)
    assert read["c"] == [read["a"]] * 2 == [{"b": int("9" * 100)}] * 2
    assert read["b"] == read["a"]["b"]
    assert read["e"] == ["a_1", "1_0", "_1"]
    assert parse_json("[" * 64 + "]" * 64, "here")
