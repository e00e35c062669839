"""A URDF -> a folder with a model and a rover.yaml, its guesses marked as guesses."""
