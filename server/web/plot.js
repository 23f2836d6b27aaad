// Plots cost against error, both on logarithmic scales: every measured point of a trade, the line of the unbeaten
// points, and a text for the point under the pointer or with the focus.
import { bytes, drawn, element, milliseconds, number } from "./dom.js";

const box = { width: 720, height: 440, left: 76, right: 16, top: 14, bottom: 52 };
const zeroBand = 44;  // room beside the axis for errors that are zero or below the reference's accuracy

const bandGap = 18;

// Returns 1, 10, 100, …, with 2 and 5 in between if there would be few.
const powers = (low, high) => {
  const decades = Math.round(Math.log10(high / low)), digits = decades <= 2 ? [1, 2, 5] : [1];
  return Array.from({ length: decades + 1 }, (_, i) => digits.map((digit) => digit * low * 10 ** i)).flat().filter((value) => value <= high * 1.001);
};
const span = (values) => [10 ** Math.floor(Math.log10(Math.min(...values))), 10 ** Math.ceil(Math.log10(Math.max(...values)) + 1e-9)];

const tickText = (value) => {
  const power = Math.floor(Math.log10(value) + 1e-9);
  return power >= -3 && power <= 4 ? String(Number(value.toPrecision(1))) : `${value > 1.5 * 10 ** power ? `${Math.round(value / 10 ** power)}·` : ""}10${[...String(power)].map((c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]).join("")}`;
};

// Returns the representations of a trade, in the order of its points. direct and mesh have fixed markers, methods are
// numbered.
export const seriesOf = (points) => {
  const others = [...new Set(points.map((point) => point.tracer))].filter((name) => name !== "direct" && name !== "mesh");
  return [{ tracer: "direct", title: "direct", kind: "direct" }, { tracer: "mesh", title: "mesh", kind: "mesh" },
    ...others.map((tracer, i) => ({ tracer, title: tracer, kind: `method-${i % 3}` }))];
};

// Every series has a marker of its own, so that colour is not the only distinction.
const marker = (kind, x, y) => {
  if (kind === "direct") return drawn("circle", { cx: x, cy: y, r: 5.5 });
  if (kind === "mesh") return drawn("rect", { x: x - 5, y: y - 5, width: 10, height: 10 });
  const corners = { "method-0": [[0, -6.5], [6.5, 5], [-6.5, 5]], "method-1": [[0, -7], [7, 0], [0, 7], [-7, 0]], "method-2": [[0, 6.5], [6.5, -5], [-6.5, -5]] }[kind];
  return drawn("polygon", { points: corners.map(([dx, dy]) => `${x + dx},${y + dy}`).join(" ") });
};

// `cost` is { title, of(point), text(value), unit, pareto }; error(point) is in mm. pointed(name | null) is called with
// the point under the pointer.
export const tradePlot = (label, points, cost, error, floor, limit, pointed) => {
  const measured = points.filter((point) => point.measured && cost.of(point) > 0);
  const above = measured.filter((point) => error(point) > floor);
  const [low, high] = span(above.length ? above.map(error) : [1e-3, 1]), [cheap, dear] = span(measured.map(cost.of));
  const start = box.left + zeroBand + bandGap, wide = box.width - start - box.right, tall = box.height - box.top - box.bottom;
  const x = (value) => (value > floor ? start + Math.log10(value / low) / Math.log10(high / low) * wide : box.left + zeroBand / 2);
  const y = (value) => box.top + tall - Math.log10(value / cheap) / Math.log10(dear / cheap) * tall;
  const line = (x1, y1, x2, y2, kind) => drawn("line", { x1, y1, x2, y2, class: kind });
  const text = (at, down, anchor, words) => drawn("text", { x: at, y: down, "text-anchor": anchor }, words);

  const axes = drawn("g", { class: "axes", "aria-hidden": "true" },
    powers(low, high).map((value) => [line(x(value * 1.0000001), box.top, x(value * 1.0000001), box.top + tall, "grid"), text(start + Math.log10(value / low) / Math.log10(high / low) * wide, box.top + tall + 18, "middle", tickText(value))]),
    powers(cheap, dear).map((value) => [line(box.left, y(value), box.width - box.right, y(value), "grid"), text(box.left - 8, y(value) + 4, "end", cost.tick(value))]),
    drawn("rect", { x: box.left, y: box.top, width: zeroBand, height: tall, class: "band" }), text(box.left + zeroBand / 2, box.top + tall + 18, "middle", "≈ 0"),
    limit ? [line(x(limit), box.top, x(limit), box.top + tall, "limit"), text(x(limit) - 5, box.top + 12, "end", "limit")] : null,
    text(start + wide / 2, box.height - 8, "middle", "error, mm"),
    drawn("text", { x: -(box.top + tall / 2), y: 16, transform: "rotate(-90)", "text-anchor": "middle" }, cost.title));

  const best = measured.filter((point) => point.pareto[cost.pareto]).sort((a, b) => error(a) - error(b));
  const path = best.map((point, i) => {
    const at = `${x(error(point)).toFixed(1)} ${y(cost.of(point)).toFixed(1)}`;
    return i === 0 ? `M${at}` : `V${y(cost.of(point)).toFixed(1)}H${x(error(point)).toFixed(1)}`;
  }).join("");
  const tip = element("div", { class: "tip", hidden: true });
  const marks = new Map(), series = seriesOf(points);
  const show = (point, mark) => {
    const words = point && [element("b", {}, point.name), element("span", {}, `${cost.text(cost.of(point))}, error ${number(error(point))} mm`), point.triangles ? element("span", {}, `${number(point.triangles)} triangles`) : null].filter(Boolean);
    tip.hidden = !point;
    if (point) {
      tip.replaceChildren(...words);
      const right = x(error(point)) > box.width * 0.6;
      tip.style.top = `${y(cost.of(point)) / box.height * 100}%`;
      tip.style.left = right ? "auto" : `${(x(error(point)) + 12) / box.width * 100}%`;
      tip.style.right = right ? `${(box.width - x(error(point)) + 12) / box.width * 100}%` : "auto";
    }
    marks.forEach((other) => other.classList.toggle("on", other === mark));
  };
  for (const point of measured) {
    const at = [x(error(point)), y(cost.of(point))], { kind } = series.find((one) => one.tracer === point.tracer);
    const shape = marker(kind, ...at);
    const mark = drawn("g", { class: `mark ${kind}`, tabindex: "0", role: "img", "aria-label": `${point.name}: ${cost.text(cost.of(point))}, error ${number(error(point))} mm`,
      on: { pointerenter: () => { show(point, mark); pointed(point.name); }, pointerleave: () => { show(null); pointed(null); }, focus: () => { show(point, mark); pointed(point.name); }, blur: () => { show(null); pointed(null); } } },
    drawn("circle", { cx: at[0], cy: at[1], r: 12, class: "reach" }), shape);
    marks.set(point.name, mark);
  }
  const svg = drawn("svg", { viewBox: `0 0 ${box.width} ${box.height}`, role: "group", "aria-label": `${label}; the table below has the numbers` }, axes, path ? drawn("path", { d: path, class: "best" }) : null, [...marks.values()]);
  const root = element("figure", { class: "plot" }, element("div", { class: "plot-area" }, svg, tip),
    element("figcaption", {}, series.map(({ kind, title }) => element("span", { class: "key" }, element("i", { class: `dot ${kind}`, "aria-hidden": "true" }), title)), element("span", { class: "key" }, element("i", { class: "dot line", "aria-hidden": "true" }), "unbeaten")));
  return { root, mark: (name) => show(measured.find((point) => point.name === name), marks.get(name)) };
};

export const timeCost = { title: "time, ms", of: (point) => point.timing_ms.total, text: milliseconds, tick: tickText, pareto: "time" };
export const memoryCost = { title: "memory, MB", of: (point) => point.peak_bytes / 1e6, text: (megabytes) => bytes(megabytes * 1e6), tick: tickText, pareto: "memory" };
