"""Episodes of a sweep: planned, driven, kept."""
