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

const stages = { queued: "Waiting for its turn", read: "Reading", transfer: "Reading", convert: "Converting", mesh: "Tessellating", compare: "Tracing and comparing", publish: "Storing the pictures" };

// Asks for the job until it has ended; its result, or its problem. A service that is being restarted is asked again.
const atItsEnd = async (job, report) => {
  let failures = 0;
  while (job.state === "queued" || job.state === "running") {
    if (stages[job.stage]) report(stages[job.stage]);
    await new Promise((resolve) => { setTimeout(resolve, 500); });
    try {
      const response = await fetch(job.links.self.slice(1));
      if (response.status === 404) return await response.json();
      if (response.ok) job = await response.json();
      failures = 0;
    } catch (error) {
      if (++failures > 20) throw error;
    }
  }
  if (job.state === "done" && job.result) return job.result;
  return job.problem || { title: "The job was cancelled", detail: "Send it again if needed." };
};

const compare = async () => {
  if (!chosen) return;
  if (byId("deflection").value === "own" && !byId("mesh").files.length) {
    say("Choose the mesh file to compare with.", true);
    return;
  }
  byId("go").disabled = true;
  const start = performance.now();
  let doing = "Reading, tracing and comparing";
  const tick = () => say(`${doing} … ${Math.round((performance.now() - start) / 1000)} s`, false, true);
  tick();
  const timer = setInterval(tick, 1000);
  try {
    const response = await fetch("v1/comparisons", { method: "POST", headers: { Prefer: "wait=2" }, body: request() });
    let answer = await response.json();
    if (response.status === 202) answer = await atItsEnd(answer, (stage) => { doing = stage; });
    if (!response.ok || answer.views === undefined) {
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
