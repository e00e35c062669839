"""What a rover's motors can do, as MuJoCo has it: DC motors, sides that turn as one, play.

The model's <velocity> servos become <dcmotor>s with the same gain: they give the torque that the servo
asks for up to what current and voltage allow, K i_max and K / R (V - K w). Constants are those of a
motor and its gear at the wheels. Two wheels that share a motor are tied and carry half of it each.
"""

from itertools import pairwise

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.robots.sections import Actuators
from harness.robots.spec import RoverSpec

MOTOR_TORQUE, MOTOR_SPEED = "motor_torque_", "motor_speed_"  # before it, of a sensor
TIE, PLAY = "_tie", "_play"  # behind a joint's name
TIGHT = 0.005  # [s]: time constant of what ties two wheels; at least two steps
SLOW = 1e-3  # [m/s]: below it nothing says in which direction a rover moves
ROTOR = 0.05  # of a wheel's inertia that stays behind the play, at least


def fit_motors(spec: mujoco.MjSpec, rover: RoverSpec) -> None:
    """Gives a model that is not compiled the motors of its rover's section `actuators`, if real."""
    actuators = rover.actuators
    if actuators is None or not rover.real:
        return
    for side in (rover.drive.left, rover.drive.right):
        driven = [name for name in side if name in rover.drive.driven]
        share = len(driven) if actuators.one_motor_a_side else 1
        for name in driven:
            _make_motor(spec, name, actuators, share)
        if actuators.one_motor_a_side:
            for one, other in pairwise(driven):
                _tie(spec, one, other)
        if actuators.backlash > 0.0:
            for name in driven:
                _add_play(spec.joint(name), actuators.backlash)


def sense_motors(spec: mujoco.MjSpec, rover: RoverSpec, prefix: str) -> None:
    """Adds what batteries read of real motors: each driven joint's torque [N m] and speed [rad/s].

    Args:
        spec: The scene's.
        rover: One without real motors gets nothing.
        prefix: What the rover's names begin with there.
    """
    if not rover.real:
        return
    for name, kind in (
        (MOTOR_TORQUE, mujoco.mjtSensor.mjSENS_JOINTACTFRC),
        (MOTOR_SPEED, mujoco.mjtSensor.mjSENS_JOINTVEL),
    ):
        for joint in rover.drive.driven:
            own = prefix + joint
            spec.add_sensor(
                name=prefix + name + joint, type=kind, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=own
            )


def _make_motor(spec: mujoco.MjSpec, joint: str, actuators: Actuators, share: int) -> None:
    (motor,) = (one for one in spec.actuators if one.target == joint)
    constant, gain = actuators.motor_constant, actuators.gain or float(motor.gainprm[0])
    if actuators.inertia is not None:
        spec.joint(joint).armature = actuators.inertia
    motor.set_to_dcmotor(
        motorconst=[constant, constant],
        resistance=actuators.resistance * share,
        saturation=[0.0, actuators.current_limit / share, 0.0],
        controller=[0.0, 0.0, gain, 0.0, 0.0, actuators.voltage],
        ctrlspec=int(mujoco.mjtCtrlInput.mjINPUT_VEL),
    )


def _tie(spec: mujoco.MjSpec, one: str, other: str) -> None:
    spec.add_equality(
        name=one + TIE,
        type=mujoco.mjtEq.mjEQ_JOINT,
        objtype=mujoco.mjtObj.mjOBJ_JOINT,
        name1=one,
        name2=other,
        data=[0.0, 1.0, *[0.0] * 10],
        solref=[max(TIGHT, 2 * spec.option.timestep), 1.0],
    )


def _add_play(joint: mujoco.MjsJoint, backlash: float) -> None:
    """A second hinge between gear and wheel, free within the play; the encoder is before it."""
    joint.parent.add_joint(
        name=joint.name + PLAY,
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=joint.axis,
        pos=joint.pos,
        range=[-backlash / 2, backlash / 2],
        limited=mujoco.mjtLimited.mjLIMITED_TRUE,
        armature=ROTOR * float(joint.armature),
    )


def resist_rolling(model: mujoco.MjModel, rover: RoverSpec, prefix: str, root: int) -> None:
    """Adds what tyres and gears lose to the friction of a compiled rover's wheels.

    Where it falls with speed, that part of it is a damping that is negative.

    Args:
        model: Is changed.
        rover: Has the tyres.
        prefix: What the rover's names begin with in the model.
        root: Number of its root body there.

    Raises:
        UsageError: It would push the rover at its top speed.
    """
    if rover.tyres.falling * rover.top_speed >= 1.0:
        raise UsageError(
            f"rolling resistance that is falling by {rover.tyres.falling:g} s/m would push {rover.name} "
            f"at {rover.top_speed:g} m/s; give less than {1.0 / rover.top_speed:.2g}"
        )
    if rover.tyres.rolling:
        load = _weight(model, root) / len(rover.wheel_joints)
        dofs = np.array([int(model.joint(prefix + name).dofadr[0]) for name in rover.wheel_joints])
        torque = rover.tyres.rolling * load * rover.wheel_radius
        model.dof_frictionloss[dofs] += torque
        model.dof_damping[dofs] -= torque * rover.tyres.falling * rover.wheel_radius


def _weight(model: mujoco.MjModel, root: int) -> float:
    """What a rover weighs in its world [N]."""
    return float(model.body_subtreemass[root]) * -float(model.opt.gravity[2])


class Drag:
    """What soft ground resists of a rover's motion, as it is pushed aside: dry friction of its root.

    Unlike rolling resistance it needs traction: while wheels slide sideways it costs speed.

    Args:
        model: Whose friction it is.
        rover: Whose tyres say how much.
        root: Its root body.

    Attributes:
        acts: Whether there is any.
    """

    def __init__(self, model: mujoco.MjModel, rover: RoverSpec, root: int) -> None:
        first = int(model.body_dofadr[root])
        self.acts = rover.tyres.drag > 0.0
        self._force = rover.tyres.drag * _weight(model, root)
        self._friction = model.dof_frictionloss[first : first + 2]

    def turn(self, velocity: NDArray[np.float64]) -> None:
        """Lets it act against a velocity in the world's x and y [m/s]; to be called now and then."""
        if self.acts:
            speed = float(np.hypot(*velocity))
            share = np.abs(velocity) / speed if speed > SLOW else np.full(2, np.sqrt(0.5))
            self._friction[:] = self._force * share
