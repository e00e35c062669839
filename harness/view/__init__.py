"""How a run looks: a lit stage, where the camera stands, and what is drawn onto the ground."""
