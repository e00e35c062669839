"""Which documents are pages of the site, and their order."""

from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
ELSEWHERE = {  # beside docs/*.md
    "index.md": "README.md",
    "models.md": "models/README.md",
    "benchmarks.md": "benchmarks/README.md",
    "nav2.md": "examples/nav2/README.md",
    "contributing.md": "CONTRIBUTING.md",
    "changelog.md": "CHANGELOG.md",
    "security.md": "SECURITY.md",
    "conduct.md": "CODE_OF_CONDUCT.md",
}
# By section; what docs/ has besides goes into GUIDES, so that a new document needs no line here.
GUIDES = "Guides"
NOTEBOOKS = ("first_run", "compare_rovers", "learn")  # of examples/
SECTIONS: dict[str, tuple[str, ...]] = {
    "Start": ("index.md", "tour.md", "first_plot.md", "comparison.md"),
    "Tutorials": (
        *("ci.md", "robots.md", "your_terrain.md", "train.md", "tuning.md", "compare.md", "bags.md"),
        "nav2.md",
    ),
    GUIDES: (
        *(
            "testing.md",
            "scenarios.md",
            "course.md",
            "missions.md",
            "fleets.md",
            "sensors.md",
            "worlds.md",
            "extend.md",
            "social.md",
        ),
        *("gym.md", "real_rovers.md", "driving.md", "looking.md", "ros.md"),
    ),
    "Notebooks": tuple(f"notebooks/{name}.md" for name in NOTEBOOKS),
    "Reference": (
        *("reference/commands.md", "topics.md", "frames.md", "log.md", "metrics.md", "parameters.md"),
        *("terrains.md", "reference/scenario_file.md", "models.md", "api.md", "reference/python.md"),
        "limits.md",
    ),
    "Explanation": ("design.md", "physics.md", "performance.md", "guarantees.md", "benchmarks.md"),
    "Project": ("contributing.md", "changelog.md", "security.md", "conduct.md"),
}


def sources() -> dict[str, Path]:
    """Returns the document of each page that is one, below the repository's root."""
    pages = {page: Path(source) for page, source in ELSEWHERE.items()}
    pages |= {f"notebooks/{name}.md": Path(f"examples/{name}.ipynb") for name in NOTEBOOKS}
    return pages | {path.name: path.relative_to(ROOT) for path in sorted((ROOT / "docs").glob("*.md"))}


def navigation(pages: dict[str, Path]) -> list[dict[str, Any]]:
    """Returns the site's navigation, as mkdocs takes it."""
    listed = {page for section in SECTIONS.values() for page in section}
    more = tuple(page for page in pages if page not in listed)
    return [
        {section: list((*named, *more) if section == GUIDES else named)}
        for section, named in SECTIONS.items()
    ]
