// Shows a report. Used by the page of the service and by report.html; it fetches nothing by itself.
//   showReport(root, report, pictureOf)    pictureOf(view, role) is the address of a picture, or undefined
"use strict";

const element = (tag, attributes = {}, ...children) => {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "on") Object.entries(value).forEach(([event, handler]) => made.addEventListener(event, handler));
    else if (value !== undefined && value !== false) made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
};

// Three significant digits, in powers of ten where zeros would hide them.
const number = (value) => {
  if (value === null || value === undefined) return "–";
  if (typeof value !== "number") return String(value);
  if (value === 0 || Number.isInteger(value)) return value.toLocaleString("en");
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e7) {
    const [digits, power] = value.toExponential(2).split("e");
    return `${digits} × 10${[...String(Number(power))].map((c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]).join("")}`;
  }
  return value.toLocaleString("en", { maximumSignificantDigits: size >= 100 ? 4 : 3 });
};
const bytes = (value) => {
  if (value === null || value === undefined) return "–";
  const steps = ["bytes", "kB", "MB", "GB", "TB"];
  let step = 0;
  for (; value >= 1000 && step < 4; ++step) value /= 1000;
  return `${step === 0 ? value : value.toPrecision(3)} ${steps[step]}`;
};
const milliseconds = (value) => (value >= 10000 ? `${(value / 1000).toPrecision(3)} s` : value === undefined || value === null ? "–" : `${number(value >= 100 ? Math.round(value) : value)} ms`);
const count = (value, what) => `${number(value)} ${what}${value === 1 ? "" : "s"}`;
const share = (value) => (value === null || value === undefined ? "–" : `${number(value * 100)} %`);

const table = (head, rows) =>
  element("div", { class: "scroll" },
    element("table", {},
      head && element("thead", {}, element("tr", {}, ...head.map((text, i) => element("th", { class: i > 0 ? "n" : undefined, scope: "col" }, text)))),
      element("tbody", {}, ...rows.map((row) =>
        element("tr", {}, ...row.map((cell, i) => (i === 0 ? element("th", { scope: "row", class: head ? "name" : undefined }, cell) : element("td", { class: "n" }, cell))))))));

const lossList = (title, losses) =>
  losses.length === 0 ? null : element("div", {},
    element("h3", {}, count(losses.length, title)),
    element("div", { class: "scroll" },
      element("table", {},
        element("tbody", {}, ...losses.slice(0, 200).map((loss) => element("tr", {},
          element("td", { class: "name" }, [loss.name, loss.entity].filter(Boolean).join(" ") || "unnamed"),
          element("td", { class: "name" }, loss.reason || "")))))),
    losses.length > 200 ? element("p", { class: "facts" }, `… and ${losses.length - 200} more in the JSON`) : null);

const lossNotice = (model) => {
  const kinds = [["lost face", model.faces_skipped], ["lost loop", model.loops_lost], ["lost edge", model.edges_lost]];
  if (kinds.every(([, list]) => !list || list.length === 0)) return null;
  return element("section", { class: "notice" },
    element("h2", {}, "Not everything in the file could be read"),
    element("p", {}, "What is listed here is missing from all pictures and numbers below."),
    ...kinds.map(([title, list]) => lossList(title, list || [])));
};

const verdictNotice = (verdict) => {
  if (!verdict || verdict.broken.length === 0) return null;
  return element("section", { class: "notice" }, element("h2", {}, "Thresholds are broken"),
    table(["View and threshold", "limit", "value"], verdict.broken.map((b) => [`${b.view}: ${b.threshold.replace("fail_", "")}`, number(b.limit), b.value === null ? "infinite" : number(b.value)])));
};

// Pictures that zoom and move together: wheel, drag, double click to reset.
class Stage {
  constructor() {
    this.scale = 1; this.x = 0; this.y = 0; this.images = [];
  }
  frame(...images) {
    const frame = element("div", { class: "frame" }, ...images);
    images.flatMap((i) => (i.tagName === "IMG" ? [i] : [...i.querySelectorAll("img")])).forEach((i) => this.images.push(i));
    frame.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && this.scale === 1 && event.deltaY > 0) return;
      event.preventDefault();
      const box = frame.getBoundingClientRect();
      this.zoom(Math.exp(-event.deltaY / 300), (event.clientX - box.left) / box.width, (event.clientY - box.top) / box.width);
    }, { passive: false });
    let last = null;
    frame.addEventListener("pointerdown", (event) => { last = event; frame.setPointerCapture(event.pointerId); frame.classList.add("panning"); });
    frame.addEventListener("pointermove", (event) => {
      if (!last) return;
      const width = frame.getBoundingClientRect().width;
      this.x += (event.clientX - last.clientX) / width; this.y += (event.clientY - last.clientY) / width; last = event; this.apply();
    });
    for (const end of ["pointerup", "pointercancel"]) frame.addEventListener(end, () => { last = null; frame.classList.remove("panning"); });
    frame.addEventListener("dblclick", () => { this.scale = 1; this.x = this.y = 0; this.apply(); });
    return frame;
  }
  // (x, y) stays where it is; all in widths of the frame.
  zoom(factor, x, y) {
    const scale = Math.min(64, Math.max(1, this.scale * factor));
    this.x = x - (x - this.x) * (scale / this.scale); this.y = y - (y - this.y) * (scale / this.scale);
    this.scale = scale; this.apply();
  }
  apply() {
    this.x = Math.min(0, Math.max(1 - this.scale, this.x)); this.y = Math.min(0, Math.max(1 - 1.2 * this.scale, this.y));
    for (const image of this.images) {
      const width = image.closest(".frame").clientWidth;
      image.style.transform = `translate(${this.x * width}px, ${this.y * width}px) scale(${this.scale})`;
      image.classList.toggle("close", this.scale > 3);
    }
  }
}

const captions = { direct: ["Direct", "exact surfaces"], baseline: ["Baseline", "triangle mesh"], difference: ["Difference", "mesh − surface"] };

const figure = (stage, view, role, address) =>
  element("figure", {}, stage.frame(element("img", { src: address, alt: `${captions[role][0]} of view ${view.name}`, draggable: "false" })),
    element("figcaption", {}, element("b", {}, captions[role][0]), element("span", {}, captions[role][1])));

// Direct on the left of the seam, baseline on the right.
const slider = (stage, view, addresses) => {
  const over = element("img", { src: addresses.direct, alt: `Direct of view ${view.name}`, draggable: "false" });
  const cut = element("div", { class: "cut" }, over);
  const seam = element("div", { class: "seam" });
  const frame = stage.frame(element("img", { src: addresses.baseline, alt: `Baseline of view ${view.name}`, draggable: "false" }), cut);
  frame.append(seam);
  const range = element("input", { type: "range", min: "0", max: "100", value: "50", step: "0.1", class: "slide", "aria-label": "Seam between direct and baseline" });
  const move = () => { cut.style.clipPath = `inset(0 ${100 - range.value}% 0 0)`; seam.style.left = `${range.value}%`; };
  range.addEventListener("input", move);
  move();
  return element("figure", {}, frame, range,
    element("figcaption", {}, element("b", {}, "Direct"), element("span", {}, "move the seam"), element("b", {}, "Baseline")));
};

const pictures = (view, addresses) => {
  const holder = element("div", {});
  const both = addresses.direct && addresses.baseline;
  const modes = both ? ["Side by side", "Slider", "Difference"] : ["Direct"];
  const show = (mode) => {
    const stage = new Stage();
    const wide = mode !== "Side by side";
    const shown = mode === "Slider" ? [slider(stage, view, addresses)]
      : (mode === "Difference" ? ["difference"] : mode === "Direct" ? ["direct"] : ["direct", "baseline", "difference"])
        .filter((role) => addresses[role]).map((role) => figure(stage, view, role, addresses[role]));
    holder.replaceChildren(element("div", { class: wide ? "stage wide" : "stage" }, ...shown));
    buttons.forEach((button) => button.setAttribute("aria-pressed", String(button.textContent === mode)));
  };
  const buttons = modes.map((mode) => element("button", { type: "button", on: { click: () => show(mode) } }, mode));
  show(modes[0]);
  return [modes.length > 1 ? element("div", { class: "modes", role: "group", "aria-label": "Pictures" }, ...buttons) : null, holder];
};

const differenceTables = (d) => {
  const spread = (title, s) => [title, number(s.mean), number(s.p50), number(s.p95), number(s.p99), number(s.max)];
  return [
    element("div", {}, element("h3", {}, "Distance"),
      table(["", "mean", "p50", "p95", "p99", "max"], [spread("surfaces, mm", d.deviation_mm), spread("along the ray, mm", d.depth_mm)]),
      element("p", { class: "facts" }, `Positions of the mesh are known to ${number(d.noise_mm)} mm.`)),
    element("div", {}, element("h3", {}, "Picture"),
      table(null, [["FLIP, mean", number(d.color.flip_mean)], ["FLIP, 95 %", number(d.color.flip_p95)], ["SSIM", d.color.ssim.toFixed(4)],
        ["PSNR", d.color.psnr === null ? "equal" : `${number(d.color.psnr)} dB`], ["Pixels that differ", share(d.color.share_over_threshold)],
        ["Silhouette", `${number(d.silhouette.pixels)} px, up to ${d.silhouette.max_distance_px === null ? "∞" : number(d.silhouette.max_distance_px)} px off`],
        ["Normals, p95 and max", `${number(d.normal_deg.p95)}°, ${number(d.normal_deg.max)}°`]])),
  ];
};

const costTable = (view) => {
  const direct = view.direct, baseline = view.baseline || {}, dt = direct.timing_ms, bt = baseline.timing_ms || {};
  const rows = [["Mesh", "–", milliseconds(bt.mesh)], ["Build, prepare", milliseconds(dt.prepare), milliseconds(bt.build)], ["Trace", milliseconds(dt.trace), milliseconds(bt.trace)],
    ["Shade", milliseconds(dt.shade), milliseconds(bt.shade)], ["Total", milliseconds(dt.total), milliseconds(bt.total)], ["Memory", bytes(direct.peak_bytes), bytes(baseline.peak_bytes)],
    ["Size", `${number(direct.leaves)} leaves`, count(baseline.triangles, "triangle")]];
  return element("div", {}, element("h3", {}, "Cost"),
    view.baseline ? table(["", "direct", "baseline"], rows) : table(["", "direct"], rows.slice(1).map((row) => row.slice(0, 2))));
};

const certaintyTable = (direct) =>
  element("div", {}, element("h3", {}, "How sure the direct image is"),
    table(null, [["Samples certified", number(direct.certified)], ["converged, not proven", number(direct.converged)], ["unresolved", number(direct.unresolved)],
      ["Rays, hits", `${number(direct.rays)}, ${number(direct.hits)}`],
      direct.odd_rays === null || direct.odd_rays === undefined ? null : ["Odd crossings", number(direct.odd_rays)],
      direct.reverse_mismatches === null || direct.reverse_mismatches === undefined ? null : ["Opposite view differs", number(direct.reverse_mismatches)],
      direct.unseen_faces && direct.unseen_faces.length ? ["Faces no ray can see", number(direct.unseen_faces.length)] : null].filter(Boolean)));

const worstFaces = (faces) =>
  !faces || faces.length === 0 ? null : element("div", {}, element("h3", {}, "Worst faces"),
    table(["Face", "deviation, mm", "depth, mm", "normal, °", "missed px", "pixels"], faces.slice(0, 12).map((face) =>
      [face.name, number(face.deviation_mm_max), number(face.depth_mm_max), number(face.normal_deg_max), number(face.missed_pixels), number(face.pixels)])));

const cameraText = (camera) =>
  `${camera.projection}, ${camera.width} × ${camera.height_px} pixels, ` + (camera.fov_y_deg !== undefined ? `${number(camera.fov_y_deg)}° high` : `${number(camera.height)} mm high`);

const viewSection = (view, pictureOf) => {
  const addresses = {};
  for (const role of ["direct", "baseline", "difference"]) addresses[role] = pictureOf(view, role);
  const [modes, holder] = pictures(view, addresses);
  return element("section", { class: "view" },
    element("div", { class: "bar" }, element("h2", {}, view.name), element("span", { class: "facts" }, cameraText(view.camera)), modes),
    holder,
    element("div", { class: "tables" }, ...(view.difference ? differenceTables(view.difference) : []), costTable(view), certaintyTable(view.direct)),
    view.difference ? worstFaces(view.difference.faces) : null);
};

// One view of `facetless trade`: the answers, both plots, and all points.
const tradeSection = (view, trade, pictureOf) => {
  const points = trade.points.filter((point) => point.view === view.name);
  const kinds = [["time", "Time against error"], ["memory", "Memory against error"]];
  const plot = ([kind, title]) =>
    element("figure", { class: "plot" }, element("img", { src: pictureOf(view, kind), alt: `${title}, view ${view.name}; the table below has the numbers` }));
  const row = (point) => {
    if (!point.measured) return [point.name, ...Array(10).fill("–"), point.skipped];
    const t = point.timing_ms;
    return [point.name, milliseconds(t.prepare), milliseconds(t.trace), milliseconds(t.shade), milliseconds(t.total), bytes(point.peak_bytes),
      number(point.deviation_mm.mean_abs), number(point.deviation_mm.p95), number(point.deviation_mm.p99), number(point.deviation_mm.max),
      `${number(point.silhouette.pixels)} (${number(point.silhouette.max_distance_px)})`, number(point.flip.mean),
      [point.pareto.time && "time", point.pareto.memory && "memory"].filter(Boolean).join(", ")];
  };
  return element("section", { class: "view" },
    element("div", { class: "bar" }, element("h2", {}, view.name), element("span", { class: "facts" }, cameraText(view.camera))),
    element("ul", { class: "answers" }, ...view.sentences.map((sentence) => element("li", {}, sentence))),
    element("div", { class: "plots" }, ...kinds.map(plot)),
    element("h3", {}, "All points"),
    table(["Setting", "prepare", "trace", "shade", "total", "memory", "error mean, mm", "p95", "p99", "max", "outline px (farthest)", "FLIP", "unbeaten in"], points.map(row)),
    element("p", { class: "facts" }, `Errors are distances to the exact surface: direct, certified, the same ${number(view.reference.hits)} hits. Times are the median of ${number(Math.max(...points.map((p) => p.repetitions || 1)))} runs where a run is short, with one sample per pixel; ` +
      `prepare is meshing and its tree, or patches, trimming and leaves. Reading the file (${milliseconds(trade.shared_ms.read + trade.shared_ms.transfer)}) is in none. Meshing runs on one thread.` + (trade.load_at_start > 1.5 ? ` The machine had other work meanwhile: its load was ${number(trade.load_at_start)}.` : "")));
};

const showReport = (root, report, pictureOf) => {
  const model = report.model;
  const lost = ["faces_skipped", "loops_lost", "edges_lost"].reduce((sum, key) => sum + (model[key] || []).length, 0);
  const broken = report.verdict && report.verdict.broken.length > 0;
  const facts = [model.format, model.unit && `in ${model.unit}`, count(model.faces, "face"), model.solids && count(model.solids, "solid"), model.patches && `${number(model.patches)} Bézier patches`, `${number(model.diagonal_mm)} mm across`, `read in ${milliseconds(model.import_ms)}`].filter(Boolean);
  const surfaces = Object.entries(model.surfaces || {}).filter(([, count]) => count > 0);
  root.replaceChildren(...[
    element("h1", {}, model.file || "Report"),
    element("p", { class: "facts" }, ...facts.map((fact) => element("span", {}, fact))),
    element("p", {}, element("span", { class: lost || broken ? "pill bad" : "pill" }, broken ? "thresholds broken" : lost ? `${number(lost)} lost` : "nothing lost")),
    lossNotice(model), verdictNotice(report.verdict),
    ...report.views.map((view) => (report.trade ? tradeSection(view, report.trade, pictureOf) : viewSection(view, pictureOf))),
    element("details", {}, element("summary", {}, "Surfaces, warnings and the whole report as JSON"),
      surfaces.length ? table(["Surface", "faces"], surfaces.map(([kind, count]) => [kind, number(count)])) : null,
      ...(model.warnings || []).slice(0, 50).map((warning) => element("p", { class: "facts" }, warning)),
      element("pre", {}, JSON.stringify(report, null, 2)))].filter(Boolean));
};
