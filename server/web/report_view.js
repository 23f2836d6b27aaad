// A whole report: losses, views, numbers. The page of the service and report.html both call showReport.
import { choice, element, number } from "./dom.js";
import { continuityTables, sectionTables } from "./measures.js";
import { lossNotice, lostCount, modelFacts, truthReport, verdictNotice } from "./truth.js";
import { tradeSection } from "./trade_view.js";
import { ViewBench } from "./view.js";

const sections = (report, source, address, holder) => {
  if (report.trade) {
    const trades = report.views.map((view) => tradeSection(view, report.trade, address));
    holder.replaceChildren(...trades.map((trade) => trade.root));
    return { follow: () => trades.forEach((trade) => trade.follow()), end: () => {} };
  }
  // The screen shows one view at a time; the printed page shows all of them.
  let bench = null;
  const names = report.views.map((view) => view.name);
  const tabs = choice("Views", names, (name) => { address.set({ view: name === names[0] ? null : name, zoom: null, x: null, y: null }); show(); });
  const place = element("div", { class: "on-screen" });
  const named = () => report.views.find((view) => view.name === address.get("view")) || report.views[0];
  const show = () => {
    bench?.end();
    bench = new ViewBench(report, named(), source, address, names.length > 1 ? tabs.root : null, show);
    tabs.choose(bench.view.name);
    place.replaceChildren(bench.root);
  };
  holder.replaceChildren(place);
  show();
  return {
    follow: () => { if (named() !== bench.view || ViewBench.chosen(bench.candidates, address) !== bench.candidate) show(); else bench.follow(); },
    end: () => bench.end(),
  };
};

// `source` has the pictures: roles(view), blob(view, role). `tools` are shown beside the title, `extra` after the
// views.
export const showReport = (root, report, source, address, tools = null, extra = null) => {
  const model = report.model, lost = lostCount(model), broken = (report.verdict?.broken || []).length > 0;
  const holder = element("div", { class: "views-holder" });
  root.replaceChildren(...[
    element("div", { class: "bar title" }, element("h1", { tabindex: "-1" }, model.file || "Report"), element("span", { class: lost || broken ? "pill bad" : "pill" }, broken ? "thresholds exceeded" : lost ? `${number(lost)} lost` : "nothing lost"), tools),
    modelFacts(model), lossNotice(model), verdictNotice(report.verdict), holder, sectionTables(report.sections), continuityTables(report.continuity), extra, truthReport(model),
    element("details", {}, element("summary", {}, "The whole report as JSON"), element("pre", { tabindex: "0" }, JSON.stringify(report, null, 2)))].flat().filter(Boolean));
  return sections(report, source, address, holder);
};
