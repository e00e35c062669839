"""What is to be found in a world: posts with markers, gates, tools, meshes, and where they stand."""
