"""Learns RoverHarness/PointNav by PPO on two processors; writes a policy that `harness.run` drives.

pip install -e '.[gym]' -r examples/requirements-train.txt
python examples/train_ppo.py point_nav.npz --curve learning.png
python examples/evaluate_policy.py point_nav.npz
"""

import argparse
import time
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import torch
from matplotlib.figure import Figure
from numpy.typing import NDArray
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

import harness.gym  # noqa: F401 - registers
from harness.drivers.policy import Policy, write_policy

ID, TERRAINS = "RoverHarness/PointNav-v0", ("gravel", "rocky")
STEPS = 120_000
ENVIRONMENTS, HOLD = 16, 4  # steps for which an action is held while learning: 0.2 s
TIME_LIMIT = 30.0  # [s] of an episode while learning; it is 60 s afterwards
BEAMS, FAR = 64, 3.0  # of the lidar that the policy looks at, and how far [m]
GAMMA = 0.98  # a reward of 7 s later counts half
SHOWN = 50  # episodes of a terrain that a point of the curve is the mean of


class HeldVecEnv(VecEnv):
    """The vector environment as stable-baselines3 has it; each action is held for some steps.

    Attributes:
        steps: Of all environments together.
        episodes: Those that ended: steps until then, terrain, success.
    """

    def __init__(self, envs: Any, hold: int, seed: int) -> None:
        self.envs, self._hold, self._first_seed, self.steps = envs, hold, seed, 0
        self.episodes: list[tuple[int, str, bool]] = []
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> Any:
        observation, told = self.envs.reset(seed=self._first_seed)
        self._terrains = told["terrain"]
        return observation

    def step_async(self, actions: NDArray[np.float32]) -> None:
        self._actions = actions

    def step_wait(self) -> Any:
        rewards, dones = np.zeros(self.num_envs), np.zeros(self.num_envs, bool)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for _ in range(self._hold):
            observation, reward, terminated, truncated, told = self.envs.step(self._actions)
            self.steps += self.num_envs
            rewards += np.where(dones, 0.0, reward)
            for index in np.flatnonzero((terminated | truncated) & ~dones):
                infos[index] = {
                    "terminal_observation": told["final_obs"][index],
                    "TimeLimit.truncated": bool(truncated[index]),
                }
                success = bool(told["final_info"]["is_success"][index])
                self.episodes.append((self.steps, self._terrains[index], success))
                self._terrains[index] = told["terrain"][index]
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

    def __init__(self, space: gymnasium.spaces.Dict) -> None:
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


def learner(envs: VecEnv, seed: int) -> PPO:
    """Returns PPO with the settings that were used."""
    torch.set_num_threads(1)  # the network is small, and sums keep their order
    return PPO(
        "MultiInputPolicy",
        envs,
        learning_rate=lambda left: 1e-3 * left,
        n_steps=64,
        batch_size=256,
        n_epochs=10,
        gamma=GAMMA,
        seed=seed,
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
        self._held, self._told, self._begun = held, 0, time.perf_counter()

    def _on_step(self) -> bool:
        if len(self._held.episodes) >= self._told + SHOWN:
            self._told = len(self._held.episodes)
            share = np.mean([success for *_, success in self._held.episodes[-SHOWN:]])
            wall, cpu = time.perf_counter() - self._begun, time.process_time()
            told = f"{self._held.steps:,} steps, {wall:.0f} s, {cpu:.0f} s of processor time"
            print(f"{told}: {share:.0%} of the last {SHOWN} episodes reached the goal", flush=True)
        return True


def curve(episodes: list[tuple[int, str, bool]]) -> Figure:
    """Returns the share of episodes that reached their goal over the steps, for each terrain."""
    figure = Figure(figsize=(7.0, 3.4), layout="constrained")
    axes = figure.subplots()
    for terrain in TERRAINS:
        own = [(steps, success) for steps, where, success in episodes if where == terrain]
        steps, successes = np.array(own, float).reshape(-1, 2).T
        share = np.convolve(successes, np.ones(SHOWN) / SHOWN, mode="valid")
        axes.plot(steps[SHOWN - 1 :] / 1e3, 100.0 * share, label=terrain)
    axes.set(xlabel="thousand environment steps (50 ms each)", ylim=(0.0, 101.0), xlim=(0.0, None))
    axes.set_ylabel(f"goal reached, last {SHOWN} episodes [%]")
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right", frameon=False)
    return figure


def main() -> None:
    """Learns, then writes the policy and the curve; Ctrl-C ends learning early."""
    given = parser().parse_args()
    for path in filter(None, (given.policy, given.curve)):
        if not path.absolute().parent.is_dir():
            parser().error(f"folder {path.parent} does not exist; create it, or name another")
    envs: Any = gymnasium.make_vec(
        ID,
        num_envs=ENVIRONMENTS,
        autoreset_mode="SameStep",
        threads=2,
        terrain=TERRAINS,
        time_limit=TIME_LIMIT,
    )
    held = HeldVecEnv(envs, HOLD, given.seed)
    model = learner(VecNormalize(held, norm_obs=False, gamma=GAMMA), given.seed)
    try:
        model.learn(given.steps // HOLD, callback=Progress(held))
    except KeyboardInterrupt:
        print("stopped early; what was learned until here is written")
    write_policy(given.policy, exported(model))
    if given.curve is not None:
        curve(held.episodes).savefig(given.curve, dpi=110)
    held.close()


def parser() -> argparse.ArgumentParser:
    """Returns the parser of the command line."""
    made = argparse.ArgumentParser(description="Learns PointNav on gravel and rocky by PPO.")
    made.add_argument("policy", type=Path, metavar="FILE.npz", help="where to write the policy")
    made.add_argument("--curve", type=Path, metavar="FILE.png", help="where to draw the learning curve")
    about = "of all environments together, default %(default)s"
    made.add_argument("--steps", type=positive, default=STEPS, metavar="N", help=about)
    about = "of the worlds and the network, default %(default)s"
    made.add_argument("--seed", type=int, default=1, metavar="N", help=about)
    return made


def positive(text: str) -> int:
    """Returns a whole number from 1 up."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not valid; give a whole number from 1 up")
    return int(text)


if __name__ == "__main__":
    main()
