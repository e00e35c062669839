"""The reference's metrics, thresholds, columns and rows; pure."""
