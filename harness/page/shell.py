"""What all pages share: a template filled with what it shows, and a policy that lets nothing out."""

import base64
import hashlib
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

from harness.base.version import __version__
from harness.page.figure import Plot

SHARED, ASSETS = "harness.page", "assets"
STYLE, PLOTLY, DRAWING, PLAIN = "pages.css", "plotly-basic.min.js", "plots.js", "plain.js"


def fill(name: str, content: Mapping[str, Any], package: str, plots: Iterable[Plot] = ()) -> str:
    """Returns the HTML of a page.

    Args:
        name: Of its assets: NAME.html.j2, which extends shell.html.j2, and where they are there NAME.js,
            which is added to the common script, and NAME.css, which is added to the common style.
        content: The template's variables.
        package: Whose folder of assets has them.
        plots: Those that the script draws.
    """
    plotly = _asset(SHARED, PLOTLY)
    script = _asset(SHARED, DRAWING) + _asset(package, f"{name}.js", _asset(SHARED, PLAIN))
    style = _asset(SHARED, STYLE) + _asset(package, f"{name}.css", "")
    parts = {"style": style, "plotly": plotly, "script": script, "policy": _policy(plotly, script)}
    figures = {plot.name: plot.figure for plot in plots}
    template = _environment(package).get_template(f"{name}.html.j2")
    return template.render(content, **parts, version=__version__, figures=figures)


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
