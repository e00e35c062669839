"""What all pages share: a template filled with what it shows, and a policy that lets nothing out."""

import base64
import hashlib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

SHARED, ASSETS = "harness.page", "assets"
STYLE, PLOTLY, DRAWING = "pages.css", "plotly-basic.min.js", "plots.js"


def fill(name: str, content: Mapping[str, Any], package: str) -> str:
    """Returns the HTML of a page.

    Args:
        name: Of its assets: NAME.html.j2, which extends shell.html.j2, NAME.js and, if it is there,
            NAME.css, which is added to the common style.
        content: The template's variables; `figures` are Plotly's, by the name of their plot.
        package: Whose folder of assets has them.
    """
    plotly = _asset(SHARED, PLOTLY)
    script = _asset(SHARED, DRAWING) + _asset(package, f"{name}.js")
    style = _asset(SHARED, STYLE) + _asset(package, f"{name}.css", missing="")
    return (
        _environment(package)
        .get_template(f"{name}.html.j2")
        .render(content, style=style, plotly=plotly, script=script, policy=_policy(plotly, script))
    )


@cache
def _environment(package: str) -> Environment:
    """What compiles each template of a package once."""
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(folder, ASSETS) for folder in (package, SHARED)]),
        autoescape=True,  # names come from users
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.policies["json.dumps_kwargs"] = {"allow_nan": False, "separators": (",", ":")}
    return environment


def _policy(*scripts: str) -> str:
    """A content security policy: these scripts and no other, and nothing from the network."""
    digests = (base64.b64encode(hashlib.sha256(script.encode()).digest()) for script in scripts)
    hashes = " ".join(f"'sha256-{digest.decode()}'" for digest in digests)
    # Plotly sets styles of its own; pictures are data and, when a plot is saved, blobs.
    return f"default-src 'none'; script-src {hashes}; style-src 'unsafe-inline'; img-src data: blob:"


def _asset(package: str, name: str, missing: str | None = None) -> str:
    asset = files(package).joinpath(ASSETS, name)
    return missing if missing is not None and not asset.is_file() else asset.read_text(encoding="utf-8")
