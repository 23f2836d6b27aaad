// The faces of a view, the worst first. A click selects a face, and the row of the face under the pointer is marked.
import { count, element, number, scrolling } from "./dom.js";

const shownAtFirst = 100;

export const faceTable = (difference, chosen, hovered) => {
  const rows = new Map();
  const body = element("tbody", {});
  let marked = null, pressed = null, filter = "", all = false;
  const more = element("button", { type: "button", class: "small", on: { click: () => { all = true; fill(); } } });
  // Deviations below the noise of the mesh's positions are not significant.
  const length = (mm) => element("td", { class: mm <= difference.noise_mm ? "n below" : "n" }, number(mm));
  const row = (face, rank) => {
    const button = element("button", { type: "button", class: "face-name", "aria-pressed": "false", on: { click: () => chosen(face.id) } }, face.name || `face ${face.id}`);
    const made = element("tr", { on: { click: (event) => { if (event.target !== button) chosen(face.id); }, pointerenter: () => hovered(face.id), pointerleave: () => hovered(null) } },
      element("td", { class: "rank" }, String(rank)), element("th", { scope: "row" }, button), length(face.deviation_mm_max), length(face.deviation_mm_mean),
      element("td", { class: "n" }, number(face.normal_deg_max)), element("td", { class: "n" }, number(face.pixels)), element("td", { class: face.missed_pixels > 0 ? "n warn" : "n" }, number(face.missed_pixels)));
    return { made, button };
  };
  const fill = () => {
    const matching = difference.faces.map((face, i) => [face, i + 1]).filter(([face]) => (face.name || "").toLowerCase().includes(filter));
    const shown = all ? matching : matching.slice(0, shownAtFirst);
    rows.clear();
    for (const [face, rank] of shown) rows.set(face.id, row(face, rank));
    body.replaceChildren(...[...rows.values()].map(({ made }) => made));
    more.hidden = shown.length === matching.length;
    more.textContent = `Show all ${number(matching.length)}`;
    press(pressed);
  };
  const press = (id) => {
    rows.get(pressed)?.made.classList.remove("pressed");
    rows.get(pressed)?.button.setAttribute("aria-pressed", "false");
    pressed = id;
    rows.get(pressed)?.made.classList.add("pressed");
    rows.get(pressed)?.button.setAttribute("aria-pressed", "true");
  };
  // Scrolls the list, but never the page.
  const reveal = (id) => {
    const found = rows.get(id)?.made, holder = found?.closest(".scroll");
    if (!found || !holder) return;
    const top = found.offsetTop - holder.querySelector("thead").offsetHeight, bottom = found.offsetTop + found.offsetHeight;
    if (top < holder.scrollTop) holder.scrollTop = top;
    else if (bottom > holder.scrollTop + holder.clientHeight) holder.scrollTop = bottom - holder.clientHeight;
  };
  const mark = (id) => {
    if (marked === id) return;
    rows.get(marked)?.made.classList.remove("marked");
    marked = id;
    rows.get(marked)?.made.classList.add("marked");
    if (id !== null) reveal(id);
  };
  const search = element("input", { type: "search", placeholder: "Name", "aria-label": "Only faces whose name contains", on: { input: (event) => { filter = event.target.value.toLowerCase(); fill(); } } });
  const heads = [["", "rank"], ["Face", ""], ["deviation max, mm", "n"], ["mean, mm", "n"], ["normal max, °", "n"], ["pixels", "n"], ["missed", "n"]];
  const root = element("section", { class: "faces" },
    element("div", { class: "bar" }, element("h3", {}, "Faces, worst first"), element("span", { class: "facts" }, `${count(difference.face_count, "face")} in this view`), search),
    scrolling("Faces, worst first", element("table", {}, element("thead", {}, element("tr", {}, heads.map(([text, kind]) => (text ? element("th", { scope: "col", class: kind }, text) : element("td", {}))))), body)),
    more,
    difference.face_count > difference.faces.length ? element("p", { class: "facts" }, `The ${number(difference.faces.length)} worst are listed.`) : null);
  fill();
  const name = (id) => difference.faces.find((face) => face.id === id)?.name || `face ${id}`;
  return { root, mark, press, reveal, name, has: (id) => difference.faces.some((face) => face.id === id) };
};
