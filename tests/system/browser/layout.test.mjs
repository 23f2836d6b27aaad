// At three widths, light and dark, nothing is too wide, nothing overlaps, and axe-core finds no violation.
import { test } from "node:test";
import { drop, newTab, noFaults, noViolations, pixelsRead, sample, Server, shot, state, wellLaidOut } from "./support.mjs";

test("a comparison at 390, 900 and 1600 pixels, light and dark", async () => {
  const server = await Server.start();
  const first = await newTab({ width: 1600, height: 1000 });
  await first.goto(server.address);
  await first.click(".options summary");
  await first.check("input[value=front]");
  await wellLaidOut(first, "options");
  await noViolations(first, "options");
  await shot(first, "options");
  await drop(first, sample("assembly.step"));
  await state(first, "shown");
  for (const colorScheme of ["light", "dark"]) {
    for (const width of [390, 900, 1600]) {
      const where = `${width}-${colorScheme}`;
      const page = await newTab({ width, height: 900, colorScheme });
      await page.goto(server.address);
      await wellLaidOut(page, `start ${where}`);
      await noViolations(page, `start ${where}`);
      await page.goto(first.url());
      await pixelsRead(page);
      await page.click(".faces tbody tr:first-child .face-name");
      for (const mode of ["Slider", "Side by side", "Onion skin", "Difference"]) {
        await page.click(`[aria-label=Pictures] >> text="${mode}"`);
        await page.waitForTimeout(50);
        await wellLaidOut(page, `${mode} ${where}`);
      }
      await noViolations(page, `result ${where}`);
      await page.click('[aria-label=Pictures] >> text="Slider"');
      const frame = await page.locator(".frame").first().boundingBox();
      await page.mouse.move(frame.x + frame.width * 0.4, frame.y + frame.height * 0.55);
      await page.waitForTimeout(150);
      await shot(page, `compare-${where}`, { fullPage: true });
      noFaults(page);
      await page.context().close();
    }
  }
});
