// The truth report: the contents of the file, and before them its losses.
import { count, element, given, milliseconds, number, scrolling, table } from "./dom.js";

const shownLosses = 200;
const nameOf = (loss) => [loss.name, loss.entity].filter(Boolean).join(" ") || "unnamed";

const lossList = (what, losses) =>
  losses.length === 0 ? null : element("div", {}, element("h3", {}, count(losses.length, what)),
    scrolling(`${what}s`, element("table", {}, element("tbody", {}, losses.slice(0, shownLosses).map((loss) => element("tr", {}, element("th", { class: "name", scope: "row" }, nameOf(loss)), element("td", { class: "name" }, loss.reason || "")))))),
    losses.length > shownLosses ? element("p", { class: "facts" }, `… and ${number(losses.length - shownLosses)} more in the JSON`) : null);

const lossKinds = [["lost face", "faces_skipped"], ["lost loop", "loops_lost"], ["lost edge", "edges_lost"]];

export const lostCount = (model) => lossKinds.reduce((sum, [, key]) => sum + (model[key] || []).length, 0);

export const lossNotice = (model) =>
  lostCount(model) === 0 ? null : element("section", { class: "notice" }, element("h2", {}, "Not everything in the file could be read"),
    element("p", {}, "The items listed here are missing from all pictures and numbers below. Repair them in the program that made the file, or export the file again."),
    lossKinds.map(([what, key]) => lossList(what, model[key] || [])));

const problemNotice = (verdict) =>
  !(verdict?.problems?.length) ? null : element("section", { class: "notice" }, element("h2", {}, "This run failed"), verdict.problems.map((problem) => element("p", {}, problem)));

export const verdictNotice = (verdict) => [problemNotice(verdict), thresholdNotice(verdict)];

const thresholdNotice = (verdict) =>
  !verdict || (verdict.broken || []).length === 0 ? null : element("section", { class: "notice" }, element("h2", {}, "Thresholds are exceeded"),
    table("Exceeded thresholds", ["View and threshold", "limit", "value"], verdict.broken.map((b) => [`${b.view}: ${b.threshold.replace("fail_", "")}`, number(b.limit), b.value === null ? "infinite" : number(b.value)])));

export const modelFacts = (model) =>
  element("p", { class: "facts row" }, [model.format, model.unit && `in ${model.unit}`, count(model.faces, "face"), model.solids && count(model.solids, "solid"), model.patches && `${number(model.patches)} Bézier patches`,
    `${number(model.diagonal_mm)} mm across`, `read in ${milliseconds(model.import_ms)}`].filter(Boolean).map((fact) => element("span", {}, fact)));

const healedBodies = (bodies) =>
  bodies.length === 0 ? null : element("div", {}, element("h3", {}, bodies.length === 1 ? "1 healed body" : `${bodies.length} healed bodies`),
    table("Healed bodies", ["Body", "reason", "faces, edges and p-curves changed", "moved, mm"], bodies.slice(0, 20).map((body) => [[body.name, body.entity].filter(Boolean).join(", from "), body.reason,
      [body.faces_changed, body.edges_changed, body.pcurves_changed].map(number).join(", "), number(body.moved_mm)])),
    bodies.length > 20 ? element("p", { class: "facts" }, "The JSON lists the others.") : null);

const openEdges = ({ count: found, worst }) =>
  found === 0 ? null : element("div", {}, element("h3", {}, count(found, "open edge")),
    table("Open edges", ["Between", "cause", "gap, mm", "tolerance, mm", "length, mm"], worst.slice(0, 20).map((edge) => [edge.faces.map((face) => face.name || face.entity || `face ${face.id}`).join(" and "), edge.cause.replace("_", " "), number(edge.gap_mm), number(edge.tolerance_mm), number(edge.length_mm)])),
    found > 20 ? element("p", { class: "facts" }, "The JSON lists the others.") : null);

export const truthReport = (model) => {
  const surfaces = Object.entries(model.surfaces || {}).filter(([, faces]) => faces > 0);
  const approximated = model.faces_approximated || [];
  return element("section", { class: "truth" }, element("h2", {}, "What the file holds"),
    element("div", { class: "tables" },
      element("div", {}, table("What the file holds", null, [["Faces declared", number(model.faces_declared)], ["Faces lost", number((model.faces_skipped || []).length)], ["Loops lost", number((model.loops_lost || []).length)],
        ["Edges lost", number((model.edges_lost || []).length)], ["Open edges", number(model.open_edges?.count)], ["Widest gap at an edge", given(model.edge_gap_mm_max) ? `${number(model.edge_gap_mm_max)} mm` : "–"],
        ["Faces approximated", number(approximated.length)], ["Parts, placements", `${number(model.prototypes?.parts)}, ${number(model.placements)}`]])),
      surfaces.length ? element("div", {}, table("Kinds of surfaces", ["Surface", "surfaces"], surfaces.map(([kind, faces]) => [kind, number(faces)]))) : null,
      approximated.length ? element("div", {}, table("Approximated faces", ["Approximated face", "deviation, mm"], approximated.slice(0, 20).map((face) => [face.name, number(face.deviation_mm)]))) : null),
    model.open_edges ? openEdges(model.open_edges) : null,
    healedBodies(model.bodies_healed || []),
    (model.warnings || []).length ? element("details", {}, element("summary", {}, count(model.warnings.length, "warning")), element("ul", {}, model.warnings.slice(0, 100).map((warning) => element("li", {}, warning)))) : null);
};
