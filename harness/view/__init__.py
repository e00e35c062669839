"""How a run looks: a lit stage, a camera, what is drawn onto the ground; live/: while it goes on."""
