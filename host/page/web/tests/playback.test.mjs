// Recordings in a browser.

import assert from "node:assert/strict";
import { describe } from "node:test";

import { openPage, screenshot, until, untilDrawn } from "./browser.mjs";
import { Mock } from "./mock.mjs";
import { record } from "./recordings.mjs";
import { hemisphere } from "./skins.mjs";
import { shared, state, test, text, withPage } from "./with_page.mjs";

describe("recordings", () => {
  const open = (page, buffer, name = "press.mcap") => page.setInputFiles("#file", { name, mimeType: "", buffer });

  test("a recording is shown, scrubbed, stepped and closed", async () => {
    const buffer = await record({ seconds: 3, rate: 100, mock: new Mock({ skin: hemisphere(), rate: 100 }) });
    await withPage({}, async ({ page }) => {
      await untilDrawn(page);
      await open(page, buffer);
      await until(page, () => window.dermatome.state().skin === "mock-hemisphere");
      assert.equal(await text(page, "state"), "Recording");
      const duration = (await state(page)).recording.duration;
      assert.ok(Math.abs(duration - 2.99) < 1e-6, `duration ${duration}`);
      await page.locator("#position").fill("1.5");
      await until(page, () => window.dermatome.state().sequence === 150);
      await page.keyboard.press("ArrowRight");
      await until(page, () => window.dermatome.state().sequence === 151);
      await page.keyboard.press("ArrowLeft");
      await page.keyboard.press("ArrowLeft");
      await until(page, () => window.dermatome.state().sequence === 149);
      assert.match(await text(page, "time"), /^0:01\.490 \/ 0:02\.990$/);
      await screenshot(page, "recording-light");
      await page.keyboard.press(" ");
      await until(page, () => window.dermatome.state().sequence > 180);
      assert.equal(await page.isDisabled("#tare"), true);
      await page.click("#close-recording");
      await until(page, () => window.dermatome.state().skin === "mock-disc" && window.dermatome.state().sequence > 0);
      assert.equal(await text(page, "state"), "Live");
    });
  });

  test("of several skins in a file one is chosen, at the same time", async () => {
    const mocks = { "arm/palm": new Mock({ rate: 100 }), "arm/back": new Mock({ rate: 100, skin: hemisphere() }) };
    const buffer = await record({ seconds: 3, mocks });
    await withPage({}, async ({ page }) => {
      await untilDrawn(page);
      assert.equal(await page.isVisible("#skin-choice"), false, "the program has one skin");
      await open(page, buffer, "robot.mcap");
      await until(page, () => window.dermatome.state().recording && window.dermatome.state().skin === "mock-disc");
      assert.deepEqual(await page.locator("#skin-choice option").allTextContents(), ["arm/palm", "arm/back"]);
      await page.locator("#position").fill("1.5");
      await until(page, () => window.dermatome.state().sequence === 150);
      await page.selectOption("#skin-choice", "arm/back");
      await until(page, () => window.dermatome.state().skin === "mock-hemisphere" && window.dermatome.state().sequence === 150);
      assert.equal((await state(page)).recording.isPlaying, false);
      await screenshot(page, "recording-skins");
      await page.click("#close-recording");
      await until(page, () => window.dermatome.state().skin === "mock-disc" && window.dermatome.state().sequence > 0);
      assert.equal(await page.isVisible("#skin-choice"), false);
    });
  });

  // A hand that turns, with a link that does not, and a skin whose board comes after a second.
  const transform = (parent, child, x, angle = 0) => ({
    header: header(parent),
    child_frame_id: child,
    transform: { translation: { x, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: Math.sin(angle / 2), w: Math.cos(angle / 2) } },
  });
  const header = (frame) => ({ stamp: { sec: 0, nanosec: 0 }, frame_id: frame });
  const corners = [[0, 0, 0], [0.5, 0, 0], [0.5, 0.05, 0]].map(([x, y, z]) => ({ x, y, z }));
  const ARM = [
    ["/links", { markers: [{ header: header("base"), points: corners }] }, -1],
    ["/tf_static", { transforms: [transform("hand", "arm/palm", 0.3), transform("base", "arm/back", -0.3)] }, -1],
    ...Array.from({ length: 80 }, (_, i) => i / 20 - 1).map((time) => ["/tf", { transforms: [transform("base", "hand", 0.1, time >= 2 ? Math.PI / 2 : 0)] }, time]),
  ];

  test("of a robot all of it is shown and scrubbed, and each of its skins by itself", async () => {
    const place = [0.02, 0.02, 0];
    const still = { place, strength: 0.123 };
    const mocks = { "arm/palm": new Mock({ rate: 100, still }), "arm/back": new Mock({ rate: 100, skin: hemisphere(), still: { place: [0, 0, 0.06], strength: 0.1 } }) };
    const buffer = await record({ seconds: 3, mocks, begins: { "arm/back": 1 }, robot: ARM });
    await withPage({}, async ({ page }) => {
      await untilDrawn(page);
      await open(page, buffer, "robot.mcap");
      const touched = (spaces) => until(page, (expected) => window.dermatome.state().robot?.contacts.map(({ space }) => space).join() === expected, spaces.join());
      const palmAt = (x, y) => until(page, ([x, y]) => {
        const palm = window.dermatome.state().robot.contacts.find(({ space }) => space === "arm/palm");
        return palm && Math.hypot(palm.position.x - x, palm.position.y - y) < 0.01;
      }, [x, y]);
      await touched(["arm/palm"]);
      assert.deepEqual(await page.locator("#skin-choice option").allTextContents(), ["Whole robot", "arm/palm", "arm/back"]);
      assert.deepEqual((await state(page)).robot.links, ["base"]);
      assert.ok(Math.abs((await state(page)).recording.duration - 2.99) < 1e-6, "the second before the first frame is left out");
      await palmAt(0.42, 0.02);
      assert.equal(await page.title(), "arm – Dermatome");
      await page.locator("#position").fill("2.5");
      await touched(["arm/palm", "arm/back"]);
      await palmAt(0.08, 0.32);
      await page.keyboard.press("1");
      assert.match(await text(page, "session"), /palmLive, 1 contact.*backLive, 1 contact/);
      await screenshot(page, "recording-robot");
      await page.locator("#position").fill("0.5");
      await touched(["arm/palm"]);
      await palmAt(0.42, 0.02);
      await page.selectOption("#skin-choice", "arm/back");
      await until(page, () => window.dermatome.state().skin === "mock-hemisphere" && window.dermatome.state().recording.seconds === 0.5);
      await page.selectOption("#skin-choice", "*");
      await touched(["arm/palm"]);
      await page.keyboard.press(" ");
      await touched(["arm/palm", "arm/back"]);
      await page.click("#close-recording");
      await until(page, () => !window.dermatome.state().robot && window.dermatome.state().skin === "mock-disc" && window.dermatome.state().sequence > 0);
    });
  });

  test("the plots show the minute before the position, wherever one scrubs", async () => {
    const buffer = await record({ seconds: 6, rate: 50 });
    await withPage({}, async ({ page }) => {
      await untilDrawn(page);
      await open(page, buffer);
      await until(page, () => window.dermatome.state().recording);
      await page.keyboard.press("2");
      for (const seconds of ["5", "2", "4"]) {
        await page.locator("#position").fill(seconds);
        await page.waitForTimeout(500);
        const [plotted, shown] = await page.evaluate(() => [
          Number(document.querySelector(".plot:not([hidden]) output").textContent),
          window.dermatome.state().contacts.reduce((sum, { strength }) => sum + strength, 0),
        ]);
        assert.ok(Math.abs(plotted - shown) < 0.01, `at ${seconds} s: ${plotted} and ${shown}`);
      }
      await screenshot(page, "recording-plots-light");
    });
  });

  test("a recording that was cut is shown up to its last whole chunk", async () => {
    const whole = await record({ seconds: 3, rate: 100 });
    await withPage({}, async ({ page }) => {
      await open(page, whole.subarray(0, Math.floor(whole.length * 0.6)));
      await until(page, () => window.dermatome.state().recording?.isCut && window.dermatome.state().sequence === 0);
      const { duration } = (await state(page)).recording;
      assert.ok(duration > 1 && duration < 2, `duration ${duration}`);
      assert.match(await text(page, "banners"), /The file was cut/);
    });
  });

  test("a file is opened where it is dropped, also without the program", async () => {
    const buffer = await record({ seconds: 1, rate: 50 });
    const mock = await new Mock().listen();
    const { page, errors, close } = await openPage(shared.browser, mock.url);
    await untilDrawn(page);
    await mock.close();
    const transfer = await page.evaluateHandle((bytes) => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([Uint8Array.from(bytes)], "dropped.mcap"));
      return transfer;
    }, [...buffer]);
    await page.dispatchEvent("body", "drop", { dataTransfer: transfer });
    await until(page, () => window.dermatome.state().recording && window.dermatome.state().sequence === 0);
    assert.equal(await text(page, "playback-name"), "dropped.mcap");
    assert.deepEqual(errors, []);
    await close();
  });

  const wrong = [
    ["no MCAP", Buffer.from("PK\u0003\u0004 this is a zip file"), /photo\.mcap cannot be shown\. The file is not MCAP/],
    ["empty", Buffer.alloc(0), /The file is empty/],
    ["of another program", undefined, /no images or contacts/],
    ["cut before the first chunk", null, /The recording is empty/],
  ];
  for (const [what, given, words] of wrong) {
    test(`a file that is ${what}: words`, async () => {
      const whole = await record({ seconds: 0.1, topics: ["/dermatome/measurements", "/dermatome/status"] });
      const buffer = given === undefined ? whole : (given ?? whole.subarray(0, 60));
      await withPage({}, async ({ page }) => {
        await untilDrawn(page);
        await open(page, buffer, "photo.mcap");
        await until(page, () => document.getElementById("said-actions").textContent.includes("cannot be shown"));
        assert.match(await text(page, "said-actions"), words);
        assert.equal((await state(page)).recording, undefined);
      });
    });
  }
});
