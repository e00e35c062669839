from harness.robots import find_rover
from harness.samples import GroundTruth, Imu, Odometry, Pose
from harness.sensors.suite import SensorSuite
from tests.harness.conftest import MakeSimulation

ZERO = find_rover("rover_zero4wd")


def test_a_suite_reads_what_is_wanted_when_it_is_due_and_keeps_the_latest(
    make_simulation: MakeSimulation,
) -> None:
    simulation = make_simulation()
    suite = SensorSuite({"simulation": simulation}, ZERO, {Imu: 10}, wanted={Imu, Pose})
    read = []
    for tick in range(1, 13):
        simulation.tick()
        read.append([type(sample) for sample in suite.tick(tick)])
    assert read == [[], [Pose]] * 4 + [[], [Imu, Pose], [], [Pose]]
    assert {kind: sample.stamp_ns for kind, sample in suite.latest.items()} == {
        Pose: 120_000_000,
        Imu: 100_000_000,
    }
    suite.before_reset()
    suite.after_reset()
    assert suite.latest == {}


def test_a_suite_has_all_that_its_parts_suffice_for(make_simulation: MakeSimulation) -> None:
    simulation = make_simulation()
    suite = SensorSuite({"simulation": simulation}, ZERO, {})
    simulation.tick()
    kinds = {type(sample) for sample in suite.tick(100)}
    assert kinds >= {Imu, Pose, Odometry, GroundTruth}
    assert "LaserScan" not in {kind.__name__ for kind in kinds}  # there is no lidar among the parts
