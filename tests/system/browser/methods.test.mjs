// A method that the page does not know appears as one more choice beside the baseline, with a picture, a difference and a
// table.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { newTab, noFaults, noViolations, pixelsRead, sample, Server, shot } from "./support.mjs";

Server.program = "facetless-with-box";

const compare = async (server, options) => {
  const form = new FormData();
  form.append("file", new Blob([readFileSync(sample("bracket.step"))]), "bracket.step");
  form.append("options", JSON.stringify(options));
  const answer = await fetch(new URL("v1/comparisons", server.address), { method: "POST", body: form, headers: { Prefer: "wait=60" } });
  assert.equal(answer.status, 200, await answer.clone().text());
  return answer.json();
};

test("candidates are a choice beside the slider, and the address keeps it", async () => {
  const server = await Server.start();
  const answer = await compare(server, { size: "256x256", with: ["box:100", "fast"] });
  const page = await newTab({ width: 1500, height: 1000 });
  const show = `${server.address}#answer=${answer.links.self.split("/").pop()}`;
  await page.goto(show);
  await pixelsRead(page);
  const choices = () => page.$$eval("[aria-label='Compared with'] button", (buttons) => buttons.map((button) => [button.textContent, button.getAttribute("aria-pressed")]));
  assert.deepEqual(await choices(), [["Baseline", "true"], ["Box 100", "false"], ["Single precision", "false"]]);
  const worst = () => page.textContent(".faces tbody tr:first-child td:nth-child(3)");
  const ofMesh = Number(await worst());

  await page.click("text=Box 100");
  await pixelsRead(page);
  assert.deepEqual((await choices())[1], ["Box 100", "true"]);
  assert.ok(Number(await worst()) > ofMesh, "a box must deviate more than a mesh");
  await page.waitForURL(/with=box-100/);
  await noViolations(page, "candidate");
  await shot(page, "candidate");
  for (const mode of ["Side by side", "Blink", "Onion skin", "Box 100", "Difference"]) {
    await page.click(`[aria-label=Pictures] >> text="${mode}"`);
    assert.equal(await page.textContent("[aria-label=Pictures] [aria-pressed=true]"), mode);
  }
  assert.deepEqual(await page.$$eval(".cost th[scope=col]", (heads) => heads.map((head) => head.textContent)), ["direct", "baseline", "box 100", "single precision"]);

  const other = await newTab({ width: 1500, height: 1000 });
  await other.goto(page.url());
  await pixelsRead(other);
  assert.deepEqual(await other.$$eval("[aria-label='Compared with'] [aria-pressed=true]", (buttons) => buttons.map((button) => button.textContent)), ["Box 100"]);
  noFaults(page);
  noFaults(other);
});

test("with the mesh alone nothing is to be chosen", async () => {
  const server = await Server.start();
  const answer = await compare(server, { size: "64x64" });
  const page = await newTab();
  await page.goto(`${server.address}#answer=${answer.links.self.split("/").pop()}`);
  await pixelsRead(page);
  assert.equal(await page.locator("[aria-label='Compared with']").count(), 0);
  noFaults(page);
});
