// The printed page shows every view with its three pictures side by side and its worst faces. It is prepared while the
// page is idle, because a browser does not wait before it prints. It is hidden on the screen.
import { candidatesOf } from "./candidates.js";
import { element, number, table } from "./dom.js";
import { heatMap, usualRange } from "./heat_map.js";
import { cameraText, certaintyTable, differenceTables } from "./numbers.js";
import { Pixels } from "./pixels.js";
import { timing } from "./timing.js";

const worst = 25;

const picture = (title, canvas, of) => {
  const shown = element("canvas", { width: of.width, height: of.height, role: "img", "aria-label": title });
  shown.getContext("2d").drawImage(canvas, 0, 0);
  return element("figure", {}, shown, element("figcaption", {}, element("b", {}, title)));
};

const worstFaces = (view, { title, difference }, several) => {
  const head = several ? `Worst faces, ${title.toLowerCase()}` : "Worst faces";
  return difference.faces.length === 0 ? null : table(`${head} of ${view.name}`, [head, "deviation max, mm", "mean, mm", "normal max, °", "pixels", "missed"],
    difference.faces.slice(0, worst).map((face) => [face.name || `face ${face.id}`, number(face.deviation_mm_max), number(face.deviation_mm_mean), number(face.normal_deg_max), number(face.pixels), number(face.missed_pixels)]));
};

export const printView = async (report, view, source) => {
  const roles = source.roles(view), candidates = candidatesOf(view), several = candidates.length > 1, figures = [];
  for (const [role, title] of [["direct", "Direct"], ...candidates.map((candidate) => [candidate.name, candidate.title])]) {
    if (!roles.includes(role)) continue;
    const bitmap = await createImageBitmap(await source.blob(view, role));
    figures.push(picture(title, bitmap, bitmap));
    bitmap.close();
  }
  for (const candidate of candidates) {
    if (!view.pixel_data || !roles.includes(candidate.planeOf("pixel-deviation"))) continue;
    const range = usualRange(candidate.difference), heat = heatMap(await Pixels.load(view, (role) => source.blob(view, candidate.planeOf(role))), range);
    figures.push(picture(`Difference${several ? `, ${candidate.title.toLowerCase()}` : ""}, −${number(range)} (blue) to +${number(range)} mm (red)`, heat, heat));
  }
  return element("section", { class: "print-only view" }, element("h2", {}, view.name), element("p", { class: "facts" }, cameraText(view.camera)), element("div", { class: `stage of-${figures.length}` }, figures),
    candidates.map((candidate) => worstFaces(view, candidate, several)),
    element("div", { class: "tables" }, timing(report, view), candidates.map((candidate) => differenceTables(candidate.difference, candidate.noun)), certaintyTable(view.direct)));
};
