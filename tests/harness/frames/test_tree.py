import pytest

from harness.base.errors import UsageError
from harness.frames.tree import check_tree


@pytest.mark.parametrize(
    ("edges", "message"),
    [
        ("base-mast base-lidar mast-lidar", "'lidar' has two parents, base and mast; leave one out"),
        ("base-mast head-neck neck-head", "in a loop, neck -> head -> neck; let one hang on 'base'"),
        ("base-mast mast-base", "frame 'base' is the base and has no parent; leave out mast"),
        (
            "base-mast pole-lidar",
            "which does not exist; available: base, mast, lidar",
        ),
    ],
)
def test_what_is_no_tree_is_told_in_one_line(edges: str, message: str) -> None:
    pairs = [(parent, child) for parent, _, child in (edge.partition("-") for edge in edges.split())]
    with pytest.raises(UsageError) as told:
        check_tree("base", pairs, "rover.yaml")
    assert str(told.value).startswith("rover.yaml: frame")
    assert str(told.value).endswith(message)


def test_a_parent_may_stand_below_its_child() -> None:
    check_tree("base", [("mast", "lidar"), ("base", "mast")], "rover.yaml")
