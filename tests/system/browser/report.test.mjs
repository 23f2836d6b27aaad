// report.html of compare, trade and regress works when it is opened from a disk, and sends no requests.
import assert from "node:assert/strict";
import { copyFileSync, mkdirSync, statSync, writeFileSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { cadFile, folder, newTab, noFaults, noViolations, pixelsRead, run, sample, shot, wellLaidOut } from "./support.mjs";

const open = async (file, hash = "", more = {}) => {
  const page = await newTab({ width: 1600, height: 1000, ...more });
  await page.goto(pathToFileURL(file).href + hash);
  return page;
};
const askedNobody = (page, file) => assert.deepEqual(page.asked.filter((url) => !url.startsWith("blob:") && !url.startsWith("data:")), [pathToFileURL(file).href]);

test("of a compare with four views", async () => {
  const out = folder(), report = path.join(out, "report.html");
  const done = await run("compare", sample("assembly.step"), "--out", out, "--size", "512x512", ...["iso", "front", "top", "right"].flatMap((view) => ["--view", view]));
  assert.equal(done.code, 0, done.errors);
  const page = await open(report);
  await pixelsRead(page);
  await page.click(".faces tbody tr:first-child .face-name");
  assert.match(await page.getAttribute(".view", "data-face"), /^\d+$/);
  await page.click('.view .bar [aria-label=Views] >> text="front"');
  await pixelsRead(page);
  await page.click('[aria-label=Pictures] >> text="Blink"');
  await page.click('text="Switch"');
  assert.match(await page.textContent(".stage figcaption"), /Baseline/);
  await page.waitForURL(/view=front/);
  await wellLaidOut(page, "report");
  await noViolations(page, "report");
  askedNobody(page, report);
  noFaults(page);

  // Open its address again; then on a phone, in dark mode.
  const other = await open(report, new URL(page.url()).hash, { width: 390, height: 800, colorScheme: "dark" });
  await pixelsRead(other);
  assert.equal(await other.textContent("[aria-label=Views] [aria-pressed=true]"), "front");
  assert.equal(await other.textContent("[aria-label=Pictures] [aria-pressed=true]"), "Blink");
  await wellLaidOut(other, "report on a phone");
  await noViolations(other, "report on a phone");
  await shot(other, "report-390-dark", { fullPage: true });

  // The printed page must have all four views.
  await page.waitForFunction(() => document.querySelectorAll(".print-only").length === 4);
  await page.emulateMedia({ media: "print" });
  assert.equal(await page.locator(".print-only canvas:visible").count(), 12);
  await shot(page, "report-print", { fullPage: true });
});

test("of a compare without a mesh has the exact half, and says why", async () => {
  const out = folder(), report = path.join(out, "report.html");
  const done = await run("compare", sample("wavy_sheet.step"), "--out", out, "--size", "256x256", "--deflection", "1e-4", "--max-view-memory", "8");
  assert.equal(done.code, 5, done.errors);
  const page = await open(report);
  await page.waitForSelector(".notice p:has-text('search tree needs more than the 8 MB of memory that it may take')");
  await page.waitForSelector(".stage canvas");
  assert.equal(await page.locator('text="Side by side"').count(), 0);
  await wellLaidOut(page, "report without a mesh");
  await noViolations(page, "report without a mesh");
  await shot(page, "report-no-mesh");
  askedNobody(page, report);
  noFaults(page);
});

test("of a compare of a real file stays below 3 MB with four views of 1024²", async (context) => {
  const file = cadFile("parts/nacelle.stp");
  if (!file) { context.skip("nacelle.stp is not there"); console.log("SKIPPED nacelle.stp: not there"); return; }
  const out = folder(), report = path.join(out, "report.html");
  const done = await run("compare", file, "--out", out, ...["iso", "front", "top", "right"].flatMap((view) => ["--view", view]));
  assert.equal(done.code, 0, done.errors);
  const { size } = statSync(report);
  console.log(`report.html of nacelle.stp, four views of 1024²: ${size} bytes`);
  assert.ok(size < 3e6, `${size} bytes`);
  const page = await open(report);
  await pixelsRead(page);
  const frame = await page.locator(".frame").first().boundingBox();
  await page.mouse.move(frame.x + frame.width * 0.5, frame.y + frame.height * 0.5);
  assert.match(await page.textContent(".read-out .deviation dd"), /mm$/);
  await shot(page, "report-nacelle", { fullPage: true });
  askedNobody(page, report);
  noFaults(page);
});

test("of a trade: points can be pointed at, and mark their row", async () => {
  const out = folder(), report = path.join(out, "report.html");
  const done = await run("trade", sample("sphere.step"), "--out", out, "--size", "300x300", "--deflections", "1e-2,1e-3");
  assert.equal(done.code, 0, done.errors);
  const page = await open(report);
  await page.locator(".plot .mark.mesh").first().hover();
  assert.match(await page.textContent(".tip:visible"), /mesh/);
  assert.match(await page.textContent("tr.marked th"), /mesh/);
  await page.click('.modes >> text="max"');
  await page.waitForURL(/error=max/);
  await wellLaidOut(page, "trade");
  await noViolations(page, "trade");
  await shot(page, "trade", { fullPage: true });
  askedNobody(page, report);
  noFaults(page);
});

test("of a regress: what failed beside its reference", async () => {
  const base = folder(), manifest = path.join(base, "manifest.json"), out = path.join(base, "out");
  mkdirSync(path.join(base, "references"));
  copyFileSync(sample("sphere.step"), path.join(base, "part.step"));
  const files = { files: [{ file: "part.step", size: "200x200", view: ["iso", "top"] }] };
  writeFileSync(manifest, JSON.stringify(files));
  assert.equal((await run("regress", manifest, "--update")).code, 0);
  copyFileSync(sample("torus.step"), path.join(base, "part.step"));
  assert.equal((await run("regress", manifest, "--out", out)).code, 2);
  const report = path.join(out, "report.html");
  const page = await open(report);
  await page.waitForSelector(".frame canvas");
  assert.equal(await page.locator(".stage").count(), 2);
  assert.match(await page.textContent("main"), /0 of 2 views passed/);
  await wellLaidOut(page, "regress");
  await noViolations(page, "regress");
  await shot(page, "regress", { fullPage: true });
  askedNobody(page, report);
  noFaults(page);
});
