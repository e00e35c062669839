"""The version of this project, which pyproject.toml reads and tests hold other files to."""

__version__ = "0.1.0"
