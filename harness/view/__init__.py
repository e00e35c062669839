"""How a run looks: a lit stage, a camera, what is drawn onto the ground; live/: as an open page."""
