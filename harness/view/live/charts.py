"""Charts of the log's columns, as its rows are written."""

from numbers import Real

import numpy as np
import viser
from viser import uplot

from harness.view.live.watch import Watch

HEIGHT = 120  # [pixels]
INK = "#0d7f8c"
AXES = (uplot.Axis(size=28), uplot.Axis(size=46))
SERIES = (uplot.Series(), uplot.Series(stroke=INK, width=1.5))


class Charts:
    """A chart of each column that holds numbers, at a place of a page, once there is a row."""

    def __init__(self, gui: viser.GuiApi, place: viser.GuiTabHandle) -> None:
        self._gui, self._place = gui, place
        self._charts: dict[str, viser.GuiUplotHandle] = {}
        self._shown: tuple[object, int] = (None, 0)

    def show(self, watch: Watch) -> None:
        """Shows the rows of a rover's log, if there are others than before."""
        rows = watch.rows.copy()
        if not rows or self._shown == (watch, len(rows)):
            return
        self._shown = watch, len(rows)
        columns = dict(
            zip(rows[0].columns, zip(*(row.as_fields() for row in rows), strict=True), strict=True)
        )
        numbers = {
            name: np.array(values, np.float64)
            for name, values in columns.items()
            if all(isinstance(value, Real) for value in values)
        }
        time_s, *others = numbers
        if not self._charts:
            self._charts = {name: self._chart(name) for name in others}
        for name, chart in self._charts.items():
            if name in numbers:
                chart.data = numbers[time_s], numbers[name]

    def _chart(self, name: str) -> viser.GuiUplotHandle:
        nothing = np.zeros(0)
        with self._place:
            return self._gui.add_uplot(
                (nothing, nothing),
                SERIES,
                title=name,
                scales={"x": uplot.Scale(time=False)},
                axes=AXES,
                legend=uplot.Legend(show=False),
                height=HEIGHT,
            )
