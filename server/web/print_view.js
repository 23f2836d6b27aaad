// On paper there is nothing to press: every view with its three pictures beside each other and its worst faces. Made while the
// page is idle, since a browser that prints waits for nothing; hidden on the screen.
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

export const printView = async (report, view, source) => {
  const roles = source.roles(view), range = view.difference && usualRange(view.difference), figures = [];
  for (const [role, title] of [["direct", "Direct"], ["baseline", "Baseline"]]) {
    if (!roles.includes(role)) continue;
    const bitmap = await createImageBitmap(await source.blob(view, role));
    figures.push(picture(title, bitmap, bitmap));
    bitmap.close();
  }
  if (view.pixel_data && roles.includes("pixel-faces")) {
    const heat = heatMap(await Pixels.load(view, (role) => source.blob(view, role)), range);
    figures.push(picture(`Difference, −${number(range)} (blue) to +${number(range)} mm (red)`, heat, heat));
  }
  const faces = view.difference?.faces || [];
  return element("section", { class: "print-only view" }, element("h2", {}, view.name), element("p", { class: "facts" }, cameraText(view.camera)), element("div", { class: `stage of-${figures.length}` }, figures),
    faces.length ? table(`Worst faces of ${view.name}`, ["Worst faces", "deviation max, mm", "mean, mm", "normal max, °", "pixels", "missed"],
      faces.slice(0, worst).map((face) => [face.name || `face ${face.id}`, number(face.deviation_mm_max), number(face.deviation_mm_mean), number(face.normal_deg_max), number(face.pixels), number(face.missed_pixels)])) : null,
    element("div", { class: "tables" }, timing(report, view), view.difference ? differenceTables(view.difference) : null, certaintyTable(view.direct)));
};
