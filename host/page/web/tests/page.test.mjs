// The page in a browser against the mock of the program.

import assert from "node:assert/strict";
import { after, before, describe, test as testOf } from "node:test";

import { colourAt } from "../src/colour.js";
import { colourAtPlace, launch, missing, openPage, screenshot, until, untilDrawn } from "./browser.mjs";
import { Mock } from "./mock.mjs";
import { imageOf, quantised } from "./press.mjs";
import { record } from "./recordings.mjs";
import { disc, hemisphere } from "./skins.mjs";

let browser;
before(async () => missing || (browser = await launch()));
after(() => browser?.close());

const test = (name, act) => testOf(name, { skip: missing }, act);

/** Runs `act({ page, mock, errors })` on a page against a mock; nothing may have gone wrong in the page. */
async function withPage({ mock: mockOptions = {}, prepare, ...options }, act) {
  const mock = await new Mock(mockOptions).listen();
  prepare?.(mock);
  const opened = await openPage(browser, mock.url, options);
  try {
    await act({ ...opened, mock });
    assert.deepEqual(opened.errors, []);
  } finally {
    await opened.close();
    await mock.close();
  }
}

const state = (page) => page.evaluate(() => window.dermatome.state());
const text = (page, id) => page.textContent(`#${id}`);

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

describe("what is said", () => {
  const cases = [
    ["no_board", "No board answers on /dev/ttyACM0", "Plug it in, and look at its lamp.", "No board"],
    ["no_patch", "The board has no patch", "Install one with `dermatome install`.", "No patch"],
    ["not_tared", "The skin is not tared", "Take your hands off and tare.", "Not tared"],
    ["taring", "Taking the reference", "Do not touch the skin.", "Taring"],
    ["lost", "The board went away", "Look at its cable.", "Lost"],
    ["ended", "The replay has ended", "Start it again to see it once more.", "Ended"],
  ];
  for (const [name, words, advice, badge] of cases) {
    test(`${name}: what is missing, and what to do`, () =>
      withPage({ prepare: (mock) => mock.set({ state: name, text: words, advice }) }, async ({ page }) => {
        await until(page, (expected) => document.getElementById("situation-text").textContent === expected, words);
        assert.equal(await page.isVisible("#situation"), true);
        assert.equal(await text(page, "situation-advice"), advice);
        assert.equal(await text(page, "state"), badge);
        assert.equal(await page.isVisible("#situation-action"), name === "not_tared");
        if (name === "not_tared") await screenshot(page, "not-tared-light");
      }));
  }

  test("a skin whose shape is not known yet", () =>
    withPage({ prepare: (mock) => (mock.skin = undefined) }, async ({ page }) => {
      await until(page, () => document.getElementById("situation-text").textContent === "Waiting for the skin's shape");
    }));

  test("the program goes away: it is said; it comes back: the page is live without reloading", async () => {
    const first = await new Mock().listen();
    const { page, errors, close } = await openPage(browser, first.url);
    await untilDrawn(page);
    await first.close();
    await until(page, () => document.getElementById("situation-text").textContent === "The program `dermatome view` does not answer");
    assert.match(await text(page, "situation-advice"), /Start it again in a terminal/);
    assert.equal(await page.isDisabled("#tare"), true);
    await screenshot(page, "no-program-light");
    const second = await new Mock({ skin: hemisphere() }).listen(first.port);
    await until(page, () => window.dermatome.state().skin === "mock-hemisphere" && window.dermatome.state().sequence > 0);
    assert.equal(await page.isVisible("#situation"), false);
    assert.deepEqual(errors, []);
    await close();
    await second.close();
  });

  test("warnings are banners, each once", () =>
    withPage({ prepare: (mock) => mock.set({ warnings: ["Electrode 4 has no contact.", "The board is hot."] }) }, async ({ page, mock }) => {
      await untilDrawn(page);
      assert.deepEqual(await page.locator("#banners li").allTextContents(), ["Electrode 4 has no contact.", "The board is hot."]);
      await screenshot(page, "warnings-light");
      mock.set({ warnings: ["The board is hot."] });
      await page.waitForTimeout(1000);
      assert.equal(await page.locator("#banners li").count(), 2, "a warning stays for some seconds");
      await until(page, () => document.querySelectorAll("#banners li").length === 1);
    }));

  test("images that stop coming are noticed", () =>
    withPage({}, async ({ page, mock }) => {
      await untilDrawn(page);
      mock.isQuiet = true;
      await until(page, () => document.getElementById("banners").textContent.startsWith("No new image"));
    }));

  test("markup from the program stays text", () => {
    const evil = "<img src=x onerror=\"window.hacked=1\">";
    const prepare = (mock) => {
      mock.set({ text: evil, warnings: [evil], port: evil, board: evil, patches: [evil], recording: evil, skin: evil });
      mock.answers.check = () => ({ ok: true, summary: [evil], findings: [{ level: "fault", found: evil, advice: evil }] });
      mock.answers.tare = () => ({ ok: false, error: evil });
    };
    return withPage({ prepare }, async ({ page }) => {
      await untilDrawn(page);
      await page.click("#tare");
      await page.keyboard.press("4");
      await page.click("#check");
      await page.waitForSelector(".findings");
      assert.equal(await text(page, "status-text"), evil);
      assert.equal(await text(page, "said-actions"), evil);
      assert.equal(await page.textContent("#banners li"), evil);
      assert.match(await text(page, "session"), /<img src=x/);
      assert.equal(await page.locator("img").count(), 0);
      assert.equal(await page.evaluate(() => window.hacked), undefined);
    });
  });

  test("a token of the address goes to the program", async () => {
    const mock = await new Mock().listen();
    const { page, close } = await openPage(browser, `${mock.url}?token=a%26b`, { test: false });
    await until(page, () => window.dermatome?.state().sequence > 0);
    const [client] = mock.clients;
    assert.equal(client.url, "/?token=a%26b");
    assert.equal(`${client.origin}/`, mock.url);
    await close();
    await mock.close();
  });
});

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
    const { page, errors, close } = await openPage(browser, mock.url);
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

describe("browsers", () => {
  test("without WebGL: it is said, and numbers come all the same", async () => {
    const mock = await new Mock().listen();
    const context = await browser.newContext();
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

function contrast(a, b) {
  const [lighter, darker] = [a, b].map(relativeLuminance).sort((x, y) => y - x);
  return (lighter + 0.05) / (darker + 0.05);
}

function relativeLuminance(hex) {
  const linear = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255).map((part) => (part <= 0.03928 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
  return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
}
