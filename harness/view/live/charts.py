"""Charts of the log's columns, as its rows are written."""

from numbers import Real

import numpy as np
import viser
from viser import uplot

from harness.view.live.watch import Watch

HEIGHT = 120  # [pixels]
INK = "#0d7f8c"
AXES = (uplot.Axis(size=28), uplot.Axis(size=66))  # room for 1,000,000
PADDING = (10, 16, 0, 0)  # [pixels]: top, right, bottom, left; half a number is above an axis
SERIES = (uplot.Series(), uplot.Series(stroke=INK, width=1.5))


class Charts:
    """A chart of each column that holds numbers, at a place of a page, once there is a number."""

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
        times, *columns = zip(*(row.as_fields() for row in rows), strict=True)
        drawn = set()
        for place, (name, cells) in enumerate(zip(rows[0].columns[1:], columns, strict=True)):
            points = [(t, c) for t, c in zip(times, cells, strict=True) if isinstance(c, Real)]
            if points:  # else it is empty so far, or text
                drawn.add(name)
                chart = self._charts.get(name) or self._chart(name, place)
                time_s, numbers = np.array(points, np.float64).T.copy()
                chart.data = time_s, numbers
        for name, chart in self._charts.items():
            chart.visible = name in drawn  # a rover with other wheels has other columns

    def _chart(self, name: str, place: int) -> viser.GuiUplotHandle:
        nothing = np.zeros(0)
        with self._place:
            self._charts[name] = chart = self._gui.add_uplot(
                (nothing, nothing),
                SERIES,
                title=name,
                scales={"x": uplot.Scale(time=False)},
                axes=AXES,
                legend=uplot.Legend(show=False),
                height=HEIGHT,
                padding=PADDING,
                order=float(place),
            )
        return chart
