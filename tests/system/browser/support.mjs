// Shared by tests in a browser: Debian's Chromium, a service for each test, files, and rules that every page must obey.
//
//   FACETLESS_SHOTS                   optional: a folder for screenshots, for people to look at
import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import path from "node:path";
import { after } from "node:test";
import { load, require, skip } from "../../support/node.mjs";

export { cadFile, folder, run, sample, Server } from "../../support/node.mjs";

const findChromium = () => ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
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
after(() => browser.close());

// Opens a tab that records errors and every requested address.
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

// Drops files on the page as a user does.
export const drop = async (page, ...files) => {
  const contents = files.map((file) => ({ name: path.basename(file), text: readFileSync(file).toString("base64") }));
  const transfer = await page.evaluateHandle((given) => {
    const data = new DataTransfer();
    for (const { name, text } of given) data.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
    return data;
  }, contents);
  await page.dispatchEvent("#drop", "drop", { dataTransfer: transfer });
};

// Repeats an assertion until it succeeds. Pictures change some frames after the state that they show.
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

// Checks that nothing is wider than the window, and that no two controls overlap.
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
