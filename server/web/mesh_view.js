// Shows the baseline mesh in three dimensions. Each triangle is coloured by its deviation from the exact surface. The
// deviation is measured on demand by a small comparison with mesh_deviation, which uses the mesh that the service
// keeps.
//   drag, arrows: turn     Shift + drag: move     wheel, + −: zoom     0: show all     click: describe a triangle
import { element, number } from "./dom.js";
import { diverging, roundUp } from "./colors.js";
import { heatLegend } from "./heat_map.js";

const steps3d = 512;
const toLinear = (byte) => { const x = byte / 255; return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4; };

// Decodes the layout of render/compare/mesh_deviation.h.
const decodeMesh = async (blob) => {
  const buffer = await blob.arrayBuffer(), length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length))), base = 4 + length;
  return {
    nodes: header.nodes,
    parts: header.parts.map((part) => ({
      positions: new Float32Array(buffer, base + part.positions, 9 * part.triangles), deviations: new Float32Array(buffer, base + part.deviations, part.triangles), faces: new Uint32Array(buffer, base + part.faces, part.triangles),
    })),
  };
};

class MeshScene {
  constructor(three, mesh, canvas) {
    Object.assign(this, { three, mesh, canvas });
    this.renderer = new three.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene = new three.Scene();
    this.camera = new three.OrthographicCamera();
    this.camera.up.set(0, 0, 1);
    const lamp = new three.DirectionalLight(0xffffff, 1.1);
    lamp.position.set(0.3, 0.5, 1);
    this.camera.add(lamp);
    this.scene.add(new three.AmbientLight(0xffffff, 2.2), this.camera);
    const material = new three.MeshLambertMaterial({ vertexColors: true, side: three.DoubleSide, flatShading: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.lines = new three.MeshBasicMaterial({ color: 0x333333, wireframe: true, transparent: true, opacity: 0.25, visible: false });
    this.geometries = mesh.parts.map((part) => {
      const geometry = new three.BufferGeometry();
      geometry.setAttribute("position", new three.BufferAttribute(part.positions, 3));
      geometry.setAttribute("color", new three.BufferAttribute(new Float32Array(part.positions.length), 3));
      geometry.computeVertexNormals();
      return geometry;
    });
    this.placed = [];
    for (const node of mesh.nodes) {
      for (const look of [material, this.lines]) {
        const object = new three.Mesh(this.geometries[node.part], look);
        object.matrixAutoUpdate = false;
        object.matrix.set(...node.matrix, 0, 0, 0, 1);
        object.userData = node;
        if (look === material) this.placed.push(object);
        this.scene.add(object);
      }
    }
    this.scene.updateMatrixWorld(true);
    const sphere = new three.Box3().setFromObject(this.scene).getBoundingSphere(new three.Sphere());
    this.center = sphere.center.clone(); this.radius = sphere.radius || 1;
    this.home = { yaw: -Math.PI / 4, pitch: Math.asin(1 / Math.sqrt(3)), zoom: 1 };
    this.fit();
  }
  fit() { Object.assign(this, this.home); this.target = this.center.clone(); this.ask(); }
  color(range) {
    const { three } = this, ramp = this.ramp ??= Array.from({ length: 2 * steps3d + 1 }, (_, i) => diverging((i - steps3d) / steps3d).map(toLinear));
    this.mesh.parts.forEach((part, p) => {
      const colors = this.geometries[p].getAttribute("color");
      for (let i = 0; i < part.deviations.length; ++i) {
        const color = ramp[steps3d + Math.round(Math.max(-1, Math.min(1, part.deviations[i] / range)) * steps3d)];
        for (let k = 0; k < 3; ++k) colors.array.set(color, 9 * i + 3 * k);
      }
      colors.needsUpdate = true;
    });
    this.three = three;
    this.ask();
  }
  ask() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.draw(); });
  }
  draw() {
    const { camera, renderer, canvas } = this, width = canvas.parentElement.clientWidth, height = canvas.parentElement.clientHeight;
    if (!width || !height) return;
    renderer.setPixelRatio(devicePixelRatio || 1);
    renderer.setSize(width, height, false);
    const half = this.radius * 1.05 / this.zoom, aspect = width / height;
    Object.assign(camera, { left: -half * Math.max(1, aspect), right: half * Math.max(1, aspect), top: half * Math.max(1, 1 / aspect), bottom: -half * Math.max(1, 1 / aspect), near: 0, far: 8 * this.radius });
    camera.updateProjectionMatrix();
    const level = Math.cos(this.pitch);
    camera.position.set(level * Math.cos(this.yaw), level * Math.sin(this.yaw), Math.sin(this.pitch)).multiplyScalar(4 * this.radius).add(this.target);
    camera.lookAt(this.target);
    renderer.render(this.scene, camera);
  }
  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.max(-1.55, Math.min(1.55, this.pitch + pitch));
    this.ask();
  }
  magnify(factor) { this.zoom = Math.max(0.2, Math.min(500, this.zoom * factor)); this.ask(); }
  move(dx, dy) {
    const { camera } = this, perPixel = (camera.top - camera.bottom) / this.canvas.clientHeight;
    const right = new this.three.Vector3().setFromMatrixColumn(camera.matrixWorld, 0), up = new this.three.Vector3().setFromMatrixColumn(camera.matrixWorld, 1);
    this.target.addScaledVector(right, -dx * perPixel).addScaledVector(up, dy * perPixel);
    this.ask();
  }
  // Returns the placed face and the deviation of the triangle at a place of the canvas.
  at(x, y) {
    const ray = new this.three.Raycaster();
    ray.setFromCamera(new this.three.Vector2(2 * x - 1, 1 - 2 * y), this.camera);
    const hit = ray.intersectObjects(this.placed, false)[0];
    if (!hit) return null;
    const node = hit.object.userData, part = this.mesh.parts[node.part];
    return { face: node.first_placed_face + part.faces[hit.faceIndex], deviation: part.deviations[hit.faceIndex] };
  }
  end() { this.renderer.dispose(); this.geometries.forEach((geometry) => geometry.dispose()); }
}

const listen = (scene, holder, said) => {
  let last = null, moved = 0;
  holder.addEventListener("pointerdown", (event) => { last = event; moved = 0; holder.setPointerCapture(event.pointerId); });
  holder.addEventListener("pointermove", (event) => {
    if (!last) return;
    const dx = event.clientX - last.clientX, dy = event.clientY - last.clientY;
    moved += Math.hypot(dx, dy); last = event;
    if (event.shiftKey || event.buttons === 2) scene.move(dx, dy); else scene.turn(-dx / 150, dy / 150);
  });
  holder.addEventListener("pointerup", (event) => {
    last = null;
    const box = holder.getBoundingClientRect();
    if (moved < 4) said(scene.at((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height));
  });
  holder.addEventListener("pointercancel", () => { last = null; });
  holder.addEventListener("contextmenu", (event) => event.preventDefault());
  holder.addEventListener("wheel", (event) => { event.preventDefault(); scene.magnify(Math.exp(-event.deltaY / 300)); }, { passive: false });
  holder.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (turn) scene.turn(...turn);
    else if (event.key === "+" || event.key === "=") scene.magnify(1.25);
    else if (event.key === "-") scene.magnify(0.8);
    else if (event.key === "0") scene.fit();
    else if (event.key === "Enter") said(scene.at(0.5, 0.5));
    else return;
    event.preventDefault();
  });
  new ResizeObserver(() => scene.ask()).observe(holder);
};

// Returns the request that measures the mesh of this report.
const question = (report) => {
  const baseline = report.views[0].baseline;
  return { model: report.links.model.split("/").pop(), view: "iso", size: "16x16", samples: 1, mesh_deviation: true, deflection_mm: baseline.deflection_mm, angular: baseline.angular_deg };
};

// A section that opens on demand. `nameOf` returns a face's name; the address stores whether the section is open.
export const meshSection = (report, service, address, nameOf) => {
  if (!report.views[0]?.baseline) return null;
  const place = element("div", {}), said = element("p", { class: "facts", role: "status" });
  const { from_model: named, deflection_mm: deflection } = report.views[0].baseline, foreign = !named || !deflection;
  const show = async () => {
    button.disabled = true;
    try {
      said.textContent = "Measuring every triangle …";
      const answer = report.links.mesh ? report : await service.follow(await service.post("v1/comparisons", JSON.stringify(question(report))));
      const [three, mesh] = await Promise.all([import("./three.module.js"), service.blob(answer.links.mesh).then(decodeMesh)]);
      if (!three.REVISION) throw new Error("this build does not include Three.js, because the npm registry could not be reached when it was built");
      const canvas = element("canvas", { role: "img", "aria-label": "The mesh, coloured by deviation" });
      const holder = element("div", { class: "mesh-holder", tabindex: "0", role: "group", "aria-label": "The mesh in three dimensions. Arrows turn it, plus and minus zoom, 0 shows all, Enter describes the triangle in the middle." }, canvas);
      const deviation = answer.mesh_deviation, usual = roundUp(Math.max(deviation.p99_mm, 1e-9));
      const legend = heatLegend(usual, (range) => { scene.color(range ?? usual); legend.show(range ?? usual); }, ["mesh inside", "outside"], false);
      const lines = element("label", { class: "check" }, element("input", { type: "checkbox", on: { change: (event) => { scene.lines.visible = event.target.checked; scene.ask(); } } }), " draw triangles");
      place.replaceChildren(holder, element("div", { class: "mesh-side" }, legend.root, lines));
      const scene = new MeshScene(three, mesh, canvas);
      listen(scene, holder, (hit) => { said.textContent = hit ? `${nameOf(hit.face)}: ${hit.deviation < 0 ? "−" : "+"}${number(Math.abs(hit.deviation))} mm` : "There is no triangle."; });
      scene.color(usual);
      legend.show(usual);
      said.textContent = `${number(deviation.triangles)} triangles, at most ${number(deviation.max_mm)} mm off, 99 % within ${number(deviation.p99_mm)} mm. Drag to turn the mesh; click a triangle to see its face and deviation.`;
      button.hidden = true;
      address.set({ solid: "shown" });
      root.dataset.mesh = "shown";
    } catch (error) {
      if (service.stopped.signal.aborted) return;
      said.textContent = `The mesh cannot be shown: ${[error.title || error.message, error.detail].filter(Boolean).join(". ")}.`;
      root.dataset.mesh = "failed";
      button.disabled = false;
    }
  };
  const button = element("button", { type: "button", class: "small", on: { click: show } }, "Measure and show");
  const root = element("section", { class: "solid no-print" }, element("div", { class: "bar" }, element("h2", {}, "The mesh in three dimensions"), foreign ? null : button, said), place);
  if (foreign) said.textContent = "Your own mesh does not say which face each triangle belongs to, so its triangles cannot be measured against their surfaces.";
  else if (address.get("solid")) show();
  return root;
};
