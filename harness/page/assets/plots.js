"use strict";
// Draws the figures of a page, in its colours, whatever they are at present.

const figures = JSON.parse(document.getElementById("figures").textContent);
const plots = [...document.querySelectorAll(".plot")];
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
  return Promise.all(plots.map((plot) => {
    const { data, layout } = themed(figures[plot.id], style);
    const xaxis = kept(layout.xaxis, plot.layout?.xaxis);
    const yaxis = kept(layout.yaxis, plot.layout?.yaxis);
    // A finger on a plot scrolls the page until a tool is chosen.
    const dragmode = touch.matches ? false : "zoom";
    return Plotly.react(plot, data, { ...layout, xaxis, yaxis, dragmode }, config);
  }));
}

/** Draws all plots, then makes the page ready, and draws again whenever the system's colours change. */
function start(makeReady) {
  draw().then(() => {
    makeReady();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
    document.documentElement.dataset.drawn = "yes";
  });
}
