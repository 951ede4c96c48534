// Runs a test's page against a mock of the program.

import assert from "node:assert/strict";
import { after, before, test as testOf } from "node:test";

import { launch, missing, openPage } from "./browser.mjs";
import { Mock } from "./mock.mjs";

/** The browser of a file's tests, which begins and ends with them. */
export const shared = {};
before(async () => missing || (shared.browser = await launch()));
after(() => shared.browser?.close());

/** A test that is not run where there is no browser. */
export const test = (name, act) => testOf(name, { skip: missing }, act);

/**
 * Runs `act({ page, mock, errors })` on a page against a mock made of `mock` and put right by `prepare`; nothing may have
 * gone wrong in the page.
 */
export async function withPage({ mock: mockOptions = {}, prepare, ...options }, act) {
  const mock = await new Mock(mockOptions).listen();
  prepare?.(mock);
  const opened = await openPage(shared.browser, mock.url, options);
  try {
    await act({ ...opened, mock });
    assert.deepEqual(opened.errors, []);
  } finally {
    await opened.close();
    await mock.close();
  }
}

export const state = (page) => page.evaluate(() => window.dermatome.state());
export const text = (page, id) => page.textContent(`#${id}`);
