"""What only the simulator knows: contacts, slip, path, tilt."""
