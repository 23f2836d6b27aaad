// Everything must work without a pointer.
import assert from "node:assert/strict";
import { test } from "node:test";
import { newTab, noFaults, pixelsRead, sample, Server, state } from "./support.mjs";

// Presses Tab until an element that matches has the focus.
const tabTo = async (page, selector, most = 120) => {
  for (let i = 0; i < most; ++i) {
    await page.keyboard.press("Tab");
    if (await page.evaluate((wanted) => document.activeElement?.matches(wanted), selector)) return;
  }
  assert.fail(`Tab does not reach ${selector}`);
};

test("a file, a mode, a pixel, a face and a range by keys alone", async () => {
  const server = await Server.start();
  const page = await newTab({ width: 1600, height: 1000 });
  // Listen before the page is loaded: only then does the browser leave the file chooser to the test, and Enter must not come
  // earlier.
  const chosen = page.waitForEvent("filechooser");
  await page.goto(server.address);
  await tabTo(page, "#file");
  await page.keyboard.press("Enter");
  await (await chosen).setFiles(sample("bracket.step"));
  await state(page, "shown");
  await pixelsRead(page);

  // On a picture, the arrows point at pixels, the read-out follows and is read aloud, and Enter selects the face.
  await tabTo(page, ".frame");
  await page.keyboard.press("ArrowRight");
  assert.match(await page.textContent(".read-out .pixel dd"), /^\d+, \d+$/);
  const before = await page.textContent(".read-out .pixel dd");
  await page.keyboard.press("ArrowDown");
  assert.notEqual(await page.textContent(".read-out .pixel dd"), before);
  assert.match(await page.textContent(".unseen"), /Pixel \d+, \d+\. Face/);
  await page.keyboard.press("Enter");
  const face = await page.getAttribute(".view", "data-face");
  assert.match(face, /^\d+$/);
  assert.equal(await page.textContent('.faces [aria-pressed="true"]'), await page.textContent(".read-out .face dd"));
  await page.keyboard.press("+");
  assert.match(await page.textContent(".zooms .facts"), /1\.5 ×/);
  await page.keyboard.press("0");
  assert.equal(await page.textContent(".zooms .facts"), "");

  // Move the seam, change the range, and select another face.
  await tabTo(page, ".tools input");
  await page.keyboard.press("End");
  await page.waitForURL(/split=1/);
  await tabTo(page, ".face-name");
  await page.keyboard.press("Space");
  assert.equal(await page.getAttribute(".faces tbody tr:first-child .face-name", "aria-pressed"), "true");
  noFaults(page);
});
