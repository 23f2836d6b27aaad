// Shows the time of each stage: a bar for each tracer, all on one scale, and the same as numbers.
import { candidatesOf } from "./candidates.js";
import { bytes, count, element, milliseconds, number, table } from "./dom.js";

const stageNames = { mesh: "mesh", build: "build", make: "make", prepare: "prepare", trace: "trace", color: "colour samples", shade: "shade", difference: "difference", files: "files", import: "import", load: "load", scene: "scene" };

// `rows` are [label, { stage: ms }]. A stage that took no time is omitted.
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

const stagesOf = ({ timing_ms: { mesh, build, make, prepare, trace, color, shade } }) => ({ mesh, build, make, prepare, trace, color, shade });
// Returns the size of a candidate in its own units, such as triangles.
const sizeOf = ({ triangles, facts }) => (triangles !== undefined ? count(triangles, "triangle") : Object.entries(facts || {}).map(([name, value]) => `${number(value)} ${name.replaceAll("_", " ")}`).join(", ") || "–");

// Work that all tracers share has rows of its own. Older reports may lack them.
export const timing = (report, view) => {
  const direct = view.direct, candidates = candidatesOf(view), costs = candidates.map((candidate) => candidate.costs), dt = direct.timing_ms;
  // If the answer already existed, report.kept has the times of the run that computed it.
  const shared = report.kept?.timing_ms ?? report.timing_ms;
  const row = (title, own, of) => [title, own, ...costs.map(of)];
  const rows = [row("Mesh", "–", ({ timing_ms: t }) => milliseconds(t.mesh)), row("Prepare; build", milliseconds(dt.prepare), ({ timing_ms: t }) => milliseconds(t.build ?? (t.make ?? 0) + (t.prepare ?? 0))),
    ...["trace", "color", "shade", "total"].map((stage) => row({ trace: "Trace", color: "Colour samples", shade: "Shade", total: "Total" }[stage], milliseconds(dt[stage]), ({ timing_ms: t }) => milliseconds(t[stage]))),
    row("Memory", bytes(direct.peak_bytes), (one) => bytes(one.peak_bytes)), row("Size", `${number(direct.leaves)} leaves`, sizeOf)];
  const together = { ...view.timing_ms };
  for (const { timing_ms: t } of view.candidates || []) together.difference = (together.difference ?? 0) + t.difference;
  return element("section", { class: "cost" }, element("h3", {}, "Time and memory"),
    timeBars([["Import", { import: report.model.import_ms, load: shared?.load, scene: shared?.scene }], ["Direct", stagesOf(direct)], ...candidates.map((candidate) => [candidate.title, stagesOf(candidate.costs)]), view.timing_ms && [candidates.length > 1 ? "All" : "Both", together]].filter(Boolean)),
    table("Time and memory", ["", "direct", ...candidates.map((candidate) => candidate.title.toLowerCase())], view.baseline ? rows : rows.slice(1)));
};
