// The picture in a browser: colours, places, labels, and when it is drawn.

import assert from "node:assert/strict";
import { describe } from "node:test";

import { colourAt } from "../src/colour.js";
import { colourAtPlace, screenshot, until, untilDrawn } from "./browser.mjs";
import { Mock } from "./mock.mjs";
import { imageOf, quantised } from "./press.mjs";
import { disc, hemisphere } from "./skins.mjs";
import { shared, state, test, text, withPage } from "./with_page.mjs";

describe("picture", () => {
  test("the page loads under the content security policy and draws images", () =>
    withPage({}, async ({ page }) => {
      await untilDrawn(page);
      assert.equal(await text(page, "state"), "Live");
      assert.equal((await state(page)).skin, "mock-disc");
      await screenshot(page, "disc-light");
    }));

  // The press stands on the centre of a pixel, so that all of that pixel has one colour.
  test("a press has its colour at its place, and the far side has the colour of nothing", () => {
    const skin = disc();
    const pixel = nearestPixel(skin, [0.04, 0.03]);
    const still = { place: [...skin.pixel_centres.subarray(3 * pixel, 3 * pixel + 3)], strength: 0.1 };
    return withPage({ mock: { skin, still } }, async ({ page }) => {
      await untilDrawn(page);
      await page.keyboard.press("3");
      await page.uncheck("#show-contacts");
      await page.fill("#scale-maximum", "0.3");
      await page.press("#scale-maximum", "Enter");
      await until(page, () => window.dermatome.state().range[1] === 0.3);
      await page.waitForTimeout(300);
      const values = quantisedValues(skin, still);
      await assertColour(page, still.place, values[pixel] / 0.3);
      const far = nearestPixel(skin, [-0.06, -0.03]);
      const farPlace = [...skin.pixel_centres.subarray(3 * far, 3 * far + 3)];
      await assertColour(page, farPlace, values[far] / 0.3);
      await page.selectOption("#map", "diverging");
      await page.waitForTimeout(300);
      await assertColour(page, still.place, 0.5 + values[pixel] / 0.6, "diverging");
    });
  });

  test("a flat skin is seen from above with y upwards, a curved one at an angle with its link", async () => {
    await withPage({}, async ({ page }) => {
      await untilDrawn(page);
      const [right, up, middle] = await page.evaluate(() => {
        const { project } = window.dermatome;
        return [project(0.1, 0, 0), project(0, 0.1, 0), project(0, 0, 0)];
      });
      assert.ok(right[0] > middle[0] + 100 && Math.abs(right[1] - middle[1]) < 2);
      assert.ok(up[1] < middle[1] - 100 && Math.abs(up[0] - middle[0]) < 2);
    });
    await withPage({ mock: { skin: hemisphere() }, colorScheme: "dark" }, async ({ page }) => {
      await untilDrawn(page);
      assert.equal((await state(page)).isFlat, false);
      const [top, middle] = await page.evaluate(() => [window.dermatome.project(0, 0, 0.06), window.dermatome.project(0, 0, 0)]);
      assert.ok(top[1] < middle[1] - 50, "z is upwards");
      await screenshot(page, "hemisphere-dark");
    });
  });

  test("the latest image is drawn; the delay does not grow", () =>
    withPage({}, async ({ page }) => {
      await untilDrawn(page);
      await page.waitForTimeout(2500);
      const latencies = (await page.evaluate(() => window.dermatome.latencies)).slice(-20);
      assert.ok(latencies.length > 5);
      assert.ok(Math.max(...latencies) < 1000, `latencies ${latencies}`);
    }));

  // Bytes that wait in a socket are a queue as well: the page empties it however slow it is.
  test("on a machine that is too slow for 400 frames a second the delay does not grow", () =>
    withPage({ width: 500, height: 500 }, async ({ page }) => {
      await untilDrawn(page);
      const session = await page.context().newCDPSession(page);
      await session.send("Emulation.setCPUThrottlingRate", { rate: 12 });
      const medians = [];
      for (let i = 0; i < 4; i++) {
        const before = await page.evaluate(() => window.dermatome.framesDrawn);
        await page.waitForTimeout(1500);
        const [drawn, latencies] = await page.evaluate(() => [window.dermatome.framesDrawn, window.dermatome.latencies]);
        medians.push(latencies.slice(before - drawn).sort((a, b) => a - b)[(drawn - before) >> 1]);
      }
      assert.ok(medians.at(-1) < 2 * medians[0] + 300, `medians, ms: ${medians.map(Math.round)}`);
    }));

  test("nothing is drawn where nothing has come", () =>
    withPage({}, async ({ page, mock }) => {
      await untilDrawn(page);
      mock.isQuiet = true;
      await page.waitForTimeout(700);
      const before = await page.evaluate(() => window.dermatome.framesDrawn);
      await page.waitForTimeout(700);
      assert.equal(await page.evaluate(() => window.dermatome.framesDrawn), before);
    }));

  test("contacts have labels with kPa and N where calibrated, else with their strength", async () => {
    const still = { place: [0.02, 0.02, 0], strength: 0.123 };
    await withPage({ mock: { still } }, async ({ page }) => {
      await untilDrawn(page);
      assert.equal(await page.textContent(".contact"), "#1 strength 0.123");
    });
    await withPage({ mock: { still, skin: { ...disc(), is_calibrated: true } } }, async ({ page }) => {
      await untilDrawn(page);
      assert.match(await page.textContent(".contact"), /^#1 12\.3 kPa \d+(\.\d+)? N$/);
    });
  });

  test("faulty electrodes are told by shape and sign", () =>
    withPage({ mock: { isFaulty: true } }, async ({ page }) => {
      await untilDrawn(page);
      await page.waitForSelector(".electrode.is-open");
      assert.equal(await page.locator(".electrode").count(), 16);
      assert.equal(await page.textContent(".electrode.is-open text"), "4");
      assert.equal(await page.locator(".electrode.is-open rect").count(), 1);
      assert.equal(await page.locator(".electrode.is-shorted path").count(), 2);
      assert.match(await page.textContent(".electrode.is-worse"), /13.*!/s);
      await page.keyboard.press("4");
      assert.match(await text(page, "electrode-rows"), /4above range× no contact/);
      await screenshot(page, "electrodes-light");
    }));
});

describe("browsers", () => {
  test("without WebGL: it is said, and numbers come all the same", async () => {
    const mock = await new Mock().listen();
    const context = await shared.browser.newContext();
    const page = await context.newPage();
    await page.addInitScript(() => {
      const getContext = HTMLCanvasElement.prototype.getContext;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...rest);
      };
    });
    await page.goto(mock.url);
    await until(page, () => document.querySelector("#contact-rows tr"));
    assert.match(await page.textContent("#banners"), /needs WebGL/);
    await context.close();
    await mock.close();
  });
});

function nearestPixel({ pixel_centres: centres }, [x, y]) {
  const distance = (pixel) => Math.hypot(centres[3 * pixel] - x, centres[3 * pixel + 1] - y);
  return Array.from({ length: centres.length / 3 }, (_, pixel) => pixel).reduce((a, b) => (distance(b) < distance(a) ? b : a));
}

function quantisedValues(skin, still) {
  const { mantissas, exponent } = quantised(imageOf(skin, [{ id: 1, ...still }]));
  return Array.from(mantissas, (mantissa) => mantissa * 2 ** -exponent);
}

async function assertColour(page, place, share, map = "viridis") {
  const [shown, expected] = [await colourAtPlace(page, place), colourAt(map, share)];
  const difference = Math.max(...shown.map((part, i) => Math.abs(part - expected[i])));
  assert.ok(difference <= 3, `${map} at ${place}: ${shown} instead of ${expected}`);
}
