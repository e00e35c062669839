"""What goes wrong between the sensors and their listeners."""
