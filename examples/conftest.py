"""Makes the fixture `start_trial`, and the nodes of this folder, known to its tests."""

import sys
from pathlib import Path

# pytest does so itself unless it imports by importlib, as this project's pyproject.toml says.
sys.path.insert(0, str(Path(__file__).parent))

pytest_plugins = ["harness.testing.plugin"]
