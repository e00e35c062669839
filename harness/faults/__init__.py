"""What goes wrong between the sensors and whoever listens."""
