// Further requests: a mesh of the user, speed against accuracy, several views.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import { drop, folder, newTab, noFaults, noViolations, pixelsRead, sample, Server, shot, state, wellLaidOut } from "./support.mjs";

// Returns a tessellation of samples/sphere.step as an STL text.
const sphereStl = (radius, n) => {
  const at = (i, j) => {
    const u = 2 * Math.PI * i / n, v = Math.PI * (j / n - 0.5);
    return [Math.cos(u) * Math.cos(v), Math.sin(u) * Math.cos(v), Math.sin(v)].map((x) => radius * x);
  };
  const facet = (...corners) => `facet normal 0 0 0\nouter loop\n${corners.map((corner) => `vertex ${corner.join(" ")}`).join("\n")}\nendloop\nendfacet\n`;
  let text = "solid sphere\n";
  for (let i = 0; i < n; ++i) for (let j = 0; j < n; ++j) text += facet(at(i, j), at(i + 1, j), at(i + 1, j + 1)) + facet(at(i, j), at(i + 1, j + 1), at(i, j + 1));
  return `${text}endsolid sphere\n`;
};

test("a CAD file and a mesh dropped together are compared with each other", async () => {
  const mesh = path.join(folder(), "coarse.stl");
  writeFileSync(mesh, sphereStl(10, 24));
  const server = await Server.start();
  const page = await newTab();
  await page.goto(server.address);
  await drop(page, sample("sphere.step"), mesh);
  await state(page, "shown");
  await pixelsRead(page);
  assert.match(await page.textContent("#hint"), /compared with coarse\.stl/);
  assert.match(await page.textContent(".solid"), /which face each triangle belongs to/);
  noFaults(page);
});

test("four views, one after the other, keep the mode and the face", async () => {
  const server = await Server.start();
  const page = await newTab({ width: 1600, height: 1000 });
  await page.goto(server.address);
  await page.click(".options summary");
  await page.selectOption("#size", "512x512");
  for (const view of ["front", "top"]) await page.check(`input[value=${view}]`);
  await drop(page, sample("assembly.step"));
  await state(page, "shown");
  await pixelsRead(page);
  await page.click('[aria-label=Pictures] >> text="Difference"');
  await page.click(".faces tbody tr:first-child .face-name");
  const face = await page.getAttribute(".view", "data-face");
  await page.click('[aria-label=Views] >> text="front"');
  await pixelsRead(page);
  assert.equal(await page.textContent("[aria-label=Pictures] [aria-pressed=true]"), "Difference");
  assert.equal(await page.getAttribute(".view", "data-face"), face, "the face in the middle must be visible from the front, too");
  // The back button leads to a new start, and not through every drag.
  await page.waitForURL(/view=front/);
  noFaults(page);
});

test("zebra stripes on a model that is cut open, with its lines and the area of the cut", async () => {
  const server = await Server.start();
  const page = await newTab({ width: 1600, height: 1000 });
  await page.goto(server.address);
  await page.click(".options summary");
  await page.selectOption("#size", "512x512");
  await page.selectOption("#shade", "zebra");
  await page.selectOption("#lines", "visible");
  await page.fill("#section", "z=50%");
  await page.check("#sheet");
  await drop(page, sample("sphere.step"));
  await state(page, "shown");
  await pixelsRead(page);
  // The cut through the middle of the sphere has the area π r²; on the mesh it is a polygon.
  const [area, , meshArea] = await page.locator('[aria-label="Areas of the cuts"] tbody td').allTextContents();
  assert.equal(area, (Math.PI * 100).toLocaleString("en", { maximumSignificantDigits: 4 }));
  assert.ok(Number(meshArea) < Number(area) && Number(meshArea) > 300, meshArea);
  assert.match(await page.textContent(".inspection figcaption"), /zebra.*light: .* pixels/);
  assert.match(await page.textContent("#report"), /Breaks between faces/);
  const saved = page.waitForEvent("download");
  await page.click('text="Save the contact sheet"');
  assert.equal((await saved).suggestedFilename(), "sphere-sheet.png");
  await noViolations(page);
  await wellLaidOut(page);
  await shot(page, "zebra-section");
  noFaults(page);
});

test("shadows, occlusion and a ground, and what the mesh does to them", async () => {
  const server = await Server.start();
  const page = await newTab({ width: 1600, height: 1000 });
  await page.goto(server.address);
  await page.click(".options summary");
  await page.selectOption("#size", "512x512");
  await page.selectOption("#deflection", "0.01");
  await page.check("#shadows");
  await page.check("#ground");
  await page.selectOption("#ambient_occlusion", "16");
  await drop(page, sample("vase.step"));
  await state(page, "shown");
  await pixelsRead(page);
  const numbers = Object.fromEntries(await page.locator('[aria-label="Light"] tr').evaluateAll((rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent))));
  assert.match(numbers["… proven"], /^(99|100)/);
  assert.match(numbers["Shades itself falsely"], /^[1-9]/);
  await page.click('[aria-label=Pictures] >> text="Light"');
  assert.match(await page.textContent(".stage figcaption"), /the mesh shades itself/);
  await noViolations(page);
  await wellLaidOut(page);
  await shot(page, "light");
  noFaults(page);
});

test("another method for the exact side, voxels beside the mesh, and all methods on the plots", async () => {
  const server = await Server.start();
  const page = await newTab({ width: 1600, height: 1000 });
  await page.goto(server.address);
  await page.click(".options summary");
  await page.selectOption("#size", "512x512");
  await page.selectOption("#deflection", "0.01");
  assert.equal(await page.isVisible("#methods"), false);
  await page.selectOption("#method", "martin");
  await page.selectOption("#voxels", "64");
  await drop(page, sample("torus.step"));
  await state(page, "shown");
  await pixelsRead(page);
  const report = await (await fetch(new URL("v1/methods", server.address))).json();
  const offered = await page.locator("#method option").evaluateAll((all) => all.map((option) => option.value));
  assert.deepEqual(offered.toSorted(), report.methods.filter((method) => method.setting === null).map((method) => method.name).toSorted());
  assert.match(await page.textContent('[aria-label="Certificates"]'), /martin/);
  await page.click("[aria-label='Compared with'] >> text=\"Voxels 64\"");
  await pixelsRead(page);
  assert.ok(Number(await page.textContent(".faces tbody tr:first-child td:nth-child(3)")) > 0.1, "voxels of this size deviate visibly");
  await page.selectOption("#kind", "trade");
  assert.equal(await page.isVisible("#methods"), true);
  assert.equal(await page.isVisible("#method"), false);
  await noViolations(page);
  await wellLaidOut(page);
  noFaults(page);
});

test("a material, and a name that no part has", async () => {
  const server = await Server.start();
  const page = await newTab({ width: 1600, height: 1000 });
  await page.goto(server.address);
  await page.click(".options summary");
  await page.selectOption("#size", "512x512");
  await page.fill("#material", "no such part=mirror");
  await drop(page, sample("sphere.step"));
  await state(page, "problem");
  assert.match(await page.textContent("#problem"), /no such part/);
  await page.fill("#material", "*=matte; *=mirror");
  await page.click("#go");
  await state(page, "shown");
  const rays = await page.locator('[aria-label="Light"] tr:has-text("Rays") td').last().textContent();
  assert.match(rays, /^[1-9]/);
  noFaults(page);
});

test("speed against accuracy, on the page", async () => {
  const server = await Server.start("--timeout", "60");
  const page = await newTab({ width: 1600, height: 1000 });
  await page.goto(server.address);
  await page.click(".options summary");
  await page.selectOption("#kind", "trade");
  await page.selectOption("#size", "512x512");
  assert.equal(await page.textContent("#go"), "Measure");
  assert.equal(await page.isVisible("#samples"), false);
  await drop(page, sample("cone.step"));
  await state(page, "shown");
  assert.equal(await page.locator(".plot svg").count(), 2);
  assert.ok(await page.locator(".plot .mark").count() > 8);
  await wellLaidOut(page, "trade");
  await noViolations(page, "trade");
  await shot(page, "page-trade");
  noFaults(page);
});
