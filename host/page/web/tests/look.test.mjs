// Widths, themes and contrast in a browser.

import assert from "node:assert/strict";
import { describe } from "node:test";

import { screenshot, until, untilDrawn } from "./browser.mjs";
import { disc } from "./skins.mjs";
import { state, test, withPage } from "./with_page.mjs";

describe("look", () => {
  test("at the width of a phone nothing is wider than the screen, on any panel", () =>
    withPage({ width: 360, height: 740, mock: { isFaulty: true, skin: { ...disc(), is_calibrated: true } } }, async ({ page, mock }) => {
      mock.set({ warnings: ["A warning that is longer than the width of a phone, to see how it goes on."], recording: "/home/someone/recordings/dermatome-2026-01-31-12-00-00.mcap" });
      await untilDrawn(page);
      for (const [i, name] of ["contacts", "plots", "settings", "electrodes", "calibrate", "scope"].entries()) {
        await page.keyboard.press(String(i + 1));
        await page.waitForTimeout(300);
        const [width, shown] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
        assert.ok(width <= shown, `${name}: ${width} of ${shown}`);
        if (i < 2) await screenshot(page, `phone-${name}-light`);
      }
    }));

  test("light and dark follow the system until one is chosen, and the choice is remembered", () =>
    withPage({ colorScheme: "dark" }, async ({ page }) => {
      await untilDrawn(page);
      const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
      assert.equal((await state(page)).theme, "dark");
      const dark = await background();
      await page.emulateMedia({ colorScheme: "light" });
      await until(page, () => window.dermatome.state().theme === "light");
      assert.notEqual(await background(), dark);
      await page.keyboard.press("3");
      await page.check("input[value=dark]");
      assert.equal(await background(), dark);
      await page.reload();
      await untilDrawn(page);
      assert.equal((await state(page)).theme, "dark");
      await screenshot(page, "disc-dark");
    }));

  test("text has contrast in both themes", async () => {
    for (const colorScheme of ["light", "dark"]) {
      await withPage({ colorScheme }, async ({ page }) => {
        await untilDrawn(page);
        const colours = await page.evaluate(() => {
          const style = getComputedStyle(document.documentElement);
          return Object.fromEntries(["page", "surface", "text", "muted", "good", "warn", "bad", "accent", "warn-surface", "bad-surface"].map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
        });
        const pairs = [["text", "page"], ["text", "surface"], ["muted", "surface"], ["muted", "page"], ["good", "surface"], ["warn", "surface"], ["bad", "surface"], ["accent", "surface"], ["text", "warn-surface"], ["text", "bad-surface"]];
        for (const [front, back] of pairs) {
          const ratio = contrast(colours[front], colours[back]);
          assert.ok(ratio >= 4.5, `${colorScheme}: ${front} on ${back} is ${ratio.toFixed(2)}`);
        }
      });
    }
  });
});

function contrast(a, b) {
  const [lighter, darker] = [a, b].map(relativeLuminance).sort((x, y) => y - x);
  return (lighter + 0.05) / (darker + 0.05);
}

function relativeLuminance(hex) {
  const linear = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255).map((part) => (part <= 0.03928 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
  return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
}
