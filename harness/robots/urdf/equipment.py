"""What a URDF lacks of a simulated rover: motors, tyres, sites, solver; each guess is reported.

Contact settings are those that were measured for rovers of 5 to 15 kg (models/README.md): wheels as
ellipsoids climb kerbs that cylinders do not, and yielding contacts keep a skid-steer's turns calm.
"""

import re
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from harness.base.sim_time import DEFAULT_TIMESTEP_NS, NANOSECONDS
from harness.robots.model import STIFFEST, UNSEEN_GROUP
from harness.robots.urdf.joints import Joints

GRAVITY = 9.81
TOP_SPEED = 1.0  # [m/s], of wheels whose joints state no limit
FASTEST = 10.0  # [m/s] at a rim: a joint's limit beyond it, as 100 or 1000 rad/s, stands for none
GRIP = 1.0  # friction of wheels; 1 is what RoboTerrain's rovers have
SCRAPING = 0.3  # friction of all else
TYRE = {"priority": 1, "condim": 3, "solref": [0.02, 1.0], "solimp": [0.15, 0.95, 0.002, 0.5, 2.0]}
DEFAULT_COLOR, RUBBER = (0.5, 0.5, 0.5, 1.0), (0.07, 0.07, 0.075, 1.0)
STIFFNESS = 0.05  # of the top speed: so far behind it, a motor gives all its torque
ROTOR = 0.2  # of a wheel's share of the mass, as a point at its rim: rotor and gear
TIMESTEP = DEFAULT_TIMESTEP_NS / NANOSECONDS  # [s]
STEERING_SPEED = 2.0  # [rad/s]
STEERING_LIMIT = 0.5  # [rad]
LIDAR = re.compile(r"lidar|laser|scan|velodyne|ouster|hokuyo|sick|livox", re.IGNORECASE)
# of Gazebo's plugins: left_joint, rightFrontJoint, ...
SIDE_JOINT = re.compile(r"(left|right)_?(front|middle|rear|back)?_?joint", re.IGNORECASE)
IMU = re.compile(r"(^|_)imu(_|$)", re.IGNORECASE)


def _turn(spec: mujoco.MjSpec, backwards: tuple[str, ...]) -> None:
    """Lets joints turn the other way, and those that mimic them or that they mimic as before."""
    for joint in map(spec.joint, backwards):
        joint.axis, joint.range = -np.array(joint.axis), -np.array(joint.range)[::-1]
        joint.springref = -joint.springref
    for tie in spec.equalities:
        if tie.type == mujoco.mjtEq.mjEQ_JOINT:
            of_mimic = -1.0 if tie.name1 in backwards else 1.0
            of_mimicked = [1.0, -1.0, 1.0, -1.0, 1.0] if tie.name2 in backwards else [1.0] * 5
            tie.data[:5] *= np.multiply(of_mimic, of_mimicked)  # of the powers of what it mimics


class Equipment:
    """What a model is given that its URDF does not say.

    Attributes:
        guesses: What nobody states, by the key of rover.yaml or the part of the model it is of.
        lidar, imu: The links that carry them; "" if there is none.
        driven: The wheels with motors.
        steering_rate: How fast the mean steered wheel turns [rad/s].
        beliefs: What the URDF says of its controller, by the keys of rover.yaml.
    """

    def __init__(self, spec: mujoco.MjSpec, robot: ET.Element, joints: Joints, mass: float) -> None:
        self._spec, self._joints, self._mass = spec, joints, mass
        self._limits = {joint.get("name", ""): joint.find("limit") for joint in robot.findall("joint")}
        self.lidar = self.imu = ""
        self.steering_rate, self.beliefs = STEERING_SPEED, _beliefs(robot)
        self.guesses: dict[str, str] = {}
        stated = _stated(robot)
        driven = tuple(name for name in joints.wheels if name in stated)
        self.driven = driven or joints.wheels
        if stated and not driven:
            names = ", ".join(sorted(stated))
            self.guesses["model: motors"] = (
                f"on all wheels, as none of those with one is a wheel: {names}"
            )

    def fit_tyres(self) -> None:
        """Gives wheels and all else the friction and the contacts of such parts."""
        spec = self._spec
        wheels = {spec.joint(name).parent.name for name in self._joints.wheels}
        for geom in spec.geoms:
            if geom.contype == 0:
                if geom.parent.name in wheels and np.allclose(geom.rgba, DEFAULT_COLOR):
                    geom.rgba = RUBBER
                continue
            if geom.parent.name not in wheels:
                geom.priority, geom.friction = 1, [SCRAPING, 0.005, 0.0001]
                continue
            for key, value in TYRE.items():
                setattr(geom, key, value)
            geom.friction = [GRIP, 0.005, 0.0001]
            if geom.type == mujoco.mjtGeom.mjGEOM_CYLINDER:
                radius, half_width, _ = geom.size
                geom.type, geom.size = mujoco.mjtGeom.mjGEOM_ELLIPSOID, [radius, radius, half_width]
        self.guesses["model: tyres"] = (
            f"friction {GRIP:g} of wheels, {SCRAPING:g} of all else; cylinders as ellipsoids"
        )

    def fit_wheel_motors(self) -> None:
        """Adds speed servos that turn the driven wheels."""
        driven, guesses = self.driven, self.guesses
        for name in self._joints.wheels:
            radius = self._joints.radius[name]
            self._weigh_rotor(name, radius)
            if name not in driven:
                continue
            effort, speed = self._limit(name, "effort"), self._limit(name, "velocity")
            is_meant = 0.0 < speed * radius <= FASTEST
            joint, fastest = self._spec.joint(name), speed if is_meant else round(TOP_SPEED / radius, 2)
            if not effort:
                lost = joint.damping[0] * fastest + joint.frictionloss
                effort = round(GRIP * self._mass * GRAVITY * radius / len(driven) + lost, 3)
                guesses["model: wheel torque"] = f"{effort:g} N m each, which spins the wheels"
            if not is_meant:
                no_limit = f"; {speed:g} rad/s, {speed * radius:.3g} m/s, stands for none" * bool(speed)
                guesses["model: wheel speed"] = f"{fastest:g} rad/s, {TOP_SPEED:g} m/s{no_limit}"
            motor = self._motor(name, effort, [-fastest, fastest])
            gain = effort / (STIFFNESS * fastest)
            motor.set_to_velocity(kv=gain)
            if (heavy := gain * TIMESTEP / STIFFEST) > joint.armature:
                joint.armature = heavy  # a servo so stiff would flip between its limits
                guesses["model: rotors"] = f"{heavy:.2g} kg m^2 at a wheel, as its stiff motor needs"

    def fit_steering(self) -> None:
        """Adds position servos that turn the wheels of a car that stands, or hold them straight."""
        joints = self._joints
        for name in joints.steering + joints.held:
            radius = max(joints.radius.values())
            self._weigh_rotor(name, radius)
            effort = GRIP * self._mass * GRAVITY * radius
            limits = np.array(self._spec.joint(name).range).tolist()
            if not -np.pi / 2 < limits[0] < 0 < limits[1] < np.pi / 2:
                limits = [-STEERING_LIMIT, STEERING_LIMIT]
                self.guesses["model: steering limit"] = f"{STEERING_LIMIT:g} rad"
            stiffness = effort / 0.1  # all of it 0.1 rad off
            self._motor(name, effort, limits).set_to_position(kp=stiffness, kv=0.1 * stiffness)
        rates = [self._limit(name, "velocity") for name in joints.steering]
        if rates and all(rates):
            self.steering_rate = min(rates)
        elif joints.steering:
            self.guesses["drive"] = f"steering_rate {STEERING_SPEED:g} rad/s"

    def _weigh_rotor(self, name: str, radius: float) -> None:
        joint, share = self._spec.joint(name), self._mass / len(self._joints.wheels)
        joint.armature = ROTOR * share * radius**2
        joint.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE  # its motor has that limit

    def _motor(self, name: str, effort: float, limits: list[float]) -> mujoco.MjsActuator:
        motor = self._spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.forcelimited = motor.ctrllimited = True
        motor.forcerange, motor.ctrlrange = [-effort, effort], limits
        return motor

    def _limit(self, name: str, key: str) -> float:
        """A limit of a joint; 0 without one, or with one that means none."""
        limit = self._limits.get(name)
        try:
            value = float(limit.get(key, "0")) if limit is not None else 0.0
        except ValueError:
            return 0.0
        return value if 0 < value < 1e4 else 0.0


def equip(spec: mujoco.MjSpec, robot: ET.Element, joints: Joints, mass: float) -> Equipment:
    """Adds to a model what its URDF does not say.

    Args:
        spec: With a free root; is changed.
        robot: The URDF.
        joints: Its wheels and steering.
        mass: Of the whole rover [kg].
    """
    option = spec.option
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone, option.timestep = mujoco.mjtCone.mjCONE_ELLIPTIC, TIMESTEP
    option.gravity = [0.0, 0.0, -GRAVITY]
    _turn(spec, joints.backwards)
    for joint in map(spec.joint, joints.wheels):
        if np.ptp(joint.range) > 0.0:  # it rolls on
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
    equipment = Equipment(spec, robot, joints, mass)
    equipment.fit_tyres()
    equipment.fit_wheel_motors()
    equipment.fit_steering()
    for name, pattern in (("lidar", LIDAR), ("imu", IMU)):
        # of several links that are called so the last, which others carry; of SDF the sensor's
        links = [body.name for body in spec.bodies if pattern.search(body.name)]
        stated = [body.name for body in spec.bodies if body.name == robot.get(name)]
        if link := next(reversed(stated or links), ""):
            setattr(equipment, name, link)
            spec.body(link).add_site(name=name, group=UNSEEN_GROUP)
        else:
            place = "5 cm over the highest point" if name == "lidar" else "in the root link's origin"
            equipment.guesses[name] = f"no link is called so; {place}"
    return equipment


def _stated(robot: ET.Element) -> set[str]:
    """The joints with motors, by transmissions, ros2_control or a drive's plugin."""
    stated = {
        joint.get("name", "")
        for holder in (*robot.iter("transmission"), *robot.iter("ros2_control"))
        for joint in holder.iter("joint")
        if holder.tag == "transmission" or joint.find("command_interface") is not None
    }
    return stated | {
        (item.text or "").strip()
        for plugin in robot.iter("plugin")
        for item in plugin.iter()
        if SIDE_JOINT.fullmatch(item.tag)
    }


def _beliefs(robot: ET.Element) -> dict[str, float]:
    """Radius and separation of the wheels that a controller's plugin in the URDF believes."""
    matches: dict[str, float] = {}
    for key, tags in (
        ("controller_separation", ("wheel_separation", "wheelSeparation")),
        ("controller_radius", ("wheel_radius", "wheelRadius")),
        ("controller_radius", ("wheel_diameter", "wheelDiameter")),
    ):
        for element in (item for tag in tags for item in robot.iter(tag)):
            try:
                value = float(element.text or "")
            except ValueError:
                continue
            if value > 0:
                matches.setdefault(key, value / 2 if "iameter" in element.tag else value)
    return matches
