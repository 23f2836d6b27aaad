// Shows the progress of the work: its stages in order, the current stage with its fraction, and each finished stage
// with its time.
import { element, milliseconds } from "./dom.js";

const orders = {
  comparison: ["upload", "queued", "read", "transfer", "convert", "render", "mesh", "compare", "publish"],
  trade: ["upload", "queued", "read", "transfer", "convert", "reference", "direct", "meshes", "publish"],
};
const titles = {
  upload: "Sending", queued: "Waiting", read: "Reading", transfer: "Translating", convert: "Bézier patches", render: "First picture", mesh: "Tessellating", compare: "Tracing, comparing", reference: "Reference", direct: "Direct", meshes: "Meshes", publish: "Storing",
};

export class ProgressView {
  constructor(kind, stop) {
    this.order = orders[kind];
    this.started = performance.now(); this.stage = null; this.spent = {};
    this.steps = new Map(this.order.map((stage) => {
      const bar = element("span", { class: "step-bar" }), time = element("span", { class: "step-time" });
      return [stage, { bar, time, root: element("li", { class: "step" }, element("span", { class: "step-name" }, titles[stage]), bar, time) }];
    }));
    this.text = element("p", { class: "facts", role: "status" });
    this.clock = element("span", { class: "facts clock" });
    this.root = element("section", { class: "progress", "aria-label": "Progress" }, element("ol", { class: "steps" }, [...this.steps.values()].map((step) => step.root)),
      element("div", { class: "bar tight" }, this.text, this.clock, element("button", { type: "button", class: "small", on: { click: stop } }, "Stop")));
    this.timer = setInterval(() => { this.clock.textContent = `${((performance.now() - this.started) / 1000).toFixed(0)} s`; }, 500);
  }
  // A stage that is unknown, or that comes a second time (two jobs share an import), is shown only as text.
  at(stage, fraction = 0) {
    if (stage === "starting" || stage === "") stage = "queued";
    if (!this.steps.has(stage)) return;
    const now = performance.now();
    if (stage !== this.stage) {
      if (this.stage) this.finish(this.stage, now);
      this.stage = stage; this.since = now;
      this.text.textContent = titles[stage];
    }
    const step = this.steps.get(stage);
    step.root.className = "step now";
    step.bar.style.setProperty("--done", `${Math.round(Math.min(1, fraction || 0) * 100)}%`);
  }
  finish(stage, now) {
    const step = this.steps.get(stage);
    this.spent[stage] = (this.spent[stage] || 0) + now - this.since;
    step.root.className = "step done";
    step.time.textContent = milliseconds(Math.round(this.spent[stage]));
  }
  say(text) { this.text.textContent = text; }
  end() {
    clearInterval(this.timer);
    if (this.stage) this.finish(this.stage, performance.now());
    this.stage = null;
  }
}
