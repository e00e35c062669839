"""Draws the last cloud of /lidar3d/points and the last image of /depth/image of a recording.

python -m harness.run --sensors lidar3d=os1_64,depth --duration 8 --record run.mcap
python tools/sensors_picture.py run.mcap docs/sensors.png
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray
from rosbags.highlevel import AnyReader

POINT = np.dtype("<f4,<f4,<f4,<f4,<u2,<f4")
FARTHEST = 10.0  # [m] that is drawn of the cloud


def last_messages(bag: Path, topics: tuple[str, ...]) -> list[object]:
    """Returns the last message of each topic."""
    with AnyReader([bag]) as reader:
        connections = [c for c in reader.connections if c.topic in topics]
        last = {c.topic: (data, c.msgtype) for c, _, data in reader.messages(connections)}
        return [reader.deserialize(*last[topic]) for topic in topics]


def draw_cloud(axes: plt.Axes, points: NDArray[np.void]) -> None:
    """Draws a cloud in its sensor's frame, seen from behind and above."""
    x, y, z = (points[name].astype(float) for name in ("f0", "f1", "f2"))
    near = np.hypot(x, y) < FARTHEST
    order = np.argsort(-x[near])
    seen = [values[near][order] for values in (x, y, z)]
    axes.scatter(*seen, c=seen[2], s=0.8, cmap="viridis", linewidths=0)
    axes.set_box_aspect(tuple(np.ptp(values) for values in seen), zoom=1.3)
    axes.view_init(elev=38, azim=-160)
    axes.set(
        xlabel="x [m]", ylabel="y [m]", zticks=[], title="/lidar3d/points (os1_64), colour by height"
    )


def draw_depth(axes: plt.Axes, depth: NDArray[np.float32]) -> None:
    """Draws a depth image; white where nothing is in range."""
    shown = axes.imshow(np.where(np.isfinite(depth), depth, np.nan), cmap="magma_r")
    axes.set(xlabel="u [pixels]", ylabel="v [pixels]", title="/depth/image (160 x 120)")
    axes.figure.colorbar(shown, ax=axes, label="depth [m]", shrink=0.8)


def main(bag: Path, picture: Path) -> None:
    """Draws both, side by side."""
    cloud, image = last_messages(bag, ("/lidar3d/points", "/depth/image"))
    figure = plt.figure(figsize=(13, 5.2), layout="constrained")
    left, right = figure.add_gridspec(1, 2, width_ratios=(1.15, 1))
    draw_cloud(figure.add_subplot(left, projection="3d"), np.frombuffer(cloud.data, POINT))
    depth = np.frombuffer(image.data, "<f4").reshape(image.height, image.width)
    draw_depth(figure.add_subplot(right), depth)
    figure.savefig(picture, dpi=90)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
