// report.html: one file that contains its report and its pictures.
import { Address } from "./address.js";
import { printView } from "./print_view.js";
import { showRegress } from "./regress_view.js";
import { showReport } from "./report_view.js";

const held = (id) => JSON.parse(document.getElementById(id).textContent);

const blobOf = (address) => {
  const binary = atob(address.slice(address.indexOf(",") + 1)), content = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) content[i] = binary.charCodeAt(i);
  return new Blob([content], { type: address.slice(5, address.indexOf(";")) });
};

const report = held("data"), embedded = held("pictures"), program = report.facetless;
const source = {
  roles: (view) => Object.keys(view.files || {}).filter((role) => embedded[view.files[role]]),
  blob: async (view, role) => blobOf(embedded[view.files[role]]),
  file: async (path) => blobOf(embedded[path]),
};
const place = document.getElementById("report"), address = new Address();
if (report.command === "regress") {
  showRegress(place, report, source);
} else {
  const shown = showReport(place, report, source, address);
  address.onChange(() => shown.follow());
  const idle = globalThis.requestIdleCallback || ((work) => setTimeout(work, 500));
  const views = report.trade ? [] : [...report.views], paper = document.querySelector(".views-holder");
  const printNext = async () => {
    if (views.length === 0) return;
    paper.append(await printView(report, views.shift(), source));
    idle(printNext);
  };
  idle(printNext);
}
document.getElementById("program").textContent = `Facetless ${program.version}, ${program.build}, ${program.isa}, ${program.threads} threads`;
