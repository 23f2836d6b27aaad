// Where the time went: a bar for each tracer, one scale for all, and the same as numbers.
import { bytes, count, element, milliseconds, number, table } from "./dom.js";

const stageNames = { mesh: "mesh", build: "build", prepare: "prepare", trace: "trace", color: "colour samples", shade: "shade", difference: "difference", files: "files", import: "import", load: "load", scene: "scene" };

// `rows` are [label, { stage: ms }]. A stage that took no time is left out.
export const timeBars = (rows) => {
  const total = (stages) => Object.values(stages).reduce((sum, ms) => sum + (ms || 0), 0);
  const longest = Math.max(...rows.map(([, stages]) => total(stages)), 1e-6);
  const used = Object.keys(stageNames).filter((stage) => rows.some(([, stages]) => stages[stage] > 0));
  return element("div", { class: "times" },
    rows.map(([label, stages]) => {
      const bar = element("div", { class: "time-bar", role: "img", "aria-label": `${label}: ${Object.entries(stages).filter(([, ms]) => ms > 0).map(([stage, ms]) => `${stageNames[stage]} ${milliseconds(ms)}`).join(", ")}` });
      for (const stage of used) {
        if (!(stages[stage] > 0)) continue;
        const piece = element("span", { class: `piece ${stage}`, title: `${stageNames[stage]}: ${milliseconds(stages[stage])}` });
        piece.style.width = `${stages[stage] / longest * 100}%`;
        bar.append(piece);
      }
      return element("div", { class: "time-row" }, element("span", { class: "time-label" }, label), bar, element("span", { class: "time-total" }, milliseconds(total(stages))));
    }),
    element("div", { class: "keys" }, used.map((stage) => element("span", { class: "key" }, element("span", { class: `swatch piece ${stage}`, "aria-hidden": "true" }), stageNames[stage]))));
};

const stagesOf = ({ timing_ms: { mesh, build, prepare, trace, color, shade } }) => ({ mesh, build, prepare, trace, color, shade });

// What both tracers share has rows of its own; reports of before may lack them.
export const timing = (report, view) => {
  const direct = view.direct, baseline = view.baseline, dt = direct.timing_ms, bt = baseline?.timing_ms || {};
  // Of an answer that was there already, what the work took once stands apart.
  const shared = report.kept?.timing_ms ?? report.timing_ms;
  const rows = [["Mesh", "–", milliseconds(bt.mesh)], ["Prepare; build", milliseconds(dt.prepare), milliseconds(bt.build)], ["Trace", milliseconds(dt.trace), milliseconds(bt.trace)],
    ["Colour samples", milliseconds(dt.color), milliseconds(bt.color)], ["Shade", milliseconds(dt.shade), milliseconds(bt.shade)], ["Total", milliseconds(dt.total), milliseconds(bt.total)],
    ["Memory", bytes(direct.peak_bytes), bytes(baseline?.peak_bytes)],
    ["Size", `${number(direct.leaves)} leaves`, baseline ? count(baseline.triangles, "triangle") : "–"]];
  return element("section", { class: "cost" }, element("h3", {}, "Time and memory"),
    timeBars([["Import", { import: report.model.import_ms, load: shared?.load, scene: shared?.scene }], ["Direct", stagesOf(direct)], baseline && ["Baseline", stagesOf(baseline)], view.timing_ms && ["Both", view.timing_ms]].filter(Boolean)),
    table("Time and memory", ["", "direct", "baseline"].slice(0, baseline ? 3 : 2), (baseline ? rows : rows.slice(1)).map((row) => row.slice(0, baseline ? 3 : 2))));
};
