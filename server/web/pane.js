// One picture of a view on the screen: a canvas that draws layers at the Viewport's position, and passes pointer and
// key events to the Viewport.
//   wheel, pinch: zoom     drag: move     click: select     arrows: point     Shift + arrows: move     + − 0: zoom, fit     Enter: select
import { element } from "./dom.js";

const tap = 4;  // a click may move by this many screen pixels

export class Pane {
  // layers() returns the layers to draw: [{ picture, alpha, from, to }], with from and to as shares of the width.
  // seam() returns null, or the place at which the picture is split; moveSeam(share) moves it.
  constructor(viewport, label, layers, seam = () => null, moveSeam = null) {
    Object.assign(this, { viewport, layers, seam, moveSeam });
    this.canvas = element("canvas", { role: "img", "aria-label": label });
    this.root = element("div", { class: "frame", tabindex: "0", role: "group", "aria-label": `${label}. Arrows point at pixels, Enter chooses the face, plus and minus zoom, 0 shows all.` }, this.canvas);
    this.root.style.aspectRatio = `${viewport.width} / ${viewport.height}`;
    this.pointers = new Map();
    this.listen();
    this.observer = new ResizeObserver(() => this.ask());
    this.observer.observe(this.root);
  }
  end() { this.observer.disconnect(); }

  ask() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.draw(); });
  }
  draw() {
    const { canvas, viewport } = this, density = devicePixelRatio || 1;
    const width = Math.round(this.root.clientWidth * density), height = Math.round(this.root.clientHeight * density);
    if (width === 0 || height === 0) return;
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    const context = canvas.getContext("2d"), size = width / viewport.width * viewport.scale;
    const left = width / 2 - viewport.x * size, top = height / 2 - viewport.y * size;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    for (const { picture, alpha = 1, from = 0, to = 1 } of this.layers()) {
      if (!picture) continue;
      context.save();
      context.beginPath();
      context.rect(from * width, 0, (to - from) * width, height);
      context.clip();
      context.globalAlpha = alpha;
      // At this magnification, single pixels are visible and are not smoothed.
      context.imageSmoothingEnabled = size * viewport.width / picture.width < 2.5;
      context.imageSmoothingQuality = "high";
      context.drawImage(picture, left, top, viewport.width * size, viewport.height * size);
      context.restore();
    }
    const seam = this.seam();
    if (seam !== null) {
      context.fillStyle = "#1f6f8b";
      context.fillRect(seam * width - density, 0, 2 * density, height);
      context.beginPath();
      context.arc(seam * width, height / 2, 9 * density, 0, 2 * Math.PI);
      context.fill();
      context.fillStyle = "#fff";
      for (const side of [-1, 1]) {
        context.beginPath();
        context.moveTo(seam * width + side * 6 * density, height / 2);
        context.lineTo(seam * width + side * 2 * density, height / 2 - 4 * density);
        context.lineTo(seam * width + side * 2 * density, height / 2 + 4 * density);
        context.fill();
      }
    }
    const { pointed } = viewport;
    if (pointed && viewport.pointedBy !== this) {
      // Mark the place that the pointer has in another picture, or that the keyboard points at in all pictures.
      const x = left + (pointed.x + 0.5) * size, y = top + (pointed.y + 0.5) * size, gap = Math.max(3 * density, size / 2 + density);
      for (const [color, thick] of [["#fff", 3], ["#111", 1]]) {
        context.strokeStyle = color; context.lineWidth = thick * density;
        context.beginPath();
        for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
          context.moveTo(x + dx * gap, y + dy * gap);
          context.lineTo(x + dx * (gap + 9 * density), y + dy * (gap + 9 * density));
        }
        context.stroke();
      }
    }
  }

  // Returns the place of an event in the picture, and as a share of the frame.
  place(event) {
    const box = this.root.getBoundingClientRect(), { viewport } = this;
    const share = (event.clientX - box.left) / box.width, size = box.width / viewport.width * viewport.scale;
    return {
      share, size, x: viewport.x + (event.clientX - box.left - box.width / 2) / size,
      y: viewport.y + (event.clientY - box.top - box.height / 2) / size, nearSeam: this.seam() !== null && Math.abs(share - this.seam()) * box.width < 16,
    };
  }
  listen() {
    const { root, viewport } = this;
    root.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && viewport.scale === 1 && event.deltaY > 0) return;
      event.preventDefault();
      const at = this.place(event);
      viewport.zoom(Math.exp(-event.deltaY / (event.ctrlKey ? 100 : 300)), at.x, at.y);
    }, { passive: false });
    root.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      const at = this.place(event);
      this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      this.drag = { moved: 0, seam: at.nearSeam };
      root.setPointerCapture(event.pointerId);
    });
    root.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"]) {
      root.addEventListener(end, (event) => {
        const was = this.pointers.delete(event.pointerId);
        root.classList.remove("panning");
        if (was && end === "pointerup" && this.drag && this.drag.moved < tap && !this.drag.seam) {
          const at = this.place(event);
          viewport.point(at.x, at.y, this);
          viewport.chosen();
        }
        if (this.pointers.size === 0) this.drag = null;
      });
    }
    root.addEventListener("pointerleave", () => { if (this.pointers.size === 0) viewport.point(null, null, this); });
    root.addEventListener("dblclick", () => viewport.fit());
    root.addEventListener("keydown", (event) => this.key(event));
    root.addEventListener("blur", () => { if (viewport.pointedBy === "keys") viewport.point(null, null, "keys"); });
  }
  move(event) {
    const { root, viewport } = this, at = this.place(event), held = this.pointers.get(event.pointerId);
    root.classList.toggle("on-seam", at.nearSeam);
    if (!held) {
      viewport.point(at.x, at.y, this);
      return;
    }
    const dx = event.clientX - held.x, dy = event.clientY - held.y;
    this.drag.moved += Math.hypot(dx, dy);
    if (this.drag.seam) {
      this.moveSeam(Math.min(1, Math.max(0, at.share)));
    } else if (this.pointers.size === 2) {
      const other = [...this.pointers].find(([id]) => id !== event.pointerId)[1];
      const before = Math.hypot(held.x - other.x, held.y - other.y), after = Math.hypot(event.clientX - other.x, event.clientY - other.y);
      const middle = this.place({ clientX: (event.clientX + other.x) / 2, clientY: (event.clientY + other.y) / 2 });
      viewport.zoom(after / Math.max(before, 1), middle.x, middle.y);
      viewport.look(viewport.scale, viewport.x - dx / 2 / at.size, viewport.y - dy / 2 / at.size);
    } else if (this.drag.moved >= tap) {
      root.classList.add("panning");
      viewport.look(viewport.scale, viewport.x - dx / at.size, viewport.y - dy / at.size);
    }
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }
  key(event) {
    const { viewport } = this, step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (step && event.shiftKey) viewport.look(viewport.scale, viewport.x + step[0] * viewport.width / viewport.scale / 10, viewport.y + step[1] * viewport.height / viewport.scale / 10);
    else if (step) {
      // Move by one pixel if it is visible, otherwise by about two screen pixels.
      const stride = Math.max(1, Math.round(viewport.width / viewport.scale / this.root.clientWidth * 2));
      const from = viewport.pointed || { x: Math.round(viewport.x), y: Math.round(viewport.y) };
      viewport.point(Math.min(viewport.width - 1, Math.max(0, from.x + step[0] * stride)), Math.min(viewport.height - 1, Math.max(0, from.y + step[1] * stride)), "keys");
    } else if (event.key === "+" || event.key === "=") viewport.zoom(1.5, viewport.pointed?.x, viewport.pointed?.y);
    else if (event.key === "-") viewport.zoom(1 / 1.5);
    else if (event.key === "0") viewport.fit();
    else if (event.key === "Enter") viewport.chosen();
    else if (event.key === "Escape") viewport.chosen(null);
    else return;
    event.preventDefault();
  }
}
