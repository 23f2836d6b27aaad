// What the page says when something fails: a broken file, a file in an unknown format, a service that crashes and restarts, a
// missing key.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import { drop, folder, newTab, noFaults, noViolations, run, sample, Server, shot, state } from "./support.mjs";

const noticeOf = async (page) => {
  await state(page, "problem");
  return { title: await page.textContent("#problem h2"), remedy: await page.textContent("#problem .remedy"), text: await page.textContent("#problem") };
};

test("a file that is none says what can be sent instead", async () => {
  const server = await Server.start();
  const page = await newTab();
  await page.goto(server.address);
  const file = path.join(folder(), "letter.step");
  writeFileSync(file, "Dear Sir or Madam");
  await drop(page, file);
  const notice = await noticeOf(page);
  assert.match(notice.remedy, /STEP/);
  assert.match(notice.text, /letter\.step/);
  assert.equal(await page.evaluate(() => document.activeElement?.textContent), notice.title, "the notice must have the focus");
  await noViolations(page, "problem");
  await shot(page, "problem");

  // The next file must work normally.
  await drop(page, sample("sphere.step"));
  await state(page, "shown");
  assert.equal(await page.textContent("#problem"), "");
  noFaults(page);
});

test("a file that lost faces names them before anything else", async () => {
  const server = await Server.start();
  const page = await newTab();
  await page.goto(server.address);
  const text = readFileSync(sample("bracket.step"), "utf8");
  const file = path.join(folder(), "lossy.step");
  writeFileSync(file, text.replace("CYLINDRICAL_SURFACE(", "CYLINDRICAL_SURFACF("));
  await drop(page, file);
  await state(page, "shown");
  assert.match(await page.textContent("#report .pill.bad"), /lost/);
  const order = await page.evaluate(() => document.querySelector("#report .notice").compareDocumentPosition(document.querySelector("#report .view")));
  assert.equal(order & 4, 4, "the notice must come before the pictures");
  await noViolations(page, "losses");
  await shot(page, "losses");
  noFaults(page);
});

test("a service that dies in the middle and comes back goes on with the job", async () => {
  const server = await Server.start();
  const page = await newTab();
  await page.goto(server.address);
  await drop(page, sample("freeform.step"));
  await page.waitForFunction(() => location.hash.includes("job="));
  await server.stop("SIGKILL");
  await page.waitForFunction(() => /does not answer/.test(document.querySelector("#progress")?.textContent || ""));
  await shot(page, "connection-lost");
  await server.start();
  await state(page, "shown");
  assert.match(page.url(), /#answer=/);
  noFaults(page);
});

test("a job's address shows the job in another tab, and its end in both", async () => {
  const server = await Server.start();
  const page = await newTab();
  await page.goto(server.address);
  await drop(page, sample("freeform.step"));
  await page.waitForFunction(() => location.hash.includes("job="));
  const other = await newTab();
  await other.goto(page.url());
  await Promise.all([state(page, "shown"), state(other, "shown")]);
  assert.equal(other.url(), page.url());
  noFaults(other);
});

test("an answer that is not kept says so", async () => {
  const server = await Server.start();
  const page = await newTab();
  await page.goto(`${server.address}#answer=${"0".repeat(64)}`);
  assert.match((await noticeOf(page)).remedy, /Send the file again/);
});

test("a service with keys asks for one, and keeps it for the tab", async () => {
  const server = await Server.prepared("--require-keys");
  const made = await run("keys", "create", server.data, "--name", "anna", "--scopes", "read,submit");
  assert.equal(made.code, 0, made.errors);
  await server.start();
  const page = await newTab();
  await page.goto(server.address);
  await drop(page, sample("sphere.step"));
  assert.match((await noticeOf(page)).remedy, /key/);
  await noViolations(page, "no key");
  await shot(page, "no-key");
  await page.fill("#key", JSON.parse(made.out).key);
  await page.keyboard.press("Enter");
  await state(page, "shown");
  await page.waitForSelector('.view[data-pixels="read"]');
  // The page fetched the pictures with the key, so no picture was requested by an address alone.
  assert.equal(await page.textContent(".zooms .facts"), "");
  await page.reload();
  await state(page, "shown");
  noFaults(page);

  // Another tab has a session of its own, and no key.
  const other = await newTab();
  await other.goto(page.url());
  assert.match((await noticeOf(other)).remedy, /key/);
});
