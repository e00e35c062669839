import hashlib
from importlib.resources import files


def test_bundle_is_the_one_that_its_readme_names() -> None:
    assets = files("harness.page") / "assets"
    digest = hashlib.sha256((assets / "plotly-basic.min.js").read_bytes()).hexdigest()
    assert digest in (assets / "README.md").read_text()
    assert "</script" not in (assets / "plotly-basic.min.js").read_text(encoding="utf-8")
