// The form: a file, and the options of the request. Defaults are those of the command line.
import { bytes } from "./dom.js";

const byId = (id) => document.getElementById(id);
const text = (id) => byId(id).value.trim();
const isMesh = (file) => /\.(glb|stl)$/i.test(file.name);

export class Form {
  // ready() is called with a file that is to be compared at once.
  constructor(ready) {
    this.file = null; this.meshFile = null;
    byId("file").addEventListener("change", (event) => this.take([...event.target.files], ready));
    byId("mesh").addEventListener("change", (event) => { this.meshFile = event.target.files[0] || null; });
    byId("deflection").addEventListener("change", () => this.adapt());
    byId("kind").addEventListener("change", () => this.adapt());
    byId("form").addEventListener("submit", (event) => { event.preventDefault(); if (this.file) ready(); });
    for (const name of ["dragenter", "dragover"]) addEventListener(name, (event) => { event.preventDefault(); byId("drop").classList.add("over"); });
    for (const name of ["dragleave", "drop"]) addEventListener(name, (event) => { event.preventDefault(); byId("drop").classList.remove("over"); });
    addEventListener("drop", (event) => this.take([...event.dataTransfer.files], ready));
    this.adapt();
  }
  // A CAD file is compared at once. A mesh that is dropped with it or after it becomes the mesh of the comparison.
  take(files, ready) {
    const mesh = files.find(isMesh), model = files.find((file) => !isMesh(file));
    if (mesh) { this.meshFile = mesh; byId("deflection").value = "own"; }
    if (model) this.file = model;
    this.adapt();
    if (this.file && (model || mesh)) ready();
  }
  adapt() {
    const own = byId("deflection").value === "own", trade = byId("kind").value === "trade";
    byId("mesh-fields").hidden = !own || trade;
    for (const field of document.querySelectorAll(".comparison-only")) field.hidden = trade;
    for (const field of document.querySelectorAll(".trade-only")) field.hidden = !trade;
    byId("go").disabled = !this.file;
    byId("go").textContent = trade ? "Measure" : "Compare";
    byId("chosen").textContent = this.file ? this.file.name : "Drop a STEP, IGES or BREP file here";
    byId("hint").textContent = this.file ? [bytes(this.file.size), own && this.meshFile && `compared with ${this.meshFile.name}`, "drop another file to compare that instead"].filter(Boolean).join(" · ") : "or choose one. The file is sent only to the machine that serves this page.";
    byId("drop").classList.toggle("taken", Boolean(this.file));
  }
  get kind() { return byId("kind").value; }
  // Returns the options as the HTTP interface names them. Options with their default value are omitted, so that equal
  // requests are equal JSON.
  options() {
    const options = {}, set = (name, value, usual) => { if (value !== "" && value !== usual) options[name] = value; };
    const views = [...document.querySelectorAll("input[name=view]:checked")].map((box) => box.value);
    options.view = views.length ? views : ["iso"];
    set("projection", text("projection"), "orthographic");
    set("size", text("size"), "1024x1024");
    if (text("voxels") !== "none") options.voxels = text("voxels").split(",");
    if (this.kind === "trade") {
      set("methods", text("methods"), "none");
      return options;
    }
    set("method", text("method"), "certified");
    set("samples", Number(text("samples")), 4);
    set("precision", text("precision"), "standard");
    set("shade", text("shade"), "studio");
    set("lines", text("lines"), "none");
    const planes = text("section").split(/\s+/).filter(Boolean);
    if (planes.length) options.section = planes;
    set("shadows", byId("shadows").checked, false);
    set("ambient_occlusion", Number(text("ambient_occlusion")), 0);
    set("ground", byId("ground").checked, false);
    const materials = text("material").split(";").map((rule) => rule.trim()).filter(Boolean);
    if (materials.length) options.material = materials;
    for (const name of ["edges", "axes", "scale_bar", "sheet"]) set(name, byId(name).checked, false);
    set("audit", byId("audit").checked, false);
    if (text("deflection") === "own") {
      set("mesh_unit", text("mesh-unit"), "");
      set("mesh_up", text("mesh-up"), "");
    } else {
      set("deflection", Number(text("deflection")), 0.001);
      set("angular", Number(text("angular")), 20);
    }
    return options;
  }
  get needsMesh() { return this.kind !== "trade" && text("deflection") === "own"; }
}
