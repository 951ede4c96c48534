// Controls and keys in a browser.

import assert from "node:assert/strict";
import { describe } from "node:test";

import { screenshot, until, untilDrawn } from "./browser.mjs";
import { state, test, text, withPage } from "./with_page.mjs";

/** Has the mock's skin be a robot's, of which the page hears some time after it has met the program. */
function tellLateOfRobot(mock) {
  const { welcome } = mock;
  mock.welcome = (socket, request) => {
    const send = socket.send.bind(socket);
    socket.send = (data) => {
      const message = typeof data === "string" ? JSON.parse(data) : {};
      if (message.op !== "advertise") return send(data);
      const ofRobot = message.channels.map((channel) => ({ ...channel, topic: channel.topic.replace("dermatome", "arm/palm") }));
      const channels = [{ ...ofRobot[0], id: 99, topic: "/links", encoding: "json" }, ...ofRobot];
      setTimeout(send, 500, JSON.stringify({ op: "advertise", channels }));
    };
    welcome.call(mock, socket, request);
  };
}

describe("controls", () => {
  test("tare by button and by key", () =>
    withPage({}, async ({ page, mock }) => {
      await untilDrawn(page);
      await page.click("#tare");
      await until(page, () => document.getElementById("state").textContent === "Taring");
      await until(page, () => document.getElementById("state").textContent === "Live");
      await page.keyboard.press("t");
      await until(page, () => document.getElementById("state").textContent === "Taring");
      assert.equal(mock.calls.filter(({ name }) => name === "tare").length, 2);
    }));

  test("record starts and stops, with the file's name and size", () =>
    withPage({}, async ({ page, mock }) => {
      await untilDrawn(page);
      await page.keyboard.press("r");
      await until(page, () => !document.getElementById("recording-line").hidden);
      assert.match(await text(page, "recording-line"), /dermatome-2026-01-31-12-00-00\.mcap: .*[kM]B, \d+ frames/);
      assert.equal(await page.getAttribute("#record", "aria-pressed"), "true");
      await page.click("#record");
      await until(page, () => document.getElementById("recording-line").hidden);
      assert.deepEqual(mock.calls.map(({ request }) => request.start), [true, false]);
    }));

  test("a service's error stands beside its control", () =>
    withPage({ prepare: (mock) => (mock.answers.drive = () => ({ ok: false, error: "The board is busy." })) }, async ({ page, mock }) => {
      await untilDrawn(page);
      await page.keyboard.press("3");
      await page.fill("#amplitude", "9");
      await page.click("#drive-form button");
      assert.match(await text(page, "said-drive"), /2 mA at most/);
      await page.fill("#amplitude", "0.5");
      await page.selectOption("#frequency", "100000");
      await page.selectOption("#gain", "8");
      await page.click("#drive-form button");
      await until(page, () => document.getElementById("said-drive").textContent === "The board is busy.");
      assert.deepEqual(mock.calls.at(-1).request, { frequency_hz: 100000, amplitude_ma: 0.5, gain: 8 });
      await screenshot(page, "settings-light");
    }));

  test("patch and threshold", () =>
    withPage({}, async ({ page, mock }) => {
      await untilDrawn(page);
      await page.keyboard.press("3");
      await page.selectOption("#patch", "1");
      await page.fill("#threshold", "0.2");
      await page.press("#threshold", "Enter");
      await page.click("#threshold-default");
      await page.waitForTimeout(200);
      assert.deepEqual(mock.calls.map(({ name, request }) => [name, request]), [
        ["patch", { index: 1 }],
        ["threshold", { value: 0.2 }],
        ["threshold", { value: 0 }],
      ]);
      await page.click("#tab-contacts");
      await until(page, () => document.getElementById("session").textContent.includes("greit, noise figure 0.5"));
    }));

  test("check lists faults and notes with advice", () =>
    withPage({}, async ({ page }) => {
      await untilDrawn(page);
      await page.keyboard.press("4");
      await page.click("#check");
      assert.equal(await text(page, "said-check"), "Checking. Do not touch the skin.");
      await page.waitForSelector(".findings");
      assert.match(await text(page, "check-result"), /Fault: Electrode 4 has no contact\.Look at its wire/);
      assert.match(await text(page, "check-result"), /Note: Electrode 13/);
    }));

  test("calibrate takes readings of the strongest contact and sends three", () => {
    const still = { place: [0.02, 0.02, 0], strength: 0.12 };
    return withPage({ mock: { still } }, async ({ page, mock }) => {
      await untilDrawn(page);
      await page.keyboard.press("5");
      await page.click("#take-reading");
      assert.match(await text(page, "said-reading"), /Type the pressure first/);
      for (const [i, pressure] of ["10", "20", "30", "40"].entries()) {
        still.strength = 0.1 * (i + 1);
        await page.waitForTimeout(150);
        await page.fill("#pressure", pressure);
        await page.click("#take-reading");
        await until(page, (count) => document.querySelectorAll("#readings tr").length === count, i + 1);
      }
      await page.click("#readings tr:nth-child(2) button");
      await screenshot(page, "calibrate-light");
      await page.click("#calibrate");
      await until(page, () => document.getElementById("said-calibrate").textContent.startsWith("Fitted 3 readings"));
      const { readings } = mock.calls.at(-1).request;
      assert.deepEqual(readings.map(({ pressure_kpa }) => pressure_kpa), [10, 30, 40]);
      readings.forEach(({ strength }, i) => assert.ok(Math.abs(strength - [0.1, 0.3, 0.4][i]) < 0.02, `strength ${strength}`));
      await until(page, () => document.querySelector(".contact").textContent.includes("kPa"));
    });
  });

  test("a reading without a contact says so", () =>
    withPage({ prepare: (mock) => (mock.isQuiet = true) }, async ({ page }) => {
      await until(page, () => window.dermatome?.state().skin);
      await page.keyboard.press("5");
      await page.fill("#pressure", "10");
      await page.click("#take-reading");
      await until(page, () => document.getElementById("said-reading").textContent.startsWith("No contact was seen"));
    }));

  test("the scope asks for the slot while it is seen, and no longer", () =>
    withPage({ colorScheme: "dark" }, async ({ page, mock }) => {
      await untilDrawn(page);
      await page.keyboard.press("6");
      await page.selectOption("#slot", "3");
      await until(page, () => document.getElementById("scope-text").textContent.startsWith("Slot 3, gain 8"));
      await screenshot(page, "scope-dark");
      await page.click("#tab-contacts");
      await page.waitForTimeout(200);
      assert.deepEqual(mock.calls.filter(({ name }) => name === "scope").map(({ request }) => request.slot), [0, 3, null]);
      assert.ok(![...mock.clients][0].subscriptions.values().toArray?.().includes("/dermatome/scope"));
    }));

  test("plots of a robot that the program tells of late are those of its skins alone", () =>
    withPage({ prepare: tellLateOfRobot }, async ({ page }) => {
      await until(page, () => window.dermatome.state().robot?.contacts.length > 0);
      await page.keyboard.press("2");
      await until(page, () => document.querySelectorAll("#plot-skins li").length > 0);
      assert.deepEqual(await page.locator("#plot-skins li").allTextContents(), ["palm"]);
    }));

  test("plots show the last minute", () =>
    withPage({ colorScheme: "dark" }, async ({ page }) => {
      await untilDrawn(page);
      await page.keyboard.press("2");
      await page.waitForTimeout(2500);
      const now = await page.locator(".plot:not([hidden]) output").allTextContents();
      assert.equal(now.length, 5);
      assert.equal(now[1], "2");
      assert.equal(now[2], "400");
      await screenshot(page, "plots-dark");
    }));
});

describe("keys", () => {
  test("panels, colour map, scale, hold, help", () =>
    withPage({}, async ({ page }) => {
      await untilDrawn(page);
      for (const [key, panel] of [["2", "plots"], ["6", "scope"], ["1", "contacts"]]) {
        await page.keyboard.press(key);
        assert.equal((await state(page)).panel, panel);
      }
      await page.keyboard.press("c");
      assert.equal((await state(page)).map, "cividis");
      await page.keyboard.press("a");
      await page.keyboard.press("]");
      assert.equal((await state(page)).isScaleAutomatic, false);
      await page.keyboard.press(" ");
      await until(page, () => !document.getElementById("held").hidden);
      const { sequence } = await state(page);
      await page.waitForTimeout(400);
      assert.equal((await state(page)).sequence, sequence);
      await page.keyboard.press(" ");
      await until(page, (held) => window.dermatome.state().sequence > held, sequence);
      await page.keyboard.press("?");
      assert.equal(await page.locator("#help[open]").count(), 1);
      await screenshot(page, "help-light");
      await page.keyboard.press("Escape");
      assert.equal(await page.locator("#help[open]").count(), 0);
    }));

  test("keys do nothing while a number is typed", () =>
    withPage({}, async ({ page, mock }) => {
      await untilDrawn(page);
      await page.keyboard.press("3");
      await page.focus("#amplitude");
      await page.keyboard.press("1");
      await page.keyboard.press("t");
      assert.equal((await state(page)).panel, "settings");
      assert.equal(mock.calls.length, 0);
    }));

  test("the picture turns and zooms by keys, and v brings it back", () =>
    withPage({}, async ({ page }) => {
      await untilDrawn(page);
      const corner = () => page.evaluate(() => window.dermatome.project(0.1, 0.05, 0));
      const first = await corner();
      await page.focus("#canvas");
      await page.keyboard.press("ArrowLeft");
      await page.keyboard.press("ArrowUp");
      await page.keyboard.press("+");
      const turned = await corner();
      assert.ok(Math.hypot(turned[0] - first[0], turned[1] - first[1]) > 5);
      await page.keyboard.press("v");
      const again = await corner();
      assert.ok(Math.hypot(again[0] - first[0], again[1] - first[1]) < 0.5);
    }));

  test("every control can be reached by Tab and has a name", () =>
    withPage({}, async ({ page }) => {
      await untilDrawn(page);
      const nameless = await page.evaluate(() =>
        [...document.querySelectorAll("button:not([hidden]), input, select")].filter(
          (control) => !(control.textContent.trim() || control.labels?.[0]?.textContent.trim() || control.getAttribute("aria-label")),
        ).map((control) => control.id),
      );
      assert.deepEqual(nameless, []);
      await page.keyboard.press("Tab");
      assert.equal(await page.evaluate(() => document.activeElement.id), "tare");
      const outline = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
      assert.equal(outline, "solid");
    }));
});
