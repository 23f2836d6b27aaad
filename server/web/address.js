// The state that an address carries, after its #: whoever opens the address sees the same. Numbers are shortened; what has its
// default is left out.

export class Address {
  constructor() {
    this.values = new URLSearchParams(location.hash.slice(1));
    this.listeners = [];
    addEventListener("hashchange", () => {
      const now = new URLSearchParams(location.hash.slice(1));
      if (now.toString() === this.values.toString()) return;
      this.values = now;
      this.listeners.forEach((listener) => listener());
    });
  }
  get(name) { return this.values.get(name); }
  number(name, otherwise) {
    const value = Number.parseFloat(this.values.get(name));
    return Number.isFinite(value) ? value : otherwise;
  }
  // null takes a value away. `step`: the browser's way back leads to what was before.
  set(changes, step = false) {
    const before = this.values.toString();
    for (const [name, value] of Object.entries(changes)) {
      if (value === null || value === undefined || value === "") this.values.delete(name);
      else this.values.set(name, typeof value === "number" ? String(Number(value.toPrecision(6))) : value);
    }
    if (this.values.toString() !== before) this.write(step);
  }
  // These values and no others, at once.
  only(values, step = true) {
    this.values = new URLSearchParams(Object.entries(values).filter(([, value]) => value !== null));
    this.write(step, true);
  }
  // Writing is put off: a drag would write a hundred times a second, which browsers refuse.
  write(step, atOnce = step) {
    clearTimeout(this.timer);
    this.step = this.step || step;
    const now = () => {
      const hash = this.values.toString(), there = location.pathname + location.search + (hash ? `#${hash}` : "");
      try {
        if (this.step) history.pushState(null, "", there); else history.replaceState(null, "", there);
      } catch (error) {
        location.hash = hash;  // a page with an origin of its own may not do the other
      }
      this.step = false;
    };
    if (atOnce) now(); else this.timer = setTimeout(now, 150);
  }
  onChange(listener) { this.listeners.push(listener); }
}
