// Measurements beside the difference: cuts along section planes, breaks between faces, and the legend of an inspection.
import { count, element, number, table } from "./dom.js";

const shownRows = 20;
const grades = { gap: "a gap", G0: "a corner (G0)", G1: "equal tangents but different curvatures (G1)" };
const triple = (values) => values.map(number).join(", ");
const rest = (list) => (list.length > shownRows ? element("p", { class: "facts" }, `… and ${number(list.length - shownRows)} more in the JSON`) : null);

export const sectionTables = (sections) =>
  !sections?.length ? null : element("section", { class: "truth" }, element("h2", {}, "Sections"),
    table("Areas of the cuts", ["Plane, normal", "area, mm²", "error, mm²", "area of the mesh, mm²"], sections.map((cut) => [`${triple(cut.point)}; ${triple(cut.normal)}`, cut.area_mm2 === null ? "no closed solid" : number(cut.area_mm2), number(cut.area_error_mm2), number(cut.mesh_area_mm2)])),
    sections.some((cut) => cut.solids.length > 1) ? table("Areas by solid", ["Solid", "area, mm²"], sections.flatMap((cut) => cut.solids).slice(0, shownRows).map((solid) => [solid.name, number(solid.area_mm2)])) : null,
    sections.some((cut) => cut.open_faces > 0) ? element("p", { class: "facts" }, "Faces that belong to no closed solid are cut, but have no cap.") : null);

const sides = (edge) => edge.faces.map((face) => face.name || face.entity || `face ${face.id}`).join(" and ");

export const continuityTables = (continuity) => {
  if (!continuity) return null;
  const lists = Object.entries(continuity.worst).filter(([, edges]) => edges.length > 0);
  return element("section", { class: "truth" }, element("h2", {}, "Breaks between faces"),
    element("p", { class: "facts" }, Object.entries(continuity.counts).map(([grade, found]) => `${grade}: ${count(found, "edge")}`).join(" · ")),
    lists.map(([grade, edges]) => element("div", {}, element("h3", {}, `Edges with ${grades[grade] || grade}, worst first`),
      table(`Edges: ${grade}`, ["Between", "gap, mm", "angle, °", "curvature jump, 1/mm"], edges.slice(0, shownRows).map((edge) => [sides(edge), number(edge.gap_mm), number(edge.angle_deg), number(edge.curvature_jump)])), rest(edges))));
};

// The picture of the scale, and the same information as text.
export const inspectionLegend = (view, source) => {
  const inspection = view.inspection?.direct ?? view.inspection;
  if (!inspection?.shade) return null;
  const words = [inspection.quantity && `${inspection.quantity}${inspection.unit ? `, ${inspection.unit}` : ""}`, inspection.values?.count > 0 && `${number(inspection.values.min)} to ${number(inspection.values.max)}`,
    ...(inspection.classes || []).map((one) => `${one.name}: ${number(one.pixels)} pixels`)].filter(Boolean).join("; ");
  const canvas = element("canvas", { class: "inspection-legend", role: "img", "aria-label": `Legend of ${inspection.shade}: ${words}` });
  const draw = async () => {
    const picture = await createImageBitmap(await source.blob(view, "legend"));
    Object.assign(canvas, { width: picture.width, height: picture.height });
    canvas.getContext("2d").drawImage(picture, 0, 0);
  };
  const has = source.roles(view).includes("legend");
  if (has) draw().catch(() => canvas.remove());
  return element("figure", { class: "inspection" }, has ? canvas : null, element("figcaption", {}, element("b", {}, inspection.shade), element("span", {}, words), inspection.note ? element("span", {}, inspection.note) : null));
};
