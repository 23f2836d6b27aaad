// The result of `facetless regress`: every file and view with its numbers, and the pictures of those that differ.
import { element, number, scrolling } from "./dom.js";
import { Pane } from "./pane.js";
import { Viewport } from "./viewport.js";

const pictureOf = async (source, path) => createImageBitmap(await source.file(path));

// Shows the reference to the left of a seam and the present picture to the right of it, and both separately.
const compared = (name, view, source) => {
  const holder = element("div", { class: "stage of-3" });
  Promise.all(["reference", "image"].map((role) => pictureOf(source, view.files[role]))).then(([reference, image]) => {
    const viewport = new Viewport(image.width, image.height);
    let split = 0.5;
    const panes = [];
    const pane = (label, layers, ...seam) => { panes.push(new Pane(viewport, `${label} of ${name}, view ${view.name}`, layers, ...seam)); return panes.at(-1).root; };
    const figure = (title, root) => element("figure", {}, root, element("figcaption", {}, title.map((text) => element("b", {}, text))));
    holder.replaceChildren(figure(["Reference", "Now"], pane("Reference and present picture", () => [{ picture: image, from: split }, { picture: reference, to: split }], () => split, (to) => { split = to; viewport.changed("look"); })),
      figure(["Reference"], pane("Reference", () => [{ picture: reference }])), figure(["Now"], pane("Present picture", () => [{ picture: image }])));
    viewport.onChange(() => panes.forEach((each) => each.ask()));
  });
  return holder;
};

const limits = (view, file) => (view.broken || []).map((broken) => `${broken.tolerance} ${number(broken.value)} > ${number(broken.limit)}`).join("; ") || (file.error ? file.error.message : view.status);

export const showRegress = (root, verdict, source) => {
  const rows = verdict.files.flatMap((file) => (file.views?.length ? file.views : [{ name: "–", passed: file.passed, status: "" }]).map((view) => [file, view]));
  const failed = rows.filter(([, view]) => !view.passed).length;
  const mark = (passed) => element("span", { class: passed ? "pill" : "pill bad" }, passed ? "passed" : "failed");
  root.replaceChildren(element("h1", {}, `Regression of ${verdict.manifest.split("/").pop()}`), element("p", {}, mark(verdict.passed), ` ${number(rows.length - failed)} of ${number(rows.length)} views passed`),
    ...rows.filter(([, view]) => view.files?.image).map(([file, view]) => element("section", { class: "view" }, element("div", { class: "bar" }, element("h2", {}, `${file.name}, ${view.name}`), element("span", { class: "facts" }, limits(view, file))), compared(file.name, view, source))),
    element("h2", {}, "All views"),
    scrolling("All views", element("table", {}, element("thead", {}, element("tr", {}, ["File", "view", "", "max", "mean", "share", "FLIP", "SSIM", "lost", "why"].map((head, i) => (head ? element("th", { scope: "col", class: i > 2 && i < 9 ? "n" : i === 9 ? "why" : undefined }, head) : element("td", {}))))),
      element("tbody", {}, rows.map(([file, view]) => element("tr", {}, element("th", { scope: "row", class: "name" }, file.name), element("td", {}, view.name), element("td", {}, mark(view.passed)),
        ["max", "mean", "share_over_threshold", "flip", "ssim"].map((key) => element("td", { class: "n" }, number(view.values?.[key]))), element("td", { class: "n" }, number(file.lost)), element("td", { class: "name why" }, view.passed && file.passed ? "" : limits(view, file))))))),
    element("details", {}, element("summary", {}, "The whole verdict as JSON"), element("pre", { tabindex: "0" }, JSON.stringify(verdict, null, 2))));
};
