// The part of the picture that all pictures of a view show: one scale and one centre, so that they stay synchronised,
// and the pixel that is pointed at. Coordinates are the picture's pixels; at scale 1 the whole picture is visible.

const mostPixel = 48;  // one pixel may cover at most this many screen pixels

export class Viewport {
  constructor(width, height) {
    this.width = width; this.height = height;
    this.scale = 1; this.x = width / 2; this.y = height / 2;
    this.pointed = null; this.chosen = () => {};
    this.listeners = [];
  }
  onChange(listener) { this.listeners.push(listener); }
  changed(what) { this.listeners.forEach((listener) => listener(what)); }
  look(scale, x, y) {
    const most = Math.max(1, this.width * mostPixel / 300);
    this.scale = Math.min(most, Math.max(1, scale));
    const halfX = this.width / this.scale / 2, halfY = this.height / this.scale / 2;
    this.x = Math.min(this.width - halfX, Math.max(halfX, x));
    this.y = Math.min(this.height - halfY, Math.max(halfY, y));
    this.changed("look");
  }
  // Zooms so that the point (x, y) of the picture keeps its place on the screen.
  zoom(factor, x = this.x, y = this.y) {
    const before = this.scale;
    const most = Math.max(1, this.width * mostPixel / 300), after = Math.min(most, Math.max(1, before * factor));
    this.look(after, x - (x - this.x) * before / after, y - (y - this.y) * before / after);
  }
  fit() { this.look(1, this.width / 2, this.height / 2); }
  // Shows a box of the picture, with a margin of the box's size on each side.
  show([x0, y0, x1, y1]) {
    const scale = Math.min(this.width / (3 * (x1 - x0)), this.height / (3 * (y1 - y0)), 12);
    this.look(scale, (x0 + x1) / 2, (y0 + y1) / 2);
  }
  point(x, y, by) {
    const inside = x !== null && x >= 0 && y >= 0 && x < this.width && y < this.height;
    const now = inside ? { x: Math.floor(x), y: Math.floor(y) } : null;
    if (now?.x === this.pointed?.x && now?.y === this.pointed?.y) return;
    this.pointed = now; this.pointedBy = by;
    this.changed("point");
  }
}
