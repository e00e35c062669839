"""Fixed-step MuJoCo: the scene, its simulation, contacts and the base controller."""
