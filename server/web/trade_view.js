// One view of `facetless trade`: the answers, both plots, and a table of all points.
import { bytes, choice, element, milliseconds, number, scrolling } from "./dom.js";
import { cameraText } from "./numbers.js";
import { memoryCost, timeCost, tradePlot } from "./plot.js";

const measures = { "mean": (point) => point.deviation_mm.mean_abs, "p95": (point) => point.deviation_mm.p95, "p99": (point) => point.deviation_mm.p99, "max": (point) => point.deviation_mm.max };
const heads = ["Setting", "prepare", "trace", "shade", "total", "memory", "error mean, mm", "p95", "p99", "max", "outline px (farthest)", "FLIP", "unbeaten in"];

const cellsOf = (point) => {
  if (!point.measured) return [...Array(11).fill("–"), point.skipped];
  const t = point.timing_ms;
  return [milliseconds(t.prepare), milliseconds(t.trace), milliseconds(t.shade), milliseconds(t.total), bytes(point.peak_bytes), ...Object.values(measures).map((of) => number(of(point))),
    `${number(point.silhouette.pixels)} (${number(point.silhouette.max_distance_px)})`, number(point.flip.mean), [point.pareto.time && "time", point.pareto.memory && "memory"].filter(Boolean).join(", ")];
};

export const tradeSection = (view, trade, address) => {
  const points = trade.points.filter((point) => point.view === view.name);
  const rows = new Map();
  const holder = element("div", { class: "plots" });
  let plots = [];
  const mark = (name) => rows.forEach((row, other) => row.classList.toggle("marked", other === name));
  const limit = trade.limits.error_mm ?? (trade.limits.error_px ? trade.limits.error_px * view.reference.mm_per_pixel : null);
  const draw = () => {
    const measure = measures[address.get("error")] ? address.get("error") : trade.error_measure;
    plots = [["Time against error", timeCost], ["Memory against error", memoryCost]].map(([label, cost]) => tradePlot(`${label}, view ${view.name}`, points, cost, measures[measure], view.reference.floor_mm, limit, mark));
    holder.replaceChildren(...plots.map((plot) => plot.root));
    chosen.choose(measure);
  };
  const chosen = choice("Error that the plots show", Object.keys(measures), (measure) => { address.set({ error: measure === trade.error_measure ? null : measure }); draw(); });
  for (const point of points) {
    rows.set(point.name, element("tr", { on: { pointerenter: () => plots.forEach((plot) => plot.mark(point.name)), pointerleave: () => plots.forEach((plot) => plot.mark(null)) } },
      element("th", { scope: "row" }, point.name), cellsOf(point).map((cell) => element("td", { class: "n" }, cell))));
  }
  draw();
  const root = element("section", { class: "view" },
    element("div", { class: "bar" }, element("h2", {}, view.name), element("span", { class: "facts" }, cameraText(view.camera)), chosen.root),
    element("ul", { class: "answers" }, view.sentences.map((sentence) => element("li", {}, sentence))),
    holder, element("h3", {}, "All points"),
    scrolling("All points", element("table", {}, element("thead", {}, element("tr", {}, heads.map((head, i) => element("th", { scope: "col", class: i > 0 ? "n" : undefined }, head)))), element("tbody", {}, [...rows.values()]))),
    element("p", { class: "facts" }, `Errors are distances to the exact surface at the same ${number(view.reference.hits)} hits, which the direct renderer has certified. Times are for one sample per pixel; short runs are repeated up to ${number(Math.max(...points.map((p) => p.repetitions || 1)))} times, and the median counts. ` +
      `“prepare” is meshing and building its tree, or making patches, trimming and leaves. No time includes reading the file (${milliseconds(trade.shared_ms.read + trade.shared_ms.transfer)}). Meshing runs on one thread.` + (trade.load_at_start > 1.5 ? ` The machine was doing other work, too: its load was ${number(trade.load_at_start)}.` : "")));
  return { root, follow: draw };
};
