import re
from pathlib import Path

import pytest

from tools.site import environments

PAGE = Path(__file__).parents[3] / "docs/gym.md"
CODE = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)


def test_every_option_and_every_part_is_told_of_with_its_default() -> None:
    text = environments.tables("RoverHarness/PointNav-v0") + environments.shared_options()
    for row in (
        "| `noise` | `''` | A preset of sensor errors; \"\" for exact sensors. |",
        "| `reward` `hazard` | `-10.0` | Seconds of contact with hazards. |",
        "| `curriculum` `window` | `20` |",
        "| `lidar` | `(640,)` | 0 .. 10 | ranges of /scan [m]",
        "| 0 | -1 .. 1 | speed; 1 is 0.75 m/s, as fast as the wheels of leo turn |",
        "| `edge` | truncated: half a metre from the edge of the map |",
    ):
        assert row in text
    assert "| 1 | -3.142 .. 3.142 |" in environments.tables("RoverHarness/RoboTerrain-v0")


@pytest.mark.parametrize("code", CODE)
def test_the_code_of_the_page_runs(code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(code, {})  # noqa: S102 - our own
