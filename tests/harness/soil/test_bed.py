"""Rovers on soil: what they feel, what they leave behind, and what stays the same."""

from pathlib import Path

import gymnasium
import numpy as np
import pytest
from PIL import Image

import harness.gym  # noqa: F401 - registers its environments
from harness.base.errors import UsageError
from harness.episode.assembly import fleet
from harness.episode.episode import Episode, episodes_of
from harness.episode.together import Together
from harness.samples import TruthState
from harness.soil.soils import SOIL_CONTACT
from harness.spec.fleet import parse_rovers
from harness.spec.run import Run
from tests.harness.robots.test_measures import FOUR, car, motors, wheel

FORTH = ((0.5, 0.3, 0.0),)
FORTH_AND_BACK = ((0.5, 0.3, 0.0), (5.0, 0.0, 0.0), (5.5, -0.3, 0.0))


def driven(duration: float, **fields: object) -> Episode:
    words = {"terrain": "flat", "robot": "leo", "driver": "cmd_vel", "soil": "dry_sand"}
    given = {"commands": FORTH, **words}
    episode = Episode(Run.of(duration=duration, **(given | fields)))
    for _ in episode.batches():
        pass
    return episode


@pytest.fixture(scope="module")
def forth() -> Episode:
    return driven(4.0)


def test_the_soil_carries_the_rover_and_keeps_its_volume(forth: Episode) -> None:
    bed = forth.simulation.physics.bed
    assert bed is not None
    weight = float(forth.simulation.model.body_subtreemass[1]) * 9.81
    assert bed.lift.sum() == pytest.approx(weight, rel=0.25)
    assert (bed.felt[:, 0] > 0.002).all()
    heights = bed.surface
    assert heights.min() < -0.003
    assert heights.max() > 0.0005
    assert abs(heights.sum()) < 0.01 * np.abs(heights).sum()


def test_the_second_pass_is_shallower(forth: Episode) -> None:
    def deeper(episode: Episode) -> float:
        bed = episode.simulation.physics.bed
        assert bed is not None
        return float((bed.felt[:, 0] - bed.felt[:, 7]).mean())

    assert deeper(driven(8.0, commands=FORTH_AND_BACK)) < 0.7 * deeper(forth)


@pytest.mark.parametrize(("count", "keep"), [(1, True), (2, False)])
def test_ground_is_fresh_once_all_rovers_are_put_back_unless_ruts_are_kept(
    count: int, keep: bool
) -> None:
    words = {"terrain": "flat", "robot": "leo", "soil": "dry_sand", "driver": "straight"}
    run = Run.of(**words, keep_ruts=keep, duration=3.1)
    several = parse_rovers(("leo:a", "leo:b"), run.rover)
    episodes = episodes_of(run if count == 1 else fleet(run, several))
    bed, driven = episodes[0].simulation.physics.bed, Together(episodes).batches()
    assert bed is not None
    for _ in range(60):
        next(driven)
    assert bed.surface.min() < -0.005
    model = episodes[0].simulation.model
    driven_on = model.hfield_data[: bed.surface.size].reshape(bed.surface.shape)  # by MuJoCo
    ground = episodes[0].simulation.ground
    begin, end = (round((x - ground.bounds()[0]) / ground.cell) for x in (0.3, 0.5))
    between = bed.surface[:, begin:end]  # ahead of who is put back, behind who is not
    for back in range(1, count + 1):
        for episode in episodes[:back]:
            episode.reset()
        next(driven)
        for heights in (between, driven_on[:, begin:end]):
            assert bool(np.ptp(heights) > 1e-6) is (keep or back < count)  # ruts and heaps


def test_a_drive_of_a_fleet_that_was_put_back_on_fresh_ground_is_the_one_before() -> None:
    run = Run.of(terrain="rolling", soil="dry_sand", driver="spin", duration=4.1)
    episodes = episodes_of(fleet(run, parse_rovers(("leo:a", "jackal:b"), run.rover)))
    driven, ways = Together(episodes).batches(), list[list[object]]()
    bed = episodes[0].simulation.physics.bed
    assert bed is not None
    for _ in range(2):
        felt = [(next(driven), bed.felt.tolist())[1] for _ in range(40)]
        ways.append([*felt, *(episode.simulation.position for episode in episodes)])
        for episode in episodes:
            episode.reset()
    assert ways[0] == ways[1]


@pytest.mark.parametrize("robot", ["leo", "jackal"])
def test_firm_soil_drives_and_turns_as_rigid_ground_and_no_wheel_trembles(robot: str) -> None:
    def went(soil: str) -> Episode:
        commands = ((0.3, 0.0, 0.5), (1.8, 0.3, 0.0))
        return driven(3.5, soil=soil, robot=robot, commands=commands)

    firm, rigid = went("firm"), went("")
    for one, other in zip(firm.simulation.position[:2], rigid.simulation.position[:2], strict=True):
        assert one == pytest.approx(other, abs=0.03)
    assert firm.simulation.yaw == pytest.approx(rigid.simulation.yaw, rel=0.05)
    bed = firm.simulation.physics.bed
    assert bed is not None
    assert bed.felt[:, 4] == pytest.approx(bed.felt[:, 5], rel=0.02)  # rims and hubs


def test_an_underside_is_looked_for_only_near_the_ground_and_then_as_ever() -> None:
    simulation = driven(0.6).simulation
    body = simulation.model.geom("body_chassis").id
    affinity = simulation.model.geom_conaffinity
    assert not affinity[body] & SOIL_CONTACT
    simulation.put(0.0, 3.0, 0.0)
    simulation.pose[2] -= 0.12
    simulation.tick()
    assert simulation.contacts.strongest.keys() == {"scrape"}


def test_each_wheel_sinks_as_the_soil_does_that_a_map_has_nearest_to_it(tmp_path: Path) -> None:
    patches = np.random.default_rng(1).integers(0, 2, (401, 401)).astype(np.uint8)
    Image.fromarray(patches[::-1]).save(tmp_path / "map.png")  # north first
    file, sands = tmp_path / "soils.yaml", list[bool]()
    file.write_text("soils: [firm, dry_sand]\nmap: map.png\n")
    for start in ((1.03, -2.07, 2.0), (-3.04, 1.06, -1.0), (2.03, 2.08, 0.5)):
        simulation = driven(0.05, soil=str(file), start=start, commands=()).simulation
        bed = simulation.physics.bed
        assert bed is not None
        hubs = np.array([simulation.data.xpos[wheel.body][:2] for wheel in bed.wheels])
        column, row = np.round((hubs + 20.0) / 0.1).astype(int).T
        assert (bed.felt[:, 0] > 0.003).tolist() == patches[row, column].astype(bool).tolist()
        sands += patches[row, column].tolist()
    assert 3 < sum(sands) < 9
    for wrong, told in (
        ("soils: [firm]\nmap: map.png\n", "other numbers"),
        ("soils: [firm, mud]\nmap: map.png\n", "dry_sand"),
        ("soils: [firm, clay]\nmap: none.png\n", "cannot read"),
    ):
        file.write_text(wrong)
        with pytest.raises(UsageError, match=told):
            driven(0.6, soil=str(file))
    np.save(tmp_path / "map.npy", patches[1:])
    file.write_text("soils: [firm, clay]\nmap: map.npy\n")
    with pytest.raises(UsageError, match="401 x 401"):
        driven(0.6, soil=str(file))
    with pytest.raises(UsageError, match="only dunes"):
        driven(0.6, soil="terrain")
    assert driven(0.6, soil="terrain", terrain="dunes").simulation.physics.bed is not None


def test_a_rover_is_stuck_while_its_wheels_turn_and_it_stays_and_after_a_reset_as_at_first() -> None:
    for difficulty, is_stuck in ((1.0, True), (0.0, False)):
        run = Run.of(
            duration=5.0, terrain="slope", difficulty=difficulty, driver="straight", resets=(2.5,),
            soil="dry_sand", robot="leo",
        )  # fmt: skip
        ticks = (tick for batch in Episode(run).batches() for tick in batch.ticks)
        states = [s.soil for tick in ticks if (s := tick.of(TruthState)) and s.soil is not None]
        assert [state.stuck for state in states[:50]] == [state.stuck for state in states[50:]]
        assert states[-1].stuck is is_stuck
        assert all(0.002 < sinkage < 0.04 for sinkage in states[-1].sinkage)
        assert sum(states[-1].pull) > 0.0 or not is_stuck  # of the slope that it does not climb


def test_an_own_soil_that_is_too_stiff_or_wrong_is_one_line(tmp_path: Path) -> None:
    file = tmp_path / "concrete.yaml"
    file.write_text("k_phi: 1.0e+12\nn: 1.0\nfriction_angle_deg: 30\nshear_length: 0.01\n")
    with pytest.raises(UsageError, match=r"too stiff .* give a soil"):  # for the smallest step too
        driven(1.0, soil=str(file))
    file.write_text("k_phi: 1.0e+8\nn: 1.0\nfriction_angle_deg: 30\nshear_length: 0.01\n")
    with pytest.raises(UsageError, match=r"too stiff .* --timestep (\S+), or") as stiff:
        driven(1.0, soil=str(file))
    mend = float(str(stiff.value).partition("--timestep ")[2].partition(",")[0])
    assert driven(0.6, soil=str(file), timestep=mend).simulation.physics.bed is not None
    file.write_text("k_phi: -1\nn: 1.0\nfriction_angle_deg: 30\nshear_length: 0.01\n")
    with pytest.raises(UsageError, match="k_phi"):
        driven(1.0, soil=str(file))
    file.write_text("k_phi: 4.0e+7\nn: 1.0\nfriction_angle_deg: 45\nshear_length: 0.0002\nrebound: 1\n")
    with pytest.raises(
        UsageError, match=r"to and fro .* --timestep 0.00\d+, or a soil of a larger shear_l"
    ):
        driven(1.0, soil=str(file))
    with pytest.raises(UsageError, match="dry_sand"):
        driven(1.0, soil="mud")


@pytest.mark.parametrize(
    ("shape", "old", "new", "is_round"),
    [
        ("cylinder", "", "", True),
        ("ellipsoid", "", "", True),
        ("sphere", "", "", True),
        ("capsule", "", "", True),
        ("box", "", "", False),
        ("ellipsoid", '"0.1 0.1 0.03"', '"0.1 0.085 0.03"', False),
        ("capsule", 'euler="90 0 40"', 'zaxis="1 0 0"', False),  # lies across the axle
        (
            "cylinder",
            'axis="0 1 0"/><geom',
            'axis="0 1 0" pos="0.01 0 0"/><geom',
            False,
        ),  # runs off true
    ],
)
def test_wheels_are_round_and_as_wide_as_rover_yaml_says(
    shape: str, old: str, new: str, is_round: bool, tmp_path: Path
) -> None:
    wheels = "".join(wheel(name, place, shape=shape) for name, place in FOUR.items())
    wheels = wheels.replace(old, new)
    (tmp_path / "car.xml").write_text(car(wheels, motors(a=9, b=9, c=9, d=9)))
    (tmp_path / "rover.yaml").write_text("wheel_width: 0.09\n")
    if is_round:
        bed = driven(0.6, robot=str(tmp_path)).simulation.physics.bed
        assert bed is not None
        assert {each.width for each in bed.wheels} == {0.09}
    else:
        with pytest.raises(UsageError, match="'a' is not round"):
            driven(0.6, robot=str(tmp_path))


def test_episodes_of_an_environment_begin_on_fresh_ground_unless_ruts_are_kept() -> None:
    for keep in (False, True):
        env = gymnasium.make(
            "RoverHarness/PointNav-v0",
            terrain="flat",
            soil="dry_sand",
            random_start=False,
            keep_ruts=keep,
        )
        env.reset(seed=1)
        for _ in range(40):
            env.step(np.array([1.0, 0.0], np.float32))
        env.reset()
        bed = env.unwrapped.driven.simulation.physics.bed  # type: ignore[attr-defined]
        far = bed.surface[:, bed.surface.shape[1] // 2 + 20 :]  # ahead of where it stands
        assert bool(far.min() < -0.005) is keep


def test_an_environment_names_what_it_lacks_of_soil(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="'sinkage' is of soil; give soil in all worlds"):
        gymnasium.make("RoverHarness/PointNav-v0", terrain="flat", reward={"sinkage": -1.0})
    file = tmp_path / "concrete.yaml"
    file.write_text("k_phi: 1.0e+12\nn: 1.0\nfriction_angle_deg: 30\nshear_length: 0.01\n")
    env = gymnasium.make("RoverHarness/PointNav-v0", terrain="flat", soil=str(file))
    with pytest.raises(UsageError, match="too stiff"):  # instead of that no start was found
        env.reset(seed=1)


def test_dead_motors_do_not_drive_where_they_have_no_limits_either(tmp_path: Path) -> None:
    wheels = "".join(wheel(name, place) for name, place in FOUR.items())
    unlimited = motors(a=9, b=9, c=9, d=9).replace(' forcerange="-5 5"', "")
    (tmp_path / "car.xml").write_text(car(wheels, unlimited))
    (tmp_path / "rover.yaml").write_text("wheel_width: 0.06\n")
    for soil in ("", "firm"):
        dead = ("motor.left:weak=0", "motor.right:weak=0")
        ways = [
            driven(1.5, robot=str(tmp_path), soil=soil, faults=faults).simulation.position[0]
            for faults in ((), dead)
        ]
        assert ways[0] > 0.1
        assert abs(ways[1]) < 0.01
