"""The page itself: a template with everything in it, and a policy that lets nothing out."""

import base64
import hashlib
from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined

from harness.report.content import content
from harness.report.recorder import RunRecorder
from harness.result import RunResult

STYLE, PLOTLY, SCRIPT = "report.css", "plotly-basic.min.js", "report.js"


def render(result: RunResult, recorder: RunRecorder) -> str:
    """The HTML of a run's report."""
    environment = Environment(
        loader=PackageLoader("harness.report", "assets"),
        autoescape=True,  # names come from users
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.policies["json.dumps_kwargs"] = {"allow_nan": False, "separators": (",", ":")}
    plotly, script = _asset(PLOTLY), _asset(SCRIPT)
    return environment.get_template("report.html.j2").render(
        content(result, recorder),
        style=_asset(STYLE),
        plotly=plotly,
        script=script,
        policy=_policy(plotly, script),
    )


def _policy(*scripts: str) -> str:
    """A content security policy: these scripts and no other, and nothing from the network."""
    hashes = " ".join(f"'sha256-{_digest(script)}'" for script in scripts)
    # Plotly sets styles of its own; pictures are data and, when a plot is saved, blobs.
    return f"default-src 'none'; script-src {hashes}; style-src 'unsafe-inline'; img-src data: blob:"


def _digest(script: str) -> str:
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")


def _asset(name: str) -> str:
    return files("harness.report").joinpath("assets", name).read_text(encoding="utf-8")
