"""What Gazebo classic adds to a world that it saves: a <state> with the poses of that moment."""

from xml.etree.ElementTree import Element

import numpy as np

from harness.base.sdf.poses import read_pose

NEAR = 1e-3  # [m]: a model that has settled as little is where it was


def restore(world: Element) -> list[str]:
    """Puts models where they were when the world was saved, as Gazebo classic does; returns their names.

    Later Gazebos neither write nor read a <state>.
    """
    models, moved = {model.get("name"): model for model in world.findall("model")}, []
    for state in world.findall("state/model"):
        name, pose = state.get("name", ""), state.find("pose")
        model = models.get(name)
        if model is None or pose is None:
            continue
        if not np.allclose(read_pose(state, name)[0], read_pose(model, name)[0], atol=NEAR):
            for old in model.findall("pose"):
                model.remove(old)
            model.append(pose)
            moved.append(name)
    return moved
