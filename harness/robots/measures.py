"""What a compiled model tells of a rover that does not ship: its wheels, motors, sizes, places.

Everything is measured in the frame of the root body while all joints are at 0.
"""

import math
from functools import cached_property

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError, unknown
from harness.robots.model import COLLIDING_GROUP, compiled, extent, read_model
from harness.robots.spec import Drive, RoverSpec

HINGE, VELOCITY, POSITION = int(mujoco.mjtJoint.mjJNT_HINGE), "velocity", "position"
MODEST = 0.5  # of the top speed: what the scripted drivers command, at most CRUISE
CRUISE, TURNING = 1.0, 1.0  # [m/s], [rad/s]
STRAIGHT = 0.9  # cosine of the angle to the axis that a joint should have
EXACTLY_BACKWARD = 1e-6  # [rad]
LOWEST = 0.01  # [m]: less clearance is none


class Measures:
    """Looks at the model of a rover.

    Args:
        rover: Of which only the folder, the model, the drive and the mounts are known.

    Raises:
        UsageError: The model is not valid, or does not have what rover.yaml names.

    Attributes:
        drive: The rover's, complete.
    """

    def __init__(self, rover: RoverSpec) -> None:
        self._rover, self._path = rover, rover.model_path
        self._where = rover.folder / "rover.yaml"
        self._model, self._data = compiled_alone(rover)
        self._hinges = self._named_hinges()
        self._motors = {joint: kind for joint, (kind, _) in self._servos().items()}
        self.drive = self._drive()
        self._check_axes()
        self._wheels = self.drive.left + self.drive.right

    @property
    def passive_joints(self) -> tuple[str, ...]:
        """Joints that are neither wheels nor steering nor the root's."""
        model = self._model
        names = (model.joint(joint).name for joint in range(1, model.njnt))
        return tuple(name for name in names if name not in (*self._wheels, *self.drive.steering))

    @property
    def steered_wheels(self) -> tuple[str, ...]:
        """Wheels whose bodies hang on a steering joint's."""
        steering = {int(self._model.joint(name).bodyid[0]) for name in self.drive.steering}
        return tuple(name for name in self._wheels if steering & set(self._above(name)))

    @property
    def wheel_radius(self) -> float:
        """Of the largest wheel [m]."""
        return max(float(self._wheel_size(name)[[0, 2]].max()) / 2 for name in self._wheels)

    @property
    def wheel_width(self) -> float:
        """Of the widest wheel [m]."""
        return float(max(self._wheel_size(name)[1] for name in self._wheels))

    @property
    def wheel_speed_limit(self) -> float:
        """Of the slowest motor [rad/s]."""
        limits = []
        for joint in self.drive.driven:
            _, motor = self._servos()[joint]
            if not self._model.actuator_ctrllimited[motor]:
                raise UsageError(
                    f"{self._path}: the motor of '{joint}' has no limit; give it a ctrlrange [rad/s]"
                )
            limits.append(float(self._model.actuator_ctrlrange[motor, 1]))
        return min(limits)

    @property
    def gravity(self) -> float:
        """Downwards [m/s^2]."""
        return -float(self._model.opt.gravity[2])

    @property
    def lidar_x(self) -> float:
        """Where the lidar is [m]."""
        return float(self._lidar[0][0])

    @property
    def lidar_y(self) -> float:
        """Where the lidar is [m]."""
        return float(self._lidar[0][1])

    @property
    def lidar_yaw(self) -> float:
        """Where it looks [rad]."""
        axes = self._lidar[1]
        yaw = math.atan2(axes[1, 0], axes[0, 0])
        return math.pi if math.pi - abs(yaw) < EXACTLY_BACKWARD else yaw

    def derived(self) -> dict[str, object]:
        """Returns what rover.yaml may leave out, by its keys."""
        places = np.array([self._place(name) for name in self._wheels])
        left = places[: len(self.drive.left)]
        right = places[len(self.drive.left) :]
        rest_height = self.wheel_radius - float(places[:, 2].min())
        track = float(left[:, 1].mean() - right[:, 1].mean())
        top_speed = self.wheel_speed_limit * self.wheel_radius
        cruise = min(MODEST * top_speed, CRUISE)
        mass = float(self._model.body_mass.sum())
        kind = "Ackermann steering" if self.drive.steering else "skid steer"
        wheelbase = self._wheelbase(places)
        turning = min(TURNING, MODEST * top_speed / (track / 2))
        if self.drive.steering:
            turning = cruise / (wheelbase / math.tan(self.drive.steering_limit) + track / 2)
        return {
            "summary": f"{mass:.1f} kg, {len(places)} wheels, {kind}",
            "odometry_child_frame": frame_name(self._model.body(1).name),
            "imu_frame": "imu_link",
            "rest_height": rest_height,
            "wheelbase": wheelbase,
            "track": track,
            "controller_radius": self.wheel_radius,
            "controller_separation": track,
            "footprint": self._footprint(),
            "linear_acceleration": 2.5,
            "angular_acceleration": 3.0,
            "cruise_speed": cruise,
            "cruise_yaw_rate": turning,
            "encoder_ticks": 4096.0,
            "odometry_rate": 50,
            "lidar_height": float(self._lidar[0][2]) + rest_height,
            "clearance": self._clearance(rest_height),
            "step_limit": self.wheel_radius / 2,
        }

    def _wheelbase(self, places: NDArray[np.float64]) -> float:
        ahead = places[:, 0]
        if not self.steered_wheels:
            return float(np.ptp(ahead)) or 2 * self.wheel_radius  # of one axle: what it needs of ground
        steered = np.isin(self._wheels, self.steered_wheels)
        if steered.all():
            raise UsageError(
                f"{self._where}: drive: all wheels are steered; leave those behind as they are"
            )
        return float(ahead[steered].mean() - ahead[~steered].mean())

    def _footprint(self) -> tuple[float, float, float, float]:
        model = self._model
        geoms = np.flatnonzero(model.geom_group == COLLIDING_GROUP).tolist()
        low, high = extent(model, self._data, geoms)
        return float(low[0]), float(high[0]), float(low[1]), float(high[1])

    def _clearance(self, rest_height: float) -> float:
        model = self._model
        wheels = [int(model.joint(name).bodyid[0]) for name in self._wheels]
        colliding = np.flatnonzero(model.geom_group == COLLIDING_GROUP).tolist()
        rest = [geom for geom in colliding if model.body_weldid[model.geom_bodyid[geom]] not in wheels]
        if not rest:
            return self.wheel_radius
        return max(LOWEST, float(extent(model, self._data, rest)[0][2]) + rest_height)

    @cached_property
    def _lidar(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Position and axes."""
        site = self._data.site("lidar")
        return np.array(site.xpos), np.array(site.xmat).reshape(3, 3)

    def _place(self, joint: str) -> NDArray[np.float64]:
        """The centre of a wheel: that of what collides of it [m]."""
        low, high = extent(self._model, self._data, self._geoms(joint))
        return np.asarray((low + high) / 2)

    def _wheel_size(self, joint: str) -> NDArray[np.float64]:
        low, high = extent(self._model, self._data, self._geoms(joint))
        return np.asarray(high - low)

    def _geoms(self, joint: str) -> list[int]:
        """What collides of a wheel."""
        model = self._model
        body = int(model.joint(joint).bodyid[0])
        of_wheel = (model.body_weldid[model.geom_bodyid] == body) & (model.geom_group == COLLIDING_GROUP)
        found: list[int] = np.flatnonzero(of_wheel).tolist()
        if not found:
            raise UsageError(
                f"{self._path}: wheel '{joint}' has no geom that collides; give its body one"
            )
        return found

    def _above(self, joint: str) -> list[int]:
        """The bodies from a joint's up to the root."""
        body, found = int(self._model.joint(joint).bodyid[0]), []
        while body:
            found.append(body)
            body = int(self._model.body_parentid[body])
        return found

    def _named_hinges(self) -> list[str]:
        model = self._model
        hinges = [joint for joint in range(1, model.njnt) if model.jnt_type[joint] == HINGE]
        for joint in range(1, model.njnt):
            if not model.joint(joint).name:
                body = model.body(model.jnt_bodyid[joint]).name
                raise UsageError(f"{self._path}: a joint of body '{body}' has no name; give it one")
        return [model.joint(joint).name for joint in hinges]

    def _servos(self) -> dict[str, tuple[str, int]]:
        """Each joint's servo: what it controls, and its actuator."""
        model, found = self._model, {}
        for motor in range(model.nu):
            gain, bias = model.actuator_gainprm[motor, 0], model.actuator_biasprm[motor]
            on_joint = model.actuator_trntype[motor] == mujoco.mjtTrn.mjTRN_JOINT
            kind = VELOCITY if bias[1] == 0.0 and bias[2] == -gain else POSITION
            if on_joint and -gain in (bias[1], bias[2]) and gain > 0.0:
                found[model.joint(model.actuator_trnid[motor, 0]).name] = (kind, motor)
        return found

    def _drive(self) -> Drive:
        said = self._rover.drive or Drive()
        for key in ("left", "right", "driven", "steering"):
            for joint in getattr(said, key):
                if joint not in self._hinges:
                    raise UsageError(
                        f"{self._where}: drive: {key}: {unknown('hinge', joint, self._hinges)}"
                    )
        driving = [
            name for name, kind in self._motors.items() if kind == VELOCITY and name in self._hinges
        ]
        left, right = said.left, said.right
        if not (left and right):
            sides = {name: self._place(name) for name in driving}
            ordered = sorted(sides, key=lambda name: -sides[name][0])
            left = left or tuple(name for name in ordered if sides[name][1] > 0)
            right = right or tuple(name for name in ordered if sides[name][1] <= 0)
        if len(left) != len(right):
            raise UsageError(
                f"{self._where}: drive: {len(left)} wheels left and {len(right)} right are not valid; "
                f"give as many on either side, or leave both out (left: {left}, right: {right})"
            )
        driven = said.driven or tuple(name for name in (*left, *right) if name in driving)
        self._check_motors(said, driven, driving, left and right)
        return Drive(
            kind=said.kind,
            left=left,
            right=right,
            driven=driven,
            steering=said.steering,
            steering_limit=said.steering_limit or self._steering_limit(said),
            steering_rate=said.steering_rate,
        )

    def _check_motors(
        self, said: Drive, driven: tuple[str, ...], driving: list[str], sides: object
    ) -> None:
        lacking = [name for name in driven if name not in driving]
        if not sides or not driven or lacking:
            told = f"'{lacking[0]}' has none" if lacking else f"it has {len(driving)}"
            raise UsageError(f"{self._path}: the wheels of each side need <velocity> actuators; {told}")
        if len(said.steering) != (2 if said.kind == "ackermann" else 0):
            raise UsageError(
                f"{self._where}: drive: steering = {list(said.steering)} is not valid with "
                f"kind '{said.kind}'; give those of the left and the right front wheel, none with skid"
            )
        for name in said.steering:
            if self._motors.get(name) != POSITION:
                raise UsageError(
                    f"{self._path}: steering joint '{name}' needs a <position> actuator; give it one"
                )

    def _steering_limit(self, said: Drive) -> float:
        """The smallest of the ranges of the steering's joints and motors [rad]."""
        model, limits = self._model, [math.inf]
        for name in said.steering:
            joint, motor = model.joint(name).id, self._servos()[name][1]
            if model.jnt_limited[joint]:
                limits += [-float(model.jnt_range[joint, 0]), float(model.jnt_range[joint, 1])]
            if model.actuator_ctrllimited[motor]:
                limits += np.abs(model.actuator_ctrlrange[motor]).tolist()
        if not said.steering:
            return 0.0
        if not 0.0 < min(limits) < math.pi / 2:
            raise UsageError(
                f"{self._where}: drive: key 'steering_limit' is missing; give the largest angle [rad], "
                "for neither joint nor actuator has one"
            )
        return min(limits)

    def _check_axes(self) -> None:
        """Wheels turn about +y, steering about +z: else commands would do the contrary."""
        for names, axis, about in (
            (self.drive.left + self.drive.right, 1, "+y"),
            (self.drive.steering, 2, "+z"),
        ):
            for name in names:
                along = float(self._data.xaxis[self._model.joint(name).id][axis])
                if along < STRAIGHT:
                    raise UsageError(
                        f"{self._path}: joint '{name}' must turn about {about}; its axis is "
                        f"{np.round(self._data.xaxis[self._model.joint(name).id], 3).tolist()} in the "
                        "root body's frame: turn it"
                    )


def compiled_alone(rover: RoverSpec) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Returns a rover's model without a world, and its state at the origin, all joints at 0.

    Raises:
        UsageError: The model is not valid.
    """
    model = compiled(read_model(rover), rover.model_path)
    data = mujoco.MjData(model)
    data.qpos[:], data.qpos[3] = 0.0, 1.0
    mujoco.mj_kinematics(model, data)
    return model, data


def frame_name(body: str) -> str:
    """Returns what the frame of a body is called: as the body, if that sounds like a frame."""
    return body if body.endswith(("_link", "_frame", "_footprint")) else f"{body}_link"
