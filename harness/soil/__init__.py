"""Ground that gives way: soils, the forces of a wheel in them, and the ruts that it leaves."""
