"""The sections of the page, in its order."""

from collections.abc import Callable, Iterator, Sequence

from harness.page.figure import Plot
from harness.tuning.page import event_figures, scan_figures, tables
from harness.tuning.page.distance_figure import steps_and_jumps
from harness.tuning.page.episodes import Subject
from harness.tuning.page.ground_figures import distributions, ground_roc
from harness.tuning.page.layout import Cell, Row, Section, Table
from harness.tuning.page.rover.figure import drawings
from harness.tuning.scoring.ground import GroundStudy
from harness.tuning.scoring.imu_events import SIGNALS, Signal
from harness.tuning.scoring.notes import unreachable
from harness.tuning.scoring.result import Verdict

Show = Callable[[Subject], Plot | Table | str]
Subjects = Sequence[Subject]


def sections(subjects: Subjects) -> Iterator[Section]:
    """All of them."""
    yield _drawings(subjects)
    yield _contacts(subjects)
    yield _clearance(subjects)
    for signal in SIGNALS:
        yield _ground(subjects, signal)
    yield _distance(subjects)


def row(heading: str, caption: str, subjects: Subjects, show: Show, *, wide: bool = False) -> Row:
    """One matter for all robots."""
    cells = tuple(Cell(subject.robot, show(subject)) for subject in subjects)
    return Row(heading, caption, cells, wide)


def _scores(subjects: Subjects, verdict: Callable[[Subject], Verdict]) -> Row:
    """All measures of a threshold."""
    cells = tuple(Cell(subject.robot, tables.measures(verdict(subject))) for subject in subjects)
    return Row("All scores", "", cells, wide=True, folded=True)


def _drawings(subjects: Subjects) -> Section:
    picture = Row(
        "",
        "All to one scale. The lidar measures from itself, not from the outline: where a hatched strip "
        "runs beside the footprint, a touched point is farther from the lidar than the threshold or "
        "nearer than range_min, and no alarm comes from it.",
        drawings([subject.study for subject in subjects]),
    )
    return Section("geometry", "What the lidar can tell", "", (picture,))


def _contacts(subjects: Subjects) -> Section:
    blind = Row(
        "Contacts by side",
        "How many contacts of the checking episodes each detector tells. What the lidar never saw is "
        "counted against none of them and has lines of its own.",
        tuple(
            Cell(
                subject.robot,
                tables.zones(subject.study.collision),
                unreachable(subject.study.collision),
            )
            for subject in subjects
        ),
        wide=True,
    )
    return Section(
        "contacts",
        "Contacts: collision_threshold",
        "A collision is counted where the nearest range is below the threshold. Beside it stands what "
        "else metrics_node can compare: the distance to the footprint, and near returns (REP-117: "
        "\N{MINUS SIGN}inf) as contact.",
        (
            row(
                "F1 of alarms and contacts",
                "Of the nearest range, over the threshold.",
                subjects,
                event_figures.f1_over_threshold,
            ),
            row(
                "Precision of alarms, recall of contacts",
                "What F1 is made of.",
                subjects,
                event_figures.parts_over_threshold,
            ),
            row(
                "What a detector costs",
                "Checking episodes: the highest recall of any threshold with at most so many false "
                "alarms.",
                subjects,
                event_figures.trade_off,
            ),
            row(
                "Detectors",
                "Each at its best value on the choosing episodes, scored on the checking ones. Lead is "
                "the time from the alarm to the contact.",
                subjects,
                lambda subject: tables.detectors(subject.study.collision),
                wide=True,
            ),
            blind,
            row("ROC of single scans", "Checking episodes.", subjects, scan_figures.scan_roc),
            row(
                "Precision and recall of single scans",
                "Checking episodes. Contact is rare, so most scans near something are not contact.",
                subjects,
                scan_figures.scan_precision_recall,
            ),
        ),
    )


def _clearance(subjects: Subjects) -> Section:
    return Section(
        "clearance",
        "Stopping: min_safe_clearance",
        "The nearest range at which the rover at top speed can still stop before it touches.",
        (
            row("The sum", "", subjects, lambda subject: tables.clearance(subject.study)),
            row(
                "Checked against contacts",
                "Recall: head-on contacts that the lidar saw with a warning in time to stop. Precision: "
                "warnings that a contact followed.",
                subjects,
                lambda subject: tables.measures(subject.study.clearance.verdict),
                wide=True,
            ),
        ),
    )


def _ground(subjects: Subjects, signal: Signal) -> Section:
    def study(subject: Subject) -> GroundStudy:
        return next(one for one in subject.study.grounds if one.verdict.name == signal.parameter)

    return Section(
        signal.parameter,
        f"Ground: {signal.parameter}",
        f"What is compared with it: {signal.what}.",
        (
            row(
                "Smooth and rough ground",
                "Checking episodes; the last step holds the largest 1 %.",
                subjects,
                lambda subject: distributions(subject, study(subject), signal),
            ),
            row(
                "ROC",
                "Checking episodes.",
                subjects,
                lambda subject: ground_roc(subject, study(subject), signal),
            ),
            _scores(subjects, lambda subject: study(subject).verdict),
            row(
                "At other speeds",
                "Over all episodes: the value with the highest balanced accuracy at each speed.",
                subjects,
                lambda subject: tables.speeds(study(subject)),
            ),
        ),
    )


def _distance(subjects: Subjects) -> Section:
    return Section(
        "distance",
        "Steps: distance_threshold",
        "Longer than any step of the rover between two poses, shorter than the jump when a simulation "
        "is reset to its start.",
        (
            row("Steps and jumps", "Checking episodes.", subjects, steps_and_jumps),
            _scores(subjects, lambda subject: subject.study.distance.verdict),
        ),
    )
