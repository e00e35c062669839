"""Installs rover_metrics as an ament_python package (colcon build)."""

import re
from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = "rover_metrics"
VERSION = re.findall("<version>(.*)</version>", Path("package.xml").read_text(encoding="utf-8"))

setup(
    name=PACKAGE,
    version=VERSION[0],
    packages=find_packages(include=[PACKAGE, f"{PACKAGE}.*"]),
    package_data={PACKAGE: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        (f"share/{PACKAGE}/config", sorted(map(str, Path("config").glob("*.yaml")))),
        (f"share/{PACKAGE}/launch", sorted(map(str, Path("launch").glob("*.py")))),
    ],
    install_requires=[
        "argcomplete",
        "matplotlib>=3.5",
        "mcap",
        "numpy",
        "pandas",
        "rich",
        "rosbags",
        "ruamel.yaml",
        "scipy",
        "zstandard",
    ],
    zip_safe=True,
    maintainer="The rover-harness authors",
    maintainer_email="maintainers@example.com",
    description="Traversal metrics of an off-road rover, one CSV row a second",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "metrics_node = rover_metrics.__main__:main",
            "analyze = rover_metrics.analyze:main",
            "social = rover_metrics.social:main",
            "replay = rover_metrics.replay:main",
        ]
    },
)
