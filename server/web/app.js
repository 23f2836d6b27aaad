// The page of the service: takes a file, asks for a comparison, shows the report.
"use strict";

const byId = (id) => document.getElementById(id);
let chosen = null;

const choose = (file) => {
  chosen = file || null;
  byId("chosen").textContent = chosen ? chosen.name : "Drop a STEP, IGES or BREP file here";
  byId("hint").textContent = chosen ? bytes(chosen.size) : "or click to choose one. It stays on the machine that serves this page.";
  byId("go").disabled = !chosen;
};

const say = (text, bad = false, busy = false) => {
  const status = byId("status");
  status.className = bad ? "status bad" : "status";
  status.replaceChildren(...(busy ? [element("span", { class: "dot" })] : []), text);
};

const request = () => {
  const body = new FormData();
  body.append("file", chosen, chosen.name);
  const options = { view: byId("view").value.split(","), projection: byId("projection").value, size: byId("size").value };
  if (byId("deflection").value !== "own") options.deflection = Number(byId("deflection").value);
  else if (byId("mesh").files.length) body.append("mesh", byId("mesh").files[0]);
  body.append("options", JSON.stringify(options));
  return body;
};

const compare = async () => {
  if (!chosen) return;
  if (byId("deflection").value === "own" && !byId("mesh").files.length) {
    say("Choose the mesh file to compare with.", true);
    return;
  }
  byId("go").disabled = true;
  const start = performance.now();
  const tick = () => say(`Reading, tracing and comparing … ${Math.round((performance.now() - start) / 1000)} s`, false, true);
  tick();
  const timer = setInterval(tick, 1000);
  try {
    const response = await fetch("v1/compare", { method: "POST", body: request() });
    const answer = await response.json();
    if (!response.ok) {
      say(answer.title === undefined ? `The service answered with status ${response.status}.` : `${answer.title}. ${answer.detail}`, true);
      return;
    }
    showReport(byId("report"), answer, (view, role) => view.links[role]);
    const done = element("span", {}, `Done in ${((performance.now() - start) / 1000).toFixed(1)} s. `,
      element("a", { href: answer.links.page, download: "report.html" }, "Save as one file"), " · ", element("a", { href: answer.links.report, target: "_blank", rel: "noopener" }, "JSON"));
    say(done);
  } catch (error) {
    say("The service does not answer. Is it still running?", true);
  } finally {
    clearInterval(timer);
    byId("go").disabled = !chosen;
  }
};

byId("origin").textContent = location.origin;
byId("file").addEventListener("change", () => choose(byId("file").files[0]));
byId("deflection").addEventListener("change", () => { byId("mesh-label").hidden = byId("deflection").value !== "own"; });
byId("form").addEventListener("submit", (event) => { event.preventDefault(); compare(); });
for (const event of ["dragenter", "dragover"]) {
  addEventListener(event, (e) => { e.preventDefault(); byId("drop").classList.add("over"); });
}
for (const event of ["dragleave", "drop"]) {
  addEventListener(event, (e) => { e.preventDefault(); byId("drop").classList.remove("over"); });
}
addEventListener("drop", (event) => {
  if (!event.dataTransfer.files.length) return;
  choose(event.dataTransfer.files[0]);
  compare();
});
