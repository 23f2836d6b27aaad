// One view with everything that belongs to it: the synchronised pictures, the read-out, the heat map's legend, the
// faces and the numbers. The address stores what the user sets.
import { candidatesOf } from "./candidates.js";
import { calm, choice, element, given } from "./dom.js";
import { faceTable } from "./face_table.js";
import { heatLegend, heatMap, usualRange } from "./heat_map.js";
import { cameraText, certaintyTable, differenceTables, lightTable } from "./numbers.js";
import { inspectionLegend } from "./measures.js";
import { Pane } from "./pane.js";
import { Pixels, planeRoles } from "./pixels.js";
import { readOut } from "./read_out.js";
import { timing } from "./timing.js";
import { Viewport } from "./viewport.js";

const blinkSeconds = 0.7;
const outlineColor = [214, 0, 110];
const blends = ["Slider", "Blink", "Onion skin"];
const titleOf = (role) => role.charAt(0).toUpperCase() + role.slice(1).replace("-", " ");

export class ViewBench {
  // `tabs` replaces the view's name. `source` has the pictures: roles(view) lists them, blob(view, role) loads one.
  // `again` rebuilds the view after the user has chosen another candidate.
  constructor(report, view, source, address, tabs = null, again = () => {}) {
    Object.assign(this, { report, view, source, address, tabs, again });
    this.viewport = new Viewport(view.camera.width, view.camera.height_px);
    this.pictures = {}; this.panes = []; this.outlines = new Map();
    this.roles = source.roles(view);
    this.candidates = candidatesOf(view).filter((candidate) => this.roles.includes(candidate.name));
    this.candidate = ViewBench.chosen(this.candidates, address);
    const candidate = this.candidate, own = ["direct", "legend", ...this.candidates.flatMap((one) => one.roles)];
    const others = this.roles.filter((role) => !own.includes(role));
    this.captions = { direct: ["Direct", "exact surfaces"], ...(candidate && { [candidate.name]: [candidate.title, candidate.what], [candidate.differenceRole]: ["Difference", "deviation, mm"] }), ...(candidate && this.roles.includes(candidate.lightRole) && { [candidate.lightRole]: ["Light", `orange: lit only on the surfaces; blue: lit only on the ${candidate.noun}; purple: the ${candidate.noun} shades itself`] }) };
    this.modes = [...(candidate ? ["Slider", "Side by side", "Blink", "Onion skin", "Direct", candidate.title, "Difference", ...(this.captions[candidate.lightRole] ? ["Light"] : [])] : ["Direct"]), ...others.map(titleOf)];
    this.roleOf = (mode) => Object.keys(this.captions).find((role) => this.captions[role][0] === mode) ?? others.find((role) => titleOf(role) === mode);
    this.split = address.number("split", 0.5); this.onion = address.number("onion", 0.5);
    this.build();
    this.load();
  }
  // Returns the candidate that the address names, otherwise the first; undefined if there is none.
  static chosen(candidates, address) { return candidates.find((candidate) => candidate.name === address.get("with")) ?? candidates[0]; }
  get mode() { return this.modes.find((mode) => mode === this.address.get("mode")) || this.modes[0]; }
  get range() { return this.address.number("range", this.usual); }

  build() {
    const { view, candidate } = this, difference = candidate?.difference;
    this.usual = difference ? usualRange(difference) : 1;
    this.modeChoice = choice("Pictures", this.modes, (mode) => { this.address.set({ mode: mode === this.modes[0] ? null : mode }); this.arrange(); });
    this.stage = element("div", { class: "stage" });
    this.tools = element("div", { class: "tools" });
    this.faces = difference?.faces?.length ? faceTable(difference, (id) => this.choose(id, true), (id) => this.hover(id)) : null;
    this.readOut = readOut((id) => this.faces?.name(id) ?? `face ${id}`, difference?.noise_mm ?? 0);
    this.legend = difference ? heatLegend(this.usual, (range) => { this.address.set({ range: range === this.usual ? null : range }); this.recolor(); }, candidate.ends, candidate.noun) : null;
    this.candidateChoice = this.candidates.length > 1 ? choice("Compared with", this.candidates.map((one) => one.title), (title) => {
      const one = this.candidates.find((other) => other.title === title);
      this.address.set({ with: one === this.candidates[0] ? null : one.name, mode: null, range: null });
      this.again();
    }) : null;
    this.candidateChoice?.choose(candidate.title);
    this.note = element("p", { class: "facts", role: "status" });
    const zoomButton = (text, label, act) => element("button", { type: "button", class: "small", "aria-label": label, on: { click: act } }, text);
    this.scaleText = element("span", { class: "facts", "aria-live": "off" });
    const zooms = element("span", { class: "zooms no-print" }, zoomButton("−", "Zoom out", () => this.viewport.zoom(1 / 1.5)), zoomButton("+", "Zoom in", () => this.viewport.zoom(1.5)), zoomButton("Fit", "Fit: show the whole view", () => this.viewport.fit()),
      zoomButton("1:1", "1:1, one pixel per screen pixel", () => this.viewport.look(this.viewport.width / (this.panes[0].root.clientWidth * (devicePixelRatio || 1)), this.viewport.x, this.viewport.y)), this.scaleText);
    this.root = element("section", { class: "view" },
      element("div", { class: "bar" }, element("h2", { class: this.tabs ? "unseen" : undefined }, view.name), this.tabs, element("span", { class: "facts" }, cameraText(view.camera)), this.candidateChoice?.root, this.modes.length > 1 ? this.modeChoice.root : null),
      element("div", { class: "bench" },
        element("div", { class: "bench-pictures" }, this.stage, element("div", { class: "bar tight" }, this.tools, zooms), this.note), element("div", { class: "bench-side" }, this.readOut.root, inspectionLegend(view, this.source), this.legend?.root, this.faces?.root)),
      element("div", { class: "tables" }, timing(this.report, view), difference ? differenceTables(difference, candidate.noun) : null, lightTable(view.direct.light, difference?.light), certaintyTable(view.direct)));
    this.viewport.onChange((what) => this.moved(what));
    this.viewport.chosen = (id) => this.choose(id === null ? null : this.faceAt(this.viewport.pointed), true);
    this.restore();
    this.arrange();
  }
  restore() {
    const z = this.address.number("zoom", 1);
    if (z > 1) this.viewport.look(z, this.address.number("x", this.viewport.x), this.address.number("y", this.viewport.y));
    const face = this.address.number("face", null);
    this.face = null;
    this.choose(face, false);
    this.legend?.show(this.range);
  }
  // Applies an address that has changed, for example because the user went back.
  follow() {
    this.split = this.address.number("split", 0.5); this.onion = this.address.number("onion", 0.5);
    this.restoring = true;
    if (!this.address.get("zoom")) this.viewport.fit();
    this.restore();
    this.recolor();
    this.arrange();
    this.restoring = false;
  }
  end() {
    clearInterval(this.blinking);
    this.panes.forEach((pane) => pane.end());
    this.ended = true;
  }

  async load() {
    try {
      const { candidate } = this, hidden = ["legend", ...this.candidates.flatMap((one) => one.roles)];
      const wanted = this.roles.filter((role) => !hidden.includes(role) || role === candidate?.name || role === candidate?.lightRole || (role === candidate?.differenceRole && !this.view.pixel_data));
      await Promise.all(wanted.map(async (role) => {
        this.pictures[role] = await createImageBitmap(await this.source.blob(this.view, role));
        this.redraw();
      }));
      this.root.dataset.pictures = "shown";
      if (this.ended || !this.view.pixel_data || !this.roles.includes(planeRoles[0])) {
        if (candidate && !this.ended) this.note.textContent = "This view is too large for a read-out of its pixels. Its numbers are below.";
        return;
      }
      this.pixels = await Pixels.load(this.view, (role) => this.source.blob(this.view, candidate.planeOf(role)));
      if (this.pixels.stride > 1) this.note.textContent = `The read-out, the heat map and the outlines in this file have one pixel of ${this.pixels.stride} × ${this.pixels.stride}; the files beside the report have all pixels.`;
      this.recolor();
      this.outlined();
      this.root.dataset.pixels = "read";
    } catch (error) {
      if (!this.ended) this.note.textContent = `Not all pictures could be loaded (${error.message}). Reload the page.`;
    }
  }

  pane(label, layers, ...seam) {
    const pane = new Pane(this.viewport, `${label} of view ${this.view.name}`, () => [...layers(), { picture: this.hovered ?? null }, { picture: this.outline ?? null }], ...seam);
    this.panes.push(pane);
    return pane;
  }
  figure(role) {
    const [title, what] = this.captions[role] || [titleOf(role), ""];
    return element("figure", {}, this.pane(title, () => [{ picture: this.pictures[role] }]).root, element("figcaption", {}, element("b", {}, title), element("span", {}, what)));
  }
  blend(mode) {
    const { pictures, candidate } = this, other = candidate.name, caption = element("figcaption", {}), both = `Direct and ${candidate.title.toLowerCase()}`;
    const layers = {
      "Slider": () => [{ picture: pictures[other], from: this.split }, { picture: pictures.direct, to: this.split }],
      "Blink": () => [{ picture: this.blinked ? pictures[other] : pictures.direct }],
      "Onion skin": () => [{ picture: pictures.direct }, { picture: pictures[other], alpha: this.onion }],
    }[mode];
    const pane = mode === "Slider" ? this.pane(both, layers, () => this.split, (to) => this.setSplit(to)) : this.pane(both, layers);
    this.blendCaption = () => caption.replaceChildren(...(mode === "Blink" ? [element("b", {}, this.blinked ? candidate.title : "Direct"), element("span", {}, this.blinked ? candidate.what : "exact surfaces")]
      : [element("b", {}, "Direct"), element("b", {}, candidate.title)]));
    this.blendCaption();
    return element("figure", {}, pane.root, caption);
  }
  setSplit(to) {
    this.split = to;
    if (this.slide) this.slide.value = to * 100;
    this.address.set({ split: to === 0.5 ? null : Number(to.toFixed(3)) });
    this.redraw();
  }
  arrange() {
    const { mode } = this;
    clearInterval(this.blinking);
    this.panes.forEach((pane) => pane.end());
    this.panes = []; this.slide = null; this.blinked = false;
    this.modeChoice.choose(mode);
    const roles = mode === "Side by side" ? ["direct", this.candidate.name, this.candidate.differenceRole] : blends.includes(mode) ? [] : [this.roleOf(mode)];
    const shown = [...(blends.includes(mode) ? [this.blend(mode), this.figure(this.candidate.differenceRole)] : []), ...roles.map((role) => this.figure(role))];
    this.stage.className = `stage of-${shown.length}`;
    this.stage.replaceChildren(...shown);
    if (this.legend) this.legend.root.hidden = !(shown.length > 1 || mode === "Difference");
    this.tools.replaceChildren(...this.toolsOf(mode));
    this.redraw();
  }
  toolsOf(mode) {
    const range = (label, value, input) => element("label", { class: "slide" }, label, element("input", { type: "range", min: "0", max: "100", step: "0.1", value: value * 100, on: { input: (event) => input(event.target.valueAsNumber / 100) } }));
    if (mode === "Slider") {
      const label = range("Seam", this.split, (to) => this.setSplit(to));
      this.slide = label.querySelector("input");
      return [label];
    }
    if (mode === "Onion skin") return [range(`${this.candidate.title} over direct`, this.onion, (to) => { this.onion = to; this.address.set({ onion: to === 0.5 ? null : Number(to.toFixed(3)) }); this.redraw(); })];
    if (mode !== "Blink") return [];
    const flip = () => { this.blinked = !this.blinked; this.blendCaption(); this.redraw(); };
    const button = element("button", { type: "button", class: "small" });
    const run = (on) => {
      clearInterval(this.blinking);
      if (on) this.blinking = setInterval(flip, blinkSeconds * 1000);
      button.textContent = on ? "Pause" : "Continue";
      this.running = on;
    };
    button.addEventListener("click", () => run(!this.running));
    run(!calm());
    return [button, element("button", { type: "button", class: "small", on: { click: () => { run(false); flip(); } } }, "Switch")];
  }

  redraw() { this.panes.forEach((pane) => pane.ask()); }
  recolor() {
    if (this.pixels) this.pictures[this.candidate.differenceRole] = heatMap(this.pixels, this.range);
    this.legend?.show(this.range);
    this.redraw();
  }
  moved(what) {
    const { viewport } = this;
    if (what === "look") {
      this.scaleText.textContent = viewport.scale > 1 ? `${viewport.scale.toFixed(viewport.scale < 10 ? 1 : 0)} ×` : "";
      if (!this.restoring) this.address.set(viewport.scale > 1 ? { zoom: viewport.scale, x: viewport.x, y: viewport.y } : { zoom: null, x: null, y: null });
    } else {
      this.readOut.show(viewport.pointed, this.pixels, viewport.pointedBy === "keys");
      this.faces?.mark(this.faceAt(viewport.pointed));
    }
    this.redraw();
  }
  faceAt(pointed) { return pointed && this.pixels ? this.pixels.faceAt(pointed.x, pointed.y) : null; }

  // Selecting the selected face again clears the selection.
  choose(id, byHand) {
    const face = id === this.face && byHand ? null : id;
    this.face = face;
    this.faces?.press(face);
    if (!byHand && face !== null) requestAnimationFrame(() => this.faces?.reveal(face));
    if (byHand) this.address.set({ face: given(face) ? String(face) : null });
    this.outlined();
  }
  outlineOf(id) {
    if (!this.pixels || !given(id)) return null;
    if (!this.outlines.has(id)) {
      if (this.outlines.size > 40) this.outlines.clear();
      this.outlines.set(id, this.pixels.outline(id, outlineColor));
    }
    return this.outlines.get(id);
  }
  outlined() {
    const outline = this.outlineOf(this.face);
    this.outline = outline?.canvas;
    this.root.dataset.face = outline?.box ? String(this.face) : "";
    this.redraw();
  }
  hover(id) {
    this.hovered = id === this.face ? null : this.outlineOf(id)?.canvas;
    this.redraw();
  }
}
