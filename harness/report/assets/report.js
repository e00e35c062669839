"use strict";
// Draws the figures, in the colours of the page; time axes move together, and the map follows the pointer.

const figures = JSON.parse(document.getElementById("figures").textContent);
const map = document.getElementById("map");
const series = [...document.querySelectorAll(".plot")].filter((plot) => plot !== map);
const touch = matchMedia("(pointer: coarse)");
const config = {
  responsive: true,
  displaylogo: false,
  displayModeBar: touch.matches ? true : "hover",
  plotlyServerURL: "",
  // All that there are: none that would upload the plot.
  modeBarButtons: [["toImage"], ["zoom2d", "pan2d"], ["zoomIn2d", "zoomOut2d", "resetScale2d"]],
};

/** A copy of a JSON value with "--name" replaced by the style sheet's custom property of that name. */
function themed(value, style) {
  if (typeof value === "string") return value.startsWith("--") ? style.getPropertyValue(value).trim() : value;
  if (Array.isArray(value)) return value.map((v) => themed(v, style));
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).map(([key, v]) => [key, themed(v, style)]));
}

/** An axis with the range that it shows at present. */
const kept = (axis, shown) => ({ ...axis, ...(shown && { range: shown.range, autorange: shown.autorange }) });

function draw() {
  const style = getComputedStyle(document.documentElement);
  return Promise.all([map, ...series].map((plot) => {
    const { data, layout } = themed(figures[plot.id], style);
    const xaxis = kept(layout.xaxis, plot.layout?.xaxis);
    const yaxis = kept(layout.yaxis, plot.layout?.yaxis);
    // A finger on a plot scrolls the page until a tool is chosen.
    const dragmode = touch.matches ? false : "zoom";
    return Plotly.react(plot, data, { ...layout, xaxis, yaxis, dragmode }, config);
  }));
}

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

draw().then(() => {
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
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  document.documentElement.dataset.drawn = "yes";
});
