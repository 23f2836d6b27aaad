// Shows the difference as colours: the heat map in millimetres, its legend, and the range of the scale.
import { element, number } from "./dom.js";
import { border, css, diverging, onlyMesh, onlySurface, paper, roundUp } from "./colors.js";

const steps = 512;
const ramp = Array.from({ length: 2 * steps + 1 }, (_, i) => diverging((i - steps) / steps));
// Borders between faces of the direct image are drawn as faint lines, for orientation.
const lineLight = 0.8;
const special = [paper, null, border, onlySurface, onlyMesh];

// Returns a canvas of the planes' size.
export const heatMap = (pixels, range) => {
  const canvas = new OffscreenCanvas(pixels.width, pixels.height), context = canvas.getContext("2d");
  const image = context.createImageData(pixels.width, pixels.height), { data } = image, { faces, width } = pixels;
  for (let i = 0; i < pixels.deviations.length; ++i) {
    const kind = pixels.status[4 * i];
    const color = kind === 1 ? ramp[steps + Math.round(Math.max(-1, Math.min(1, pixels.deviations[i] / range)) * steps)] : special[kind];
    const light = (i + 1) % width !== 0 && (faces[i] !== faces[i + 1] || (i + width < faces.length && faces[i] !== faces[i + width])) ? lineLight : 1;
    data[4 * i] = light * color[0]; data[4 * i + 1] = light * color[1]; data[4 * i + 2] = light * color[2]; data[4 * i + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return canvas;
};

// Returns the default range of the scale.
export const usualRange = (difference) => roundUp(Math.max(difference.deviation_mm.p99, difference.noise_mm, 1e-9));

// Returns the legend. `changed` receives the range that the user selects, or null for the default. `ends` are the words
// for blue and red. `noun` names the representation with which the surfaces are compared; pixels at which only one of
// the two is hit have colours of their own. It is null for a legend without a picture.
export const heatLegend = (usual, changed, ends = ["mesh nearer", "mesh farther"], noun = "mesh") => {
  const ticks = element("div", { class: "ticks" });
  const input = element("input", { type: "number", min: "0", step: "any", inputmode: "decimal" });
  const slide = element("input", { type: "range", min: "-9", max: "3", step: "0.01", "aria-label": "Range of the colours, as a power of ten in mm" });
  const usualButton = element("button", { type: "button", class: "small", on: { click: () => changed(null) } }, "default");
  const show = (range) => {
    ticks.replaceChildren(...[-1, -0.5, 0, 0.5, 1].map((t) => element("span", {}, t === 0 ? "0" : `${t > 0 ? "+" : "−"}${number(Math.abs(t) * range).replace(/\.?0+·/, "·")}`)));
    if (document.activeElement !== input) input.value = Number(range.toPrecision(3));
    slide.value = Math.log10(range);
    slide.setAttribute("aria-valuetext", `${number(range)} mm`);
    usualButton.disabled = range === usual;
  };
  input.addEventListener("change", () => { if (input.valueAsNumber > 0) changed(input.valueAsNumber); });
  slide.addEventListener("input", () => changed(Number((10 ** slide.valueAsNumber).toPrecision(2))));
  const bar = element("canvas", { class: "ramp", width: 2 * steps + 1, height: 1, "aria-hidden": "true" });
  const context = bar.getContext("2d");
  ramp.forEach((color, i) => { context.fillStyle = css(color); context.fillRect(i, 0, 1, 1); });
  const swatch = (color, text) => {
    const box = element("span", { class: "swatch", "aria-hidden": "true" });
    box.style.background = css(color);
    return element("span", { class: "key" }, box, text);
  };
  const root = element("div", { class: "legend" },
    element("div", { class: "bar-of-colors" }, element("span", {}, ends[0]), bar, element("span", {}, ends[1]), ticks),
    noun ? element("div", { class: "keys" }, swatch(border, "border, not measured"), swatch(onlySurface, "only the surface"), swatch(onlyMesh, `only the ${noun}`)) : null,
    element("div", { class: "range" }, element("label", {}, "Range ±", input, "mm"), slide, usualButton));
  return { root, show };
};
