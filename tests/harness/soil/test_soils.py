"""Soils of one's own: a file that is none is one line with its name and what is valid."""

from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.soil.soils import SOILS, find_soil

GOOD = {"k_phi": "1.0e6", "n": "1", "friction_angle_deg": "30", "shear_length": "0.01"}


@pytest.mark.parametrize("width", [0.05, 0.3])
def test_cohesion_bears_by_the_width_of_a_wheel(width: float) -> None:
    """Bekker's pressure is (k_c / b + k_phi) z^n."""
    soil = SOILS["lll_sand"]
    alike = soil.model_copy(update={"k_c": 0.0, "k_phi": soil.k_phi + soil.k_c / width})
    assert soil.numbers(width, 9.81) == pytest.approx(alike.numbers(width, 9.81))


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"k_phi": "1e6 Pa"}, "k_phi '1e6 Pa' is not valid; give a number"),
        ({"k_phi": "1_000_000"}, "1_000_000 is no number"),
        ({"k_phi": ".nan"}, "k_phi nan is not valid"),
        ({"k_phi": "-1"}, "k_phi -1 is not valid; give 0 to 1e+12"),
        ({"shear_length": "1.0e300"}, "is not valid; give 0 to 1, the lower end excluded"),
        ({"moisture": "3"}, "key 'moisture' does not exist"),
    ],
)
def test_a_file_of_no_soil_is_told_in_a_line(changes: dict[str, str], told: str, tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.write_text("".join(f"{key}: {value}\n" for key, value in (GOOD | changes).items()))
    with pytest.raises(UsageError) as refused:
        find_soil(str(file))
    assert told in str(refused.value)
    assert str(file) in str(refused.value)
    assert "\n" not in str(refused.value)
