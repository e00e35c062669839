"""The table of metrics, written out: its codes are words of the command line."""

from dataclasses import astuple

from rover_metrics.analysis.metric import METRICS, Kind, Metric
from rover_metrics.core.row import COLUMNS

SHAKING = "(m/s² + rad/s)/min"
NEAR = ("collision_threshold", "min_safe_clearance")
ROUGH = ("rough_terrain_threshold",)
# code, column, title, unit, kind, thresholds, rough_only, extended_column
EXPECTED = (
    ("TC", "Total Collisions", "Collisions", "scans/min", Kind.COUNTER, (), False, ""),
    ("CS", "Current Collision Status", "Time in collision", "% of rows", Kind.FLAG, (), False, ""),
    ("SM", "Smoothness Metric", "Smoothness sum", SHAKING, Kind.COUNTER, (), False, ""),
    ("OC", "Obstacle Clearance", "Obstacle clearance", "m", Kind.LEVEL, NEAR, False, ""),
    ("DT", "Distance Traveled", "Distance traveled", "m/min", Kind.COUNTER, (), False, ""),
    ("CV", "Current Velocity", "Current velocity", "m/s", Kind.LEVEL, (), False, ""),
    (
        *("VORT", "Current Velocity", "Velocity over rough terrain", "m/s"),
        *(Kind.LEVEL, (), True, "VORT [m/s]"),
    ),
    ("IM", "IMU Acceleration Magnitude", "IMU acceleration", "m/s²", Kind.LEVEL, ROUGH, False, ""),
    ("RT", "Is Rough Terrain", "Time on rough terrain", "% of rows", Kind.FLAG, (), False, ""),
    ("VR", "Vertical Roughness", "Vertical roughness", "m/s²", Kind.LEVEL, (), False, ""),
)


def test_codes_columns_titles_and_units_are_those_that_users_know() -> None:
    """RoboTerrain's nine codes in its order, and VORT, which it took for another name of CV."""
    assert tuple(astuple(metric) for metric in METRICS.values()) == EXPECTED
    assert tuple(METRICS) == tuple(code for code, *_ in EXPECTED)
    assert METRICS["SM"].label == "Smoothness sum [(m/s² + rad/s)/min]"


def test_a_metric_is_read_from_columns_that_every_log_has() -> None:
    for metric in METRICS.values():
        assert set(metric.columns) <= set(COLUMNS)
    assert METRICS["CV"].columns == ("Current Velocity",)
    assert METRICS["VORT"].columns == ("Current Velocity", "Is Rough Terrain")
    plain = Metric("X", "Notes", "x", "m")
    assert astuple(plain)[4:] == (Kind.LEVEL, (), False, "")
