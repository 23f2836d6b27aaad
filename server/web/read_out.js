// Shows the data of the pixel under the pointer.
import { element, number } from "./dom.js";
import { certificates } from "./pixels.js";

const kindTexts = {
  0: "nothing is hit", 2: "border pixel: a shift by one pixel explains the difference", 3: "only the surface is hit; the mesh shows nothing", 4: "only the mesh is hit; the surface shows nothing",
};

// Deviations below `noise`, in mm, are not significant.
export const readOut = (faceName, noise) => {
  const signed = (mm) => (Math.abs(mm) <= noise ? `below ${number(noise)} mm` : `${mm < 0 ? "−" : "+"}${number(Math.abs(mm))} mm`);
  const cells = {};
  const cell = (name, title) => {
    cells[name] = element("dd", {}, "–");
    return element("div", { class: `cell ${name}` }, element("dt", {}, title), cells[name]);
  };
  const list = element("dl", { class: "read-out" }, cell("pixel", "Pixel"), cell("face", "Face"), cell("deviation", "Deviation"), cell("depth", "Depth"), cell("certificate", "Certificate"), cell("normal", "Normal"));
  const spoken = element("p", { class: "unseen", "aria-live": "polite" });
  // `pixels` may still be missing. Only keyboard moves are read aloud, because pointer moves would be announced
  // constantly.
  const show = (pointed, pixels, aloud) => {
    const known = pointed && pixels ? pixels.at(pointed.x, pointed.y) : null;
    cells.pixel.textContent = pointed ? `${pointed.x}, ${pointed.y}` : "–";
    cells.face.textContent = known?.face !== null && known !== null ? faceName(known.face) : "–";
    cells.deviation.textContent = !known ? "–" : known.kind === 1 ? signed(known.deviation) : known.kind === 0 ? "nothing hit" : ["", "", "border", "no mesh", "no surface"][known.kind];
    cells.deviation.title = known ? kindTexts[known.kind] || "" : "";
    cells.depth.textContent = known?.depth !== null && known ? `${known.depth.toFixed(3)} mm` : "–";
    cells.normal.textContent = known?.normal ? known.normal.map((n) => n.toFixed(3).replace(/^-0\.000$/, "0.000").replace("-", "−")).join(", ") : "–";
    cells.certificate.textContent = known ? certificates[known.certificate] : "–";
    cells.certificate.className = known && known.certificate > 0 ? "warn" : "";
    if (aloud && known) spoken.textContent = `Pixel ${cells.pixel.textContent}. Face ${cells.face.textContent}. Deviation ${cells.deviation.textContent}. Depth ${cells.depth.textContent}. ${cells.certificate.textContent}.`;
  };
  return { root: element("div", {}, list, spoken), show };
};
