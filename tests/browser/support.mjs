// What tests in a browser share: Debian's Chromium, a service of one's own, files, and what every page must keep to.
//
//   FACETLESS_SOURCE, FACETLESS_BIN   where the samples and the programs are
//   FACETLESS_PACKAGES                the folder whose node_modules has playwright-core and axe-core
//   FACETLESS_SHOTS                   optional: a folder for screenshots, for people to look at
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, mkdirSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import path from "node:path";
import { after } from "node:test";

const need = (name) => {
  if (!process.env[name]) throw new Error(`${name} is not set; run these tests through ctest`);
  return process.env[name];
};
const source = need("FACETLESS_SOURCE"), bin = need("FACETLESS_BIN"), packages = need("FACETLESS_PACKAGES");
const require = createRequire(path.join(packages, "package.json"));

// Ends the process with the status that ctest takes for "skipped", and says why.
const skip = (why) => {
  console.log(`SKIPPED ${path.basename(process.argv[1])}: ${why}`);
  process.exit(77);
};

const findChromium = () => ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const load = (name) => {
  try { return require(name); } catch (error) { return skip(`the package ${name} is not in ${packages}; build again where npm reaches its registry`); }
};

const executablePath = findChromium();
if (!executablePath) skip("chromium (a Debian package) is not installed");
const { chromium } = load("playwright-core");
const axeSource = readFileSync(require.resolve("axe-core/axe.min.js") ?? "", "utf8");

let browser;
try {
  browser = await chromium.launch({ executablePath, headless: true, args: process.getuid?.() === 0 ? ["--no-sandbox"] : [] });
} catch (error) {
  skip(`chromium does not start: ${error.message.split("\n")[0]}`);
}
const folders = [];
const servers = [];
after(async () => {
  await browser.close();
  for (const server of servers) await server.stop();
  for (const folder of folders) rmSync(folder, { recursive: true, force: true });
});

export const folder = () => {
  const made = mkdtempSync(path.join(tmpdir(), "facetless-browser-"));
  folders.push(made);
  return made;
};
export const sample = (name) => path.join(source, "samples", name);
// A real CAD file, or null where there is none.
export const cadFile = (name) => {
  const file = path.join(process.env.FACETLESS_CAD || path.join(source, "../shared/cad"), name);
  return existsSync(file) ? file : null;
};

export const run = (...words) => new Promise((resolve) => {
  const child = spawn(path.join(bin, "facetless"), words, { stdio: ["ignore", "pipe", "pipe"] });
  let out = "", errors = "";
  child.stdout.on("data", (text) => { out += text; });
  child.stderr.on("data", (text) => { errors += text; });
  child.on("close", (code) => resolve({ code, out, errors }));
});

const freePort = () => new Promise((resolve) => {
  const server = createServer().listen(0, "127.0.0.1", () => { const { port } = server.address(); server.close(() => resolve(port)); });
});

// A running `facetless serve`; it can be killed and started again on the same port and data.
export class Server {
  static async start(...options) {
    const server = await Server.prepared(...options);
    await server.start();
    return server;
  }
  // One that is still to be started: who needs keys makes them first.
  static async prepared(...options) {
    const server = new Server();
    server.port = await freePort();
    server.data = path.join(folder(), "data");
    server.options = options;
    servers.push(server);
    return server;
  }
  get address() { return `http://127.0.0.1:${this.port}/`; }
  start() {
    this.child = spawn(path.join(bin, "facetless"), ["serve", "--listen", `127.0.0.1:${this.port}`, "--data", this.data, ...this.options], { stdio: ["ignore", "pipe", "ignore"] });
    return new Promise((resolve, reject) => {
      this.child.stdout.once("data", resolve);
      this.child.once("exit", (code) => reject(new Error(`the service ended with ${code}`)));
    });
  }
  async stop(signal = "SIGKILL") {
    if (!this.child || this.child.exitCode !== null || this.child.signalCode !== null) return;
    const ended = new Promise((resolve) => { this.child.once("exit", resolve); });
    this.child.kill(signal);
    await ended;
  }
}

// A tab of its own that notes what went wrong, and every address that was asked for.
export const newTab = async ({ width = 1280, height = 900, colorScheme = "light", ...more } = {}) => {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme, ...more });
  context.setDefaultTimeout(120000);
  const page = await context.newPage();
  page.faults = []; page.asked = [];
  page.on("pageerror", (error) => page.faults.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error" && !/Failed to load resource/.test(message.text())) page.faults.push(message.text()); });
  page.on("request", (request) => page.asked.push(request.url()));
  return page;
};

// Drops files on the page as a person does.
export const drop = async (page, ...files) => {
  const contents = files.map((file) => ({ name: path.basename(file), text: readFileSync(file).toString("base64") }));
  const transfer = await page.evaluateHandle((given) => {
    const data = new DataTransfer();
    for (const { name, text } of given) data.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
    return data;
  }, contents);
  await page.dispatchEvent("#drop", "drop", { dataTransfer: transfer });
};

// Repeats what may fail until it doesn't: for pictures, which come some frames after what they show.
export const eventually = async (check) => {
  for (const last = Date.now() + 30000; ;) {
    try { return await check(); } catch (error) { if (Date.now() > last) throw error; }
    await new Promise((resume) => { setTimeout(resume, 50); });
  }
};

export const state = (page, name) => page.waitForFunction((wanted) => document.body.dataset.state === wanted, name);
export const pixelsRead = (page) => page.waitForSelector('.view[data-pixels="read"]');

export const noViolations = async (page, where) => {
  await page.evaluate(axeSource);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  assert.deepEqual(violations.map(({ id, nodes }) => `${where}: ${id}: ${nodes.map((node) => `${node.html.slice(0, 160)} (${node.failureSummary.split("\n")[1]})`).join(" | ")}`), []);
};

export const noFaults = (page) => assert.deepEqual(page.faults, []);

// Nothing sticks out sideways, and no two controls lie over each other.
export const wellLaidOut = async (page, where) => {
  const found = await page.evaluate(() => {
    const problems = [];
    const wide = document.documentElement.scrollWidth;
    if (wide > innerWidth) problems.push(`the page is ${wide} wide in a window of ${innerWidth}`);
    const controls = [...document.querySelectorAll("button, select, input:not([type=file]), summary, h1, h2, h3, dt, dd, figcaption")].filter((e) => e.checkVisibility() && !e.closest(".scroll"));
    const boxes = controls.map((e) => [e, e.getBoundingClientRect()]).filter(([, b]) => b.width > 0 && b.height > 0);
    for (let i = 0; i < boxes.length; ++i) {
      for (let j = i + 1; j < boxes.length; ++j) {
        const [a, p] = boxes[i], [b, q] = boxes[j];
        if (a.contains(b) || b.contains(a)) continue;
        const across = Math.min(p.right, q.right) - Math.max(p.left, q.left), down = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
        if (across > 1 && down > 1) problems.push(`“${a.textContent || a.id}” and “${b.textContent || b.id}” overlap`);
      }
    }
    return problems;
  });
  assert.deepEqual(found.map((problem) => `${where}: ${problem}`), []);
};

export const shot = async (page, name, more = {}) => {
  const to = process.env.FACETLESS_SHOTS;
  if (!to) return;
  mkdirSync(to, { recursive: true });
  await page.screenshot({ path: path.join(to, `${name}.png`), ...more });
};
