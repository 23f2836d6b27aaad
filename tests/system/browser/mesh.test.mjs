// The mesh in three dimensions is measured on demand, coloured and turned, and a click describes a triangle.
import assert from "node:assert/strict";
import { test } from "node:test";
import { drop, eventually, newTab, noFaults, noViolations, sample, Server, shot, state, wellLaidOut } from "./support.mjs";

test("the mesh is measured, shown, turned, and reopened by its address", async () => {
  const server = await Server.start();
  const page = await newTab({ width: 1600, height: 1000 });
  await page.goto(server.address);
  await drop(page, sample("torus.step"));
  await state(page, "shown");
  await page.click('.solid >> text="Measure and show"');
  await page.waitForSelector(".solid[data-mesh]");
  assert.equal(await page.getAttribute(".solid", "data-mesh"), "shown", await page.textContent(".solid [role=status]"));
  assert.match(await page.textContent(".solid [role=status]"), /triangles, at most [\d.·⁻⁰¹²³⁴⁵⁶⁷⁸⁹,]+ mm off/);

  // A click on the torus names its face, and turning changes the picture.
  const holder = await page.locator(".mesh-holder").boundingBox();
  await page.locator(".mesh-holder").scrollIntoViewIfNeeded();
  const before = await page.locator(".mesh-holder").screenshot();
  await page.focus(".mesh-holder");
  for (let i = 0; i < 6; ++i) await page.keyboard.press("ArrowUp");
  await eventually(async () => assert.notDeepEqual(await page.locator(".mesh-holder").screenshot(), before));
  let told = "";
  for (let share = 0.1; share < 0.9 && !/mm$/.test(told); share += 0.04) {
    await page.locator(".mesh-holder").click({ position: { x: holder.width * share, y: holder.height / 2 } });
    told = await page.textContent(".solid [role=status]");
  }
  assert.match(told, /^.*[+−].* mm$/);
  await page.waitForURL(/solid=shown/);
  await wellLaidOut(page, "mesh");
  await noViolations(page, "mesh");
  await shot(page, "mesh", { fullPage: true });
  noFaults(page);

  const other = await newTab();
  await other.goto(page.url());
  await other.waitForSelector('.solid[data-mesh="shown"]');
  noFaults(other);
});
