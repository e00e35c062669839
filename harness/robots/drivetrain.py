"""Which joints of a rover that does not ship drive and steer it, and whether its model is made so."""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError, unknown
from harness.robots.model import body_box, by_side, compiled_alone
from harness.robots.sections import Drive
from harness.robots.spec import RoverSpec

HINGE, VELOCITY, POSITION = int(mujoco.mjtJoint.mjJNT_HINGE), "velocity", "position"
STRAIGHT = 0.9  # cosine of the angle to the axis that a joint should have


class Drivetrain:
    """Wheels, motors and steering, by the servos of the model where rover.yaml does not name them.

    Args:
        rover: Its folder, and what rover.yaml states; other fields are None.

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
        driving = {*self._wheels, *self.drive.steering}
        names = (self._model.joint(joint).name for joint in range(1, self._model.njnt))
        return tuple(name for name in names if name not in driving)

    @property
    def steered_wheels(self) -> tuple[str, ...]:
        """Wheels whose bodies hang on a steering joint's."""
        steering = {self._body_of(name) for name in self.drive.steering}
        return tuple(name for name in self._wheels if steering & set(self._above(name)))

    @property
    def wheel_speed_limit(self) -> float:
        """Largest speed of the slowest motor [rad/s]."""
        limits = []
        for joint in self.drive.driven:
            _, motor = self._servos()[joint]
            low, high = self._model.actuator_ctrlrange[motor] * self._model.actuator_ctrllimited[motor]
            if not low < 0.0 < high:
                raise UsageError(
                    f"{self._path}: the motor of '{joint}' has no limit ahead and back; give it a "
                    "ctrlrange of -LIMIT LIMIT [rad/s]"
                )
            limits.append(float(min(-low, high)))
        return min(limits)

    def _box(self, joint: str) -> NDArray[np.float64]:
        """Lowest and highest x, y, z of the geoms of a wheel that collide [m], shape (2, 3)."""
        box = body_box(self._model, self._data, self._body_of(joint))
        if not np.isfinite(box).all():
            raise UsageError(
                f"{self._path}: wheel '{joint}' has no geom that collides; give its body one"
            )
        return box

    def _body_of(self, joint: str) -> int:
        return int(self._model.joint(joint).bodyid[0])

    def _above(self, joint: str) -> list[int]:
        """The bodies from a joint's up to the root."""
        body, bodies = self._body_of(joint), []
        while body:
            bodies.append(body)
            body = int(self._model.body_parentid[body])
        return bodies

    def _named_hinges(self) -> list[str]:
        model = self._model
        joints = [model.joint(joint) for joint in range(1, model.njnt)]
        for joint in joints:
            if not joint.name:
                body = model.body(joint.bodyid[0]).name
                raise UsageError(f"{self._path}: a joint of body '{body}' has no name; give it one")
        return [joint.name for joint in joints if joint.type[0] == HINGE]

    def _servos(self) -> dict[str, tuple[str, int]]:
        """Each joint's servo: what it controls, and its actuator."""
        model, servos = self._model, {}
        for motor in range(model.nu):
            gain, bias = model.actuator_gainprm[motor, 0], model.actuator_biasprm[motor]
            on_joint = model.actuator_trntype[motor] == mujoco.mjtTrn.mjTRN_JOINT
            kind = VELOCITY if bias[1] == 0.0 and bias[2] == -gain else POSITION
            if on_joint and -gain in (bias[1], bias[2]) and gain > 0.0:
                servos[model.joint(model.actuator_trnid[motor, 0]).name] = (kind, motor)
        return servos

    def _drive(self) -> Drive:
        stated = self._rover.drive
        for key in ("left", "right", "driven", "steering"):
            for joint in getattr(stated, key):
                if joint not in self._hinges:
                    raise UsageError(
                        f"{self._where}: drive: {key}: {unknown('hinge', joint, self._hinges)}"
                    )
        driving = [
            name for name, kind in self._motors.items() if kind == VELOCITY and name in self._hinges
        ]
        left, right = stated.left, stated.right
        if not (left and right):
            on_left, on_right = by_side({name: self._box(name).mean(axis=0) for name in driving})
            left, right = left or on_left, right or on_right
        if len(left) != len(right):
            raise UsageError(
                f"{self._where}: drive: {len(left)} wheels left and {len(right)} right are not valid; "
                f"give as many on either side, or leave both out (left: {left}, right: {right})"
            )
        driven = stated.driven or tuple(name for name in (*left, *right) if name in driving)
        self._check_motors(stated, driven, driving, left and right)
        limit = stated.steering_limit or self._steering_limit(stated)
        return stated.but(left=left, right=right, driven=driven, steering_limit=limit)

    def _check_motors(
        self, stated: Drive, driven: tuple[str, ...], driving: list[str], sides: object
    ) -> None:
        lacking = [name for name in driven if name not in driving]
        if not sides or not driven or lacking:
            speed = {number for kind, number in self._servos().values() if kind == VELOCITY}
            others = [
                self._model.actuator(n).name or f"number {n}" for n in {*range(self._model.nu)} - speed
            ]
            motors = f"'{lacking[0]}' has none" if lacking else f"it has {len(driving)}"
            motors += f"; others: {', '.join(sorted(others))}" if others else ""
            raise UsageError(
                f"{self._path}: the wheels of each side need <velocity> actuators; {motors}"
            )
        gears = {name: float(self._model.actuator_gear[self._servos()[name][1], 0]) for name in driven}
        if geared := next((name for name, gear in gears.items() if gear != 1.0), None):
            raise UsageError(
                f"{self._path}: the motor of '{geared}' has gear {gears[geared]:g}: ctrlrange is not "
                "the wheel's; give it gear 1, and ctrlrange, kv and forcerange of the wheel"
            )
        self._check_free(driven)
        if len(stated.steering) != (2 if stated.kind == "ackermann" else 0):
            raise UsageError(
                f"{self._where}: drive: steering = {list(stated.steering)} is not valid with "
                f"kind '{stated.kind}'; give those of the left and the right front wheel, none with skid"
            )
        for name in stated.steering:
            if self._motors.get(name) != POSITION:
                raise UsageError(
                    f"{self._path}: steering joint '{name}' needs a <position> actuator; give it one"
                )

    def _check_free(self, driven: tuple[str, ...]) -> None:
        """Wheels turn on and on, and nothing else turns them."""
        model = self._model
        on_joint = model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT
        for name in driven:
            joint = model.joint(name).id
            its = on_joint & (model.actuator_trnid[:, 0] == joint)
            holds = {
                "a range": model.jnt_limited[joint],
                "a stiffness": model.jnt_stiffness[joint],
                "a second actuator": its.sum() > 1,
                "a delay": model.actuator_delay[its].any(),  # rover.yaml may have one
            }
            for hindrance, is_there in holds.items():
                if is_there:
                    raise UsageError(
                        f"{self._path}: wheel '{name}' has {hindrance}, against which it does not "
                        "turn as commanded; take it out"
                    )

    def _steering_limit(self, stated: Drive) -> float:
        """The smallest of the ranges of the steering's joints and motors [rad]."""
        model, limits = self._model, [math.inf]
        for name in stated.steering:
            joint, motor = model.joint(name).id, self._servos()[name][1]
            if model.jnt_limited[joint]:
                limits += [-float(model.jnt_range[joint, 0]), float(model.jnt_range[joint, 1])]
            if model.actuator_ctrllimited[motor]:
                limits += np.abs(model.actuator_ctrlrange[motor]).tolist()
        if not stated.steering:
            return 0.0
        if not 0.0 < min(limits) < math.pi / 2:
            raise UsageError(
                f"{self._where}: drive: key 'steering_limit' is missing; give the largest angle [rad], "
                "for neither joint nor actuator has one"
            )
        return min(limits)

    def _check_axes(self) -> None:
        """Wheels turn about +y, steering about +z: or commands would do the contrary."""
        for names, axis, about in (
            (self.drive.left + self.drive.right, 1, "+y"),
            (self.drive.steering, 2, "+z"),
        ):
            for name in names:
                its = self._data.xaxis[self._model.joint(name).id]
                if its[axis] < STRAIGHT:
                    raise UsageError(
                        f"{self._path}: joint '{name}' must turn about {about}; its axis is "
                        f"{np.round(its, 3).tolist()} in the root body's frame: turn it"
                    )
