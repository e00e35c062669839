// Time axes move together, and the map follows the pointer; plots.js, which comes first, draws.

const map = document.getElementById("map");
const series = plots.filter((plot) => plot !== map);

let moving = false; // while one plot's range is taken over to others, theirs must not come back

async function move(plots, update) {
  if (moving) return;
  moving = true;
  try {
    await Promise.all(plots.map((plot) => Plotly.relayout(plot, update(plot))));
  } finally {
    moving = false;
  }
}

const wholeRun = (plot) => ({ "xaxis.range": [...figures[plot.id].layout.xaxis.range] });

/** Takes a time range over to all other time series. */
function follow(changed, update) {
  const others = series.filter((plot) => plot !== changed);
  if (update["xaxis.autorange"]) {
    move(series, wholeRun);
  } else if ("xaxis.range" in update || "xaxis.range[0]" in update) {
    const range = changed.layout.xaxis.range;
    move(others, () => ({ "xaxis.range": [...range] }));
  }
}

/** Points at where the rover was at a time [s]. */
function point(time) {
  const path = figures.map.data.find((trace) => trace.customdata);
  if (!path) return;
  const apart = path.customdata.map((details) => Math.abs(details[0] - time));
  const index = apart.indexOf(Math.min(...apart));
  const style = getComputedStyle(document.documentElement);
  const color = style.getPropertyValue("--ink").trim();
  const note = {
    x: path.x[index], y: path.y[index], text: `${path.customdata[index][0].toFixed(1)} s`,
    font: { color }, arrowcolor: color, bgcolor: style.getPropertyValue("--panel").trim(),
  };
  Plotly.relayout(map, { annotations: [note] });
}

const view = (layout) => Plotly.relayout(map, { "xaxis.range": layout[0], "yaxis.range": layout[1] });

start(() => {
  const { xaxis, yaxis, images } = figures.map.layout;
  const [ground] = images;
  const whole = [[ground.x, ground.x + ground.sizex], [ground.y - ground.sizey, ground.y]];
  document.getElementById("view-path").onclick = () => view([[...xaxis.range], [...yaxis.range]]);
  document.getElementById("view-map").onclick = () => view(whole);
  for (const plot of series) {
    plot.on("plotly_relayout", (update) => follow(plot, update));
    plot.on("plotly_hover", (event) => point(event.points[0].x));
    plot.on("plotly_unhover", () => Plotly.relayout(map, { annotations: [] }));
  }
  const reset = document.getElementById("reset-time");
  if (reset) {
    reset.onclick = () => move(series, (plot) => ({
      ...wholeRun(plot), ...("range" in figures[plot.id].layout.yaxis
        ? { "yaxis.range": [...figures[plot.id].layout.yaxis.range] } : { "yaxis.autorange": true }),
    }));
  }
});
