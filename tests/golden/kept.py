"""The references: what each golden run gave when somebody last looked at it and kept it."""

import fcntl
import hashlib
import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from harness.base.files import write_whole
from tests.golden.evidence import Evidence, Message
from tests.golden.invariants import VOLATILE, first_difference, flat
from tests.golden.products import of_page, of_recording, of_summary
from tests.golden.table import TABLE
from tests.support.documents import ROOT

REFERENCES = Path(__file__).with_name("references.json")
ARITHMETIC = "arithmetic"  # the key of that of the machine that made them
RELATIVE, ABSOLUTE = 0.05, 0.02  # of numbers, where the arithmetic is another
SCENE = (
    "<mujoco><option timestep='0.0025'/><worldbody><geom type='plane' size='9 9 1'/>"
    "<body pos='0 0 1' euler='10 20 30'><freejoint/><geom type='box' size='.3 .2 .1'/></body>"
    "<body pos='.2 0 2'><freejoint/><geom type='cylinder' size='.2 .1'/></body></worldbody></mujoco>"
)


@cache
def arithmetic() -> str:
    """Returns a hash of how this machine computes: a bare simulation and some of numpy's functions."""
    model = mujoco.MjModel.from_xml_string(SCENE)
    data = mujoco.MjData(model)
    for _ in range(800):
        mujoco.mj_step(model, data)
    values = np.random.default_rng(0).normal(size=999)
    parts = [np.sin(values), np.exp(values), np.hypot(values, 0.3), np.sum(values), values @ values]
    digest = hashlib.sha256(data.qpos.tobytes() + b"".join(np.asarray(part).tobytes() for part in parts))
    digest.update(repr([math.atan2(x, 0.7) + math.tan(x) for x in values.tolist()]).encode())
    return digest.hexdigest()


def outcome(evidence: Evidence, folder: Path) -> dict[str, Any]:
    """Returns what is kept of a run: a summary, its logs, and hashes without the name of the folder."""
    summary, hashes, logs = dict[str, Any](), dict[str, Any](), dict[str, Any]()
    for number, (driven, page) in enumerate(zip(evidence.direct, evidence.pages, strict=True)):
        name, truth = driven.name or "rover", driven.manifest["truth"]
        summary[name] = {key: value for key, value in truth.items() if key not in ("events", "path")}
        summary[name]["rows"] = driven.csv.count("\n") - 1
        events = (f"{event['kind']} {event['part']} {event['other']}" for event in truth["events"])
        of_ros = [each.manifest for each in evidence.ros[number : number + 1]]
        hashes[name] = {"stream": driven.stream, "events": _hash("\n".join(events))}
        hashes[name]["products"] = driven.products | of_page(page) | of_summary(driven.lasting)
        hashes[name]["manifests"] = [
            _hash(_lasting(each, folder)) for each in (driven.manifest, *of_ros)
        ]
        logs[name] = {"csv": driven.csv.splitlines(), "social": driven.social.splitlines()}
    if evidence.recording is not None and evidence.run.is_read:
        hashes["recording"] = of_recording(evidence.recording, evidence.options.run)
    summary["messages"] = dict(Counter(message.topic for message in evidence.messages))
    hashes["messages"] = of_messages(evidence.messages)
    # Nodes of several rovers have their turns in any order, so what they publish at a time has none.
    order = [m for m in evidence.messages if not m.topic.endswith("rover/metrics")]
    hashes["order"] = _hash("\n".join(f"{each.topic} {each.time_ns}" for each in order))
    return {"summary": summary, "hashes": hashes, "logs": logs}


def of_messages(messages: Iterable[Message]) -> dict[str, str]:
    """Returns a hash of each topic's messages and their times; of images of the times alone."""
    by_topic: dict[str, list[str]] = {}
    for message in messages:
        data = "" if message.topic.endswith("image_raw") else _hash(message.data)  # OpenGL's are its own
        by_topic.setdefault(message.topic, []).append(f"{message.time_ns} {data}")
    return {topic: _hash("\n".join(told)) for topic, told in by_topic.items()}


def _lasting(manifest: dict[str, Any], folder: Path) -> str:
    """A manifest without times of the wall clock, versions and paths of this machine."""
    leaves_out = VOLATILE | {"social_log", "recording", "params"}
    kept = {key: value for key, value in manifest.items() if key not in leaves_out}
    return json.dumps(kept, sort_keys=True).replace(f"{folder}/", "").replace(f"{ROOT}/", "")


def _hash(data: bytes | str) -> str:
    return hashlib.sha256(data.encode() if isinstance(data, str) else data).hexdigest()[:16]


def references() -> dict[str, Any]:
    """Returns all that is kept, by the names of runs."""
    kept: dict[str, Any] = json.loads(REFERENCES.read_text()) if REFERENCES.exists() else {}
    return kept


def keep(name: str, outcome: dict[str, Any]) -> None:
    """Makes that the reference of a run; several processes may do so at the same time."""
    with TABLE.open() as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        kept = references() | {name: outcome, ARITHMETIC: arithmetic()}
        write_whole(REFERENCES, json.dumps(kept, indent=1, sort_keys=True) + "\n")  # others read it


def differences(before: dict[str, Any], after: dict[str, Any], *, exact: bool) -> Iterator[str]:
    """Yields what has changed, field by field.

    Args:
        before: The reference.
        after: What the run gives now.
        exact: Whether all is to be the same; else only the numbers of the summary are looked at, which
            may be off by RELATIVE or ABSOLUTE, whichever is more.
    """
    one, other = dict(flat(before)), dict(flat(after))
    for place in sorted(one.keys() | other.keys(), reverse=True):  # the summary first
        a, b = one.get(place), other.get(place)
        if a == b or not (exact or (place.startswith("summary") and not _near(a, b))):
            continue
        if place.startswith("logs"):  # by row: the header tells the column
            header = one.get(place.rpartition("/")[0] + "/0", "")
            yield f"{place}: {first_difference(*(f'{header}{chr(10)}{row}' for row in (a, b)))}"
        else:
            yield f"{place}: {a} became {b}"


def _near(one: Any, other: Any) -> bool:  # noqa: ANN401 - any JSON value
    try:
        return bool(np.allclose(one, other, rtol=RELATIVE, atol=ABSOLUTE))
    except (TypeError, ValueError):  # no numbers, or not as many
        return False
