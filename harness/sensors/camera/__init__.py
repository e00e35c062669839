"""Colour cameras: how their lenses project, how OpenGL draws what they see, and in which process."""
