"""What a run of the command line leaves behind beside its log, and the mishaps that make it fail."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from harness.base.files import BESIDE
from harness.episode.mishaps import KINDS, Kind
from harness.spec.value import Option, Value, listed


class Files(Value):
    """What a run leaves behind, beside its log."""

    out: Annotated[Path | None, Option("FOLDER")] = Field(
        default=None,
        description="leave all of the run in one folder: log, manifest, page, picture; default: the log "
        "and its manifest, see --log-dir",
    )
    page: Annotated[Path | None, Option("FILE.html", also=("--report",), bare=str(BESIDE))] = Field(
        default=None,
        description="write a page about the run: map, plots, truth; without a FILE beside the log, "
        "under its name; default: none",
    )
    summary: Annotated[Path | None, Option("FILE.json", flag="json", also=("--summary",))] = Field(
        default=None, description="write the manifest there"
    )
    social_log: Annotated[Path | None, Option("FILE.csv")] = Field(
        default=None, description="the social log of a run with people; default: see --log-dir"
    )
    picture: Annotated[Path | None, Option("FILE.png", bare=str(BESIDE))] = Field(
        default=None, description="draw the rover at the end of its path; without a FILE beside the log"
    )
    video: Annotated[Path | None, Option("FILE.mp4")] = Field(
        default=None, description="draw the run in at most 10 s, with time and speed (extra [video])"
    )
    picture_lidar: Annotated[bool, Option("")] = Field(
        default=False, description="show the lidar's hits and some of its beams"
    )
    camera: Annotated[Literal["", "chase", "top", "side"], Option("VIEW")] = Field(
        default="", description="of picture and video; default: where much is seen, and from behind"
    )
    fail_on: Annotated[tuple[Kind, ...], listed(","), Option("KIND[,...]")] = Field(
        default=(),
        description=f"exit with 1 if the rover came to one of these: {', '.join(KINDS)}; default: none",
    )

    def in_one_folder(self) -> "Files":
        """Returns the same files with a page and a picture, if all is to be in one folder."""
        wanted = () if self.out is None else ("page", "picture")
        return self.but(**{name: BESIDE for name in wanted if getattr(self, name) is None})
