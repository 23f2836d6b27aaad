// The state of the page, stored in the address after its #. Another person who opens the address sees the same state.
// Numbers are shortened, and values equal to their default are omitted.

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
  // null removes a value. With `step`, the browser's back button returns to the previous state.
  set(changes, step = false) {
    const before = this.values.toString();
    for (const [name, value] of Object.entries(changes)) {
      if (value === null || value === undefined || value === "") this.values.delete(name);
      else this.values.set(name, typeof value === "number" ? String(Number(value.toPrecision(6))) : value);
    }
    if (this.values.toString() !== before) this.write(step);
  }
  // Replaces all values at once.
  only(values, step = true) {
    this.values = new URLSearchParams(Object.entries(values).filter(([, value]) => value !== null));
    this.write(step, true);
  }
  // Writing is delayed, because a drag would write a hundred times a second, which browsers reject.
  write(step, atOnce = step) {
    clearTimeout(this.timer);
    this.step = this.step || step;
    const now = () => {
      const hash = this.values.toString(), there = location.pathname + location.search + (hash ? `#${hash}` : "");
      try {
        if (this.step) history.pushState(null, "", there); else history.replaceState(null, "", there);
      } catch (error) {
        location.hash = hash;  // a page with an opaque origin may not use the history
      }
      this.step = false;
    };
    if (atOnce) now(); else this.timer = setTimeout(now, 150);
  }
  onChange(listener) { this.listeners.push(listener); }
}
