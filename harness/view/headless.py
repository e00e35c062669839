"""Keeps OpenGL out of commands that draw nothing; to be imported before MuJoCo.

MuJoCo loads the OpenGL that MUJOCO_GL names when it is imported, and fails where that is missing. A run
needs none: it must start there too. What draws (harness.view.drawing) gives its own process the choice.
"""

import os

OFF = "off"
REQUESTED = os.environ.get("MUJOCO_GL", "").strip().lower()  # what the user chose, or nothing
os.environ["MUJOCO_GL"] = OFF
