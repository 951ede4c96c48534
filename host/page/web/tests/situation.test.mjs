// What the page says when something is missing, wrong or strange, in a browser.

import assert from "node:assert/strict";
import { describe } from "node:test";

import { openPage, screenshot, until, untilDrawn } from "./browser.mjs";
import { Mock } from "./mock.mjs";
import { hemisphere } from "./skins.mjs";
import { shared, test, text, withPage } from "./with_page.mjs";

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
    const { page, errors, close } = await openPage(shared.browser, first.url);
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
    const { page, close } = await openPage(shared.browser, `${mock.url}?token=a%26b`, { test: false });
    await until(page, () => window.dermatome?.state().sequence > 0);
    const [client] = mock.clients;
    assert.equal(client.url, "/?token=a%26b");
    assert.equal(`${client.origin}/`, mock.url);
    await close();
    await mock.close();
  });
});
