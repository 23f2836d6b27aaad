// Creates elements, and formats numbers for readers. Every number on the page has its unit beside it or in the head of
// its column.

// element("a", { href: "…", on: { click: handler } }, "text", child, null)
export const element = (tag, attributes = {}, ...children) => {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "on") Object.entries(value).forEach(([event, handler]) => made.addEventListener(event, handler));
    else if (value !== undefined && value !== null && value !== false) made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false));
  return made;
};

// The same for SVG elements.
export const drawn = (tag, attributes = {}, ...children) => {
  const made = document.createElementNS("http:" + "//www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "on") Object.entries(value).forEach(([event, handler]) => made.addEventListener(event, handler));
    else if (value !== undefined && value !== null) made.setAttribute(name, value);
  }
  made.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
  return made;
};

// Returns three significant digits, as a power of ten if zeros would hide them.
export const number = (value) => {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (typeof value !== "number") return String(value);
  if (value === 0 || (Number.isInteger(value) && Math.abs(value) < 1e9)) return value.toLocaleString("en");
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e7) {
    const [digits, power] = value.toExponential(2).split("e");
    return `${digits}·10${[...String(Number(power))].map((c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]).join("")}`;
  }
  return value.toLocaleString("en", { maximumSignificantDigits: size >= 100 ? 4 : 3 });
};

export const bytes = (value) => {
  if (value === null || value === undefined) return "–";
  const steps = ["bytes", "kB", "MB", "GB", "TB"];
  let step = 0;
  for (; value >= 1000 && step < 4; ++step) value /= 1000;
  return `${step === 0 ? value : value.toPrecision(3)} ${steps[step]}`;
};

export const milliseconds = (value) => {
  if (value === undefined || value === null) return "–";
  if (value >= 10000) return `${(value / 1000).toPrecision(3)} s`;
  return `${number(value >= 100 ? Math.round(value) : value)} ms`;
};

export const count = (value, what) => `${number(value)} ${what}${value === 1 ? "" : "s"}`;
export const share = (value) => (value === null || value === undefined ? "–" : `${number(value * 100)} %`);

// A region that scrolls horizontally, so that the page does not. The keyboard reaches it, too.
export const scrolling = (label, ...children) => element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label }, ...children);

// A table of rows of cells; the first cell of each row is its heading. `head` may be null.
export const table = (label, head, rows) =>
  scrolling(label, element("table", {},
    head && element("thead", {}, element("tr", {}, head.map((text, i) => (text === "" ? element("td", {}) : element("th", { class: i > 0 ? "n" : undefined, scope: "col" }, text))))),
    element("tbody", {}, rows.map((row) =>
      element("tr", {}, row.map((cell, i) => (i === 0 ? element("th", { scope: "row", class: head ? "name" : undefined }, cell) : element("td", { class: "n" }, cell))))))));

// A choice between several buttons; the selected one is pressed. choose(name) selects one without calling `changed`.
export const choice = (label, names, changed) => {
  const buttons = names.map((name) => element("button", { type: "button", on: { click: () => changed(name) } }, name));
  const choose = (name) => buttons.forEach((button) => button.setAttribute("aria-pressed", String(button.textContent === name)));
  return { root: element("div", { class: "modes", role: "group", "aria-label": label }, buttons), choose };
};

export const calm = () => matchMedia("(prefers-reduced-motion: reduce)").matches;
export const given = (value) => value !== null && value !== undefined;
