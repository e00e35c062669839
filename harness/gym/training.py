"""Learns RoverHarness/PointNav by PPO of stable-baselines3, and writes a policy."""

import math
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import gymnasium
import numpy as np
import torch
from matplotlib.figure import Figure
from numpy.typing import NDArray
from pydantic import Field
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

import harness.gym  # noqa: F401 - registers
from harness.base.errors import find_named
from harness.base.files import check_target
from harness.drivers.policy import Policy, write_policy
from harness.gym.evaluation import ID
from harness.robots import find_rover
from harness.spec.value import Value, listed, made
from harness.world.terrains import TERRAINS

BEAMS, FAR = 64, 3.0  # of the lidar that the policy looks at, and how far [m]
GAMMA = 0.98  # a reward of 7 s later counts half
SHOWN = 50  # episodes of a terrain that a point of the curve is the mean of


class Training(Value):
    """What CONFIG says.

    Attributes:
        policy: Where the policy is written, .npz.
        curve: Where the learning curve is drawn, .png; "" for nowhere.
        robot: Which rover learns.
        terrains: Where.
        difficulty: Of the terrains.
        steps: Of 50 ms, of all environments together.
        environments: How many learn at once.
        hold: Steps for which an action is held.
        time_limit: Of an episode while learning [s].
        learning_rate: At first; it falls to 0.
        seed: Of the worlds and the network.
    """

    policy: Path
    curve: str = ""
    robot: str = "leo"
    terrains: Annotated[tuple[str, ...], listed(), Field(min_length=1)] = ("gravel", "rocky")
    difficulty: Annotated[float, Field(ge=0.0, le=1.0)] = 0.5
    steps: Annotated[int, Field(ge=1)] = 120_000
    environments: Annotated[int, Field(ge=1, le=1024)] = 16
    hold: Annotated[int, Field(ge=1, le=100)] = 4
    time_limit: Annotated[float, Field(gt=0.0, le=600.0)] = 30.0
    learning_rate: Annotated[float, Field(gt=0.0, le=1.0)] = 1e-3
    seed: Annotated[int, Field(ge=0)] = 1


class HeldVecEnv(VecEnv):
    """The vector environment as stable-baselines3 has it; each action is held for some steps.

    Args:
        envs: Vector environment of this project.
        hold: Steps for which an action is held.
        seed: Of the first reset.

    Attributes:
        steps: Of all environments together.
        episodes: Those that ended: steps until then, terrain, success.
    """

    def __init__(self, envs: Any, hold: int, seed: int) -> None:
        self.envs, self._hold, self._first_seed, self.steps = envs, hold, seed, 0
        self.episodes: list[tuple[int, str, bool]] = []
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> Any:
        observation, info = self.envs.reset(seed=self._first_seed)
        self._terrains = info["terrain"]
        return observation

    def step_async(self, actions: NDArray[np.float32]) -> None:
        self._actions = actions

    def step_wait(self) -> Any:
        rewards, dones = np.zeros(self.num_envs), np.zeros(self.num_envs, bool)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for _ in range(self._hold):
            observation, reward, terminated, truncated, info = self.envs.step(self._actions)
            self.steps += self.num_envs
            rewards += np.where(dones, 0.0, reward)
            for index in np.flatnonzero((terminated | truncated) & ~dones):
                infos[index] = {
                    "terminal_observation": info["final_obs"][index],
                    "TimeLimit.truncated": bool(truncated[index]),
                }
                success = bool(info["final_info"]["is_success"][index])
                self.episodes.append((self.steps, self._terrains[index], success))
                self._terrains[index] = info["terrain"][index]
            dones |= terminated | truncated
        return observation, rewards, dones, infos

    def close(self) -> None:
        self.envs.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        return [getattr(env, attr_name) for env in self.envs.envs]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        raise NotImplementedError

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> Any:
        raise NotImplementedError

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        return [False] * self.num_envs


class Features(BaseFeaturesExtractor):
    """What the network is given: a fixed layer of rectified linear units, which is exported with it.

    How near every tenth beam's hit is, the way to the goal, attitude and speeds; signed numbers as two.
    """

    def __init__(self, space: Any) -> None:
        weights, bias = fixed_layer(space["lidar"].shape[0])
        super().__init__(space, len(bias))
        self.register_buffer("weights", torch.from_numpy(weights))
        self.register_buffer("bias", torch.from_numpy(bias))

    def forward(self, observation: dict[str, torch.Tensor]) -> torch.Tensor:
        values = torch.cat([observation[name] for name in sorted(observation)], dim=1)
        return torch.relu(values @ self.weights + self.bias)


def fixed_layer(beams: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Returns weights and bias of `Features`, of goal, imu, lidar and velocities in this order."""
    units = [(11 + beam, -1.0 / FAR, 1.0) for beam in range(0, beams, beams // BEAMS)]
    units += [(0, 0.2, 0.0), (0, -0.5, 1.0)]  # distance: far, near
    scales = {1: 1.0, 2: 1.0, 9: 2.0, 10: 2.0, 11 + beams: 1.0, 12 + beams: 1.0}
    units += [(index, sign * scale, 0.0) for index, scale in scales.items() for sign in (1.0, -1.0)]
    weights = np.zeros((13 + beams, len(units)), np.float32)
    for unit, (index, scale, _) in enumerate(units):
        weights[index, unit] = scale
    return weights, np.array([bias for *_, bias in units], np.float32)


def learner(envs: VecEnv, config: Training) -> PPO:
    """Returns PPO with the settings of a training."""
    torch.set_num_threads(1)  # the network is small, and sums keep their order
    return PPO(
        "MultiInputPolicy",
        envs,
        learning_rate=lambda left: config.learning_rate * left,
        n_steps=64,
        batch_size=64 * math.gcd(config.environments, 4),
        n_epochs=10,
        gamma=GAMMA,
        seed=config.seed,
        device="cpu",
        policy_kwargs={
            "features_extractor_class": Features,
            "net_arch": [64, 64],
            "activation_fn": torch.nn.ReLU,
            "log_std_init": -0.5,
        },
    )


def exported(model: PPO) -> Policy:
    """Returns the network as numpy arrays, the fixed layer first."""
    features = model.policy.pi_features_extractor
    learned = [*model.policy.mlp_extractor.policy_net, model.policy.action_net]
    layers = [
        (layer.weight.detach().numpy().T, layer.bias.detach().numpy())
        for layer in learned
        if isinstance(layer, torch.nn.Linear)
    ]
    return Policy(((features.weights.numpy(), features.bias.numpy()), *layers), "relu")


class Progress(BaseCallback):
    """Prints a line now and then."""

    def __init__(self, held: HeldVecEnv) -> None:
        super().__init__()
        self._held, self._shown, self._begun = held, 0, time.perf_counter()

    def _on_step(self) -> bool:
        if len(self._held.episodes) >= self._shown + SHOWN:
            self._shown = len(self._held.episodes)
            share = np.mean([success for *_, success in self._held.episodes[-SHOWN:]])
            wall, cpu = time.perf_counter() - self._begun, time.process_time()
            so_far = f"{self._held.steps:,} steps, {wall:.0f} s, {cpu:.0f} s of processor time"
            print(f"{so_far}: {share:.0%} of the last {SHOWN} episodes reached the goal", flush=True)
        return True


def curve(episodes: list[tuple[int, str, bool]], terrains: tuple[str, ...]) -> Figure:
    """Returns the share of episodes that reached their goal over the steps, for each terrain."""
    figure = Figure(figsize=(7.0, 3.4), layout="constrained")
    axes = figure.subplots()
    for terrain in terrains:
        own = [(steps, success) for steps, where, success in episodes if where == terrain]
        steps, successes = np.array(own, float).reshape(-1, 2).T
        shares = [100.0 * successes[max(0, end - SHOWN) : end].mean() for end in range(1, len(own) + 1)]
        axes.plot(steps / 1e3, shares, label=terrain)
    axes.set(xlabel="thousand environment steps (50 ms each)", ylim=(0.0, 101.0), xlim=(0.0, None))
    axes.set_ylabel(f"goal reached, last {SHOWN} episodes [%]")
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right", frameon=False)
    return figure


def train(values: Mapping[str, object], where: str) -> None:
    """Learns, then writes the policy and the curve; Ctrl-C ends learning early.

    Raises:
        UsageError: One of the `values` of a Training, read from `where`, is not valid.
    """
    config = made(Training, values, where)
    for terrain in config.terrains:
        find_named(f"{where}: terrain", terrain, TERRAINS)
    find_rover(config.robot)
    check_target(f"{where}: policy", config.policy, ".npz")
    if config.curve:
        check_target(f"{where}: curve", Path(config.curve))
    held = HeldVecEnv(_environments(config), config.hold, config.seed)
    model = learner(VecNormalize(held, norm_obs=False, gamma=GAMMA), config)
    try:
        model.learn(config.steps // config.hold, callback=Progress(held))
    except KeyboardInterrupt:
        print("stopped early; what was learned until here is written")
    write_policy(config.policy, exported(model))
    if config.curve:
        curve(held.episodes, config.terrains).savefig(config.curve, dpi=110)
    held.close()
    print(f"{held.steps:,} steps, {len(held.episodes)} episodes; policy: {config.policy}")


def _environments(config: Training) -> Any:
    return gymnasium.make_vec(
        ID,
        num_envs=config.environments,
        autoreset_mode="SameStep",
        threads=2,
        robot=config.robot,
        terrain=config.terrains,
        difficulty=config.difficulty,
        time_limit=config.time_limit,
    )
