"""The soak: hours of simulated driving with broken sensors, and listeners that are held up."""
