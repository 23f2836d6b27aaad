// The page of the service: it takes a file, sends a request, follows the job and shows the answer. The address says
// what the page shows:
//   #job=ID        a job, followed to its end
//   #answer=ID     an answer, with view, mode, split, range, zoom, face, … as the user set them
import { Address } from "./address.js";
import { element } from "./dom.js";
import { Form } from "./form.js";
import { ProgressView } from "./progress_view.js";
import { mayPass, remedyOf } from "./remedies.js";
import { showReport } from "./report_view.js";
import { meshSection } from "./mesh_view.js";
import { key, Problem, Service } from "./service.js";

const byId = (id) => document.getElementById(id);
const address = new Address();
let shown = null, running = null, service = null;

const clear = () => {
  running?.end();
  running = null;
  shown?.end();
  shown = null;
  byId("progress").replaceChildren();
  byId("report").replaceChildren();
  byId("problem").replaceChildren();
};

const begin = (kind) => {
  service?.stop();
  clear();
  service = new Service((tries) => running?.say(tries === 0 ? "The service answers again." : `The service does not answer. The page tries again (attempt ${tries}); the data that were sent are not lost.`));
  running = new ProgressView(kind, () => stop());
  byId("progress").replaceChildren(running.root);
  document.body.dataset.state = "working";
  return service;
};

const stop = () => {
  const job = address.get("job");
  if (job) new Service(() => {}).cancel(`v1/jobs/${job}`);
  service.stop();
  clear();
  address.only({});
  document.body.dataset.state = "start";
};

const fail = (problem, again) => {
  clear();
  document.body.dataset.state = "problem";
  if (problem.status === 401) byId("keys").open = true;
  const box = element("section", { class: "notice", role: "alert" }, element("h2", { tabindex: "-1" }, problem.title || "Something failed"), problem.detail ? element("p", {}, problem.detail) : null,
    element("p", { class: "remedy" }, remedyOf(problem.code)), again && mayPass(problem.code) ? element("p", {}, element("button", { type: "button", class: "go", on: { click: again } }, "Try again")) : null);
  byId("problem").replaceChildren(box);
  box.querySelector("h2").focus({ preventScroll: true });
  if (problem.status === 401) byId("key").focus();
};

// Runs `work` with a service of its own, and shows its errors.
const guarded = async (kind, work, again) => {
  const own = begin(kind);
  try {
    await work(own);
  } catch (error) {
    if (own.stopped.signal.aborted) return;
    fail(error instanceof Problem ? error : new Problem({ title: "The page has a defect", detail: String(error?.stack || error) }), again);
  }
};

const sourceOf = (own) => ({
  roles: (view) => Object.keys(view.links || {}).filter((role) => view.links[role].endsWith(".png") && !role.startsWith("trade-")),
  blob: (view, role) => own.blob(view.links[role]),
});

const save = async (own, link, name) => {
  const anchor = element("a", { href: URL.createObjectURL(await own.blob(link)), download: name });
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(anchor.href), 10000);
};

// Returns the names of faces, collected from all views.
const faceNames = (answer) => {
  const names = new Map(answer.views.flatMap((view) => (view.difference?.faces || []).map((face) => [face.id, face.name])));
  return (id) => names.get(id) || `face ${id}`;
};

const show = (own, answer, focus) => {
  running?.end();
  running = null;
  byId("progress").replaceChildren();
  shown?.end();
  const stem = (answer.model.file || "report").replace(/\.[^.]*$/, "");
  const copied = element("span", { role: "status" });
  const button = (label, act) => element("button", { type: "button", class: "small", on: { click: act } }, label);
  const tools = element("div", { class: "actions no-print" }, button("Save as one file", () => save(own, answer.links.page, `${stem}.html`)), button("Save the numbers", () => save(own, answer.links.report, `${stem}.json`)),
    answer.links.sheet ? button("Save the contact sheet", () => save(own, answer.links.sheet, `${stem}-sheet.png`)) : null,
    button("Copy the link", async () => {
      try { await navigator.clipboard.writeText(location.href); copied.textContent = "Copied."; } catch (error) { copied.textContent = "Copy the link from the address bar."; }
    }), copied);
  shown = showReport(byId("report"), answer, sourceOf(own), address, tools, answer.trade ? null : meshSection(answer, own, address, faceNames(answer)));
  document.title = `${answer.model.file || "Report"} · Facetless`;
  document.body.dataset.state = "shown";
  if (focus) byId("report").querySelector("h1").focus({ preventScroll: true });
};

// The first picture is a separate render with one sample per pixel, so it is there while the rest is computed. The
// service keeps the model, so the file is sent and read once.
const firstPicture = async (own, file, options) => {
  const body = new FormData();
  body.append("file", file, file.name);
  const quick = { view: options.view[0], samples: 1 };
  for (const name of ["projection", "size", "precision", "edges", "shade", "lines", "section"]) if (options[name] !== undefined) quick[name] = options[name];
  body.append("options", JSON.stringify(quick));
  running.at("upload");
  const job = await own.post("v1/renders", body, (fraction) => running?.at("upload", fraction));
  const answer = await own.follow(job, (stage, fraction, text) => { if (text) running?.say(text); else if (stage !== "publish") running?.at(stage, fraction); });
  shown = showReport(byId("report"), answer, sourceOf(own), new Address());
  document.body.dataset.state = "first-picture";
  return answer.links.model.split("/").pop();
};

const ask = (form) => guarded(form.kind, async (own) => {
  const kind = form.kind, options = form.options();
  if (form.needsMesh && !form.meshFile) throw new Problem({ type: "bad-usage", title: "There is no mesh to compare with", detail: "Under Options, “my own file” is selected as the mesh, but no mesh file is chosen." });
  address.only({});
  const model = await firstPicture(own, form.file, options);
  let body = JSON.stringify({ ...options, model });
  if (form.needsMesh) {
    body = new FormData();
    body.append("model", model);
    body.append("mesh", form.meshFile, form.meshFile.name);
    body.append("options", JSON.stringify(options));
  }
  const job = await own.post(kind === "trade" ? "v1/trades" : "v1/comparisons", body);
  if (job.state !== undefined) address.only({ job: job.id, kind: kind === "trade" ? "trade" : null }, false);
  await finish(own, job);
}, () => ask(form));

const finish = async (own, job) => {
  const answer = await own.follow(job, (stage, fraction, text) => { if (text) running?.say(text); else running?.at(stage, fraction); });
  address.only({ answer: answer.links.self.split("/").pop() }, false);
  show(own, answer, true);
};

// Shows what the address says.
const open = () => {
  const answer = address.get("answer"), job = address.get("job");
  if (answer && shown && document.body.dataset.answer === answer) {
    shown.follow();
    return;
  }
  document.body.dataset.answer = answer || "";
  if (answer) guarded("comparison", async (own) => { const report = await own.json(`v1/answers/${answer}`); show(own, report, false); }, open);
  else if (job) guarded(address.get("kind") === "trade" ? "trade" : "comparison", async (own) => finish(own, await own.json(`v1/jobs/${job}`)), open);
  else { service?.stop(); clear(); document.body.dataset.state = "start"; }
};

const form = new Form(() => ask(form));
byId("origin").textContent = location.origin + location.pathname.replace(/\/$/, "");
byId("key").value = key.get();
byId("key-form").addEventListener("submit", (event) => {
  event.preventDefault();
  key.set(byId("key").value.trim());
  byId("key-said").textContent = key.get() ? "The key is kept until this tab is closed." : "The page no longer sends a key.";
  if (document.body.dataset.state !== "problem") return;
  if (form.file && !address.get("answer") && !address.get("job")) ask(form); else open();
});
address.onChange(open);
open();
