"""An environment on a page: it is served while there are episodes, and they are the same as without."""

import re
import time
import urllib.request

import numpy as np
import pytest

from harness.gym.point_nav import PointNavEnv

pytest.importorskip("viser", reason="needs viser: pip install -e '.[live]'")


def test_an_environment_on_a_page_is_served_waits_for_real_time_and_sees_the_same(
    capsys: pytest.CaptureFixture[str],
) -> None:
    env, plain = PointNavEnv(render_mode="live"), PointNavEnv()
    seen, _ = env.reset(seed=0)
    began = time.monotonic()
    expected, _ = plain.reset(seed=0)
    found = re.search(r"live: (http://127\.0\.0\.1:\d+)", capsys.readouterr().out)
    assert found is not None
    with urllib.request.urlopen(found[1]) as page:  # noqa: S310 - our own
        assert page.status == 200
    for _ in range(5):
        seen, *_ = env.step(np.array([0.5, 0.1], np.float32))
        expected, *_ = plain.step(np.array([0.5, 0.1], np.float32))
    assert all(np.array_equal(seen[name], expected[name]) for name in expected)
    assert time.monotonic() - began >= 0.2  # four of five periods of 0.05 s, at least
    env.close()
    env.close()
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(found[1])  # noqa: S310
