"""Makes docs/terrains/NAME.webp: a rover on each named terrain, and the terrain from above.

python tools/terrains_picture.py docs/terrains [NAME ...]
"""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageDraw

from harness.page.run.hillshade import shade
from harness.world.obstacles import ObstacleKind, outline
from harness.world.terrains import TERRAINS
from harness.world.world import World, build_world

SEED, SECONDS = 1, 8
HEIGHT, WIDTH, GAP = 320, 640, 6  # [pixels] of the picture, which is left of the map
COLORS = {ObstacleKind.ROCK: "#6d5a4b", ObstacleKind.HAZARD: "#b3361f"}
QUALITY = 70  # of WebP, 0 to 100


def driven(name: str, folder: Path) -> Image.Image:
    """Drives a while; returns the picture of its end."""
    target = folder / f"{name}.png"
    words = ["--direct", "--terrain", name, "--seed", str(SEED), "--duration", str(SECONDS)]
    more = ["--log-dir", str(folder), "--picture", str(target)]
    subprocess.run([sys.executable, "-m", "harness.run", *words, *more], check=True)
    return Image.open(target).convert("RGB").resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)


def from_above(world: World) -> Image.Image:
    """Returns the hillshade, north up, with rocks and hazards."""
    relief = shade(world.ground)
    image = Image.fromarray(relief.pixels).convert("RGB").resize((HEIGHT, HEIGHT))
    draw, per_metre = ImageDraw.Draw(image), HEIGHT / relief.size[0]
    for obstacle in world.obstacles:
        points = outline(obstacle).tolist()
        pixels = [((x - relief.west) * per_metre, (relief.north - y) * per_metre) for x, y in points]
        draw.polygon(pixels, fill=COLORS[obstacle.kind], outline=COLORS[obstacle.kind])
    return image


def main(folder: Path, names: list[str]) -> None:
    """Draws the terrains of these names, or all."""
    folder.mkdir(exist_ok=True)
    with TemporaryDirectory() as work:
        for name in names or TERRAINS:
            image = Image.new("RGB", (WIDTH + GAP + HEIGHT, HEIGHT), "white")
            image.paste(driven(name, Path(work)), (0, 0))
            image.paste(from_above(build_world(name, SEED)), (WIDTH + GAP, 0))
            image.save(folder / f"{name}.webp", quality=QUALITY, method=6)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
