// The program as the page sees it: how the connection stands, which services it offers, and calls of them. The
// connection itself is in a worker; see program_worker.js.

import source from "worker:program_worker.js";

import { WHOLE } from "./spaces.js";

export class Program {
  /** `on.message(topic, schema, bytes, logTime)`, `on.session()` where all is new, `on.change()` of what is below. */
  constructor(url, on) {
    this.on = on;
    this.isOpen = false;
    this.everOpen = false;
    this.attempts = 0;
    this.retryAt = 0;
    this.silence = 0;
    this.sessionId = undefined;
    this.spaces = [];
    this.hasRobot = false;
    this.space = undefined;
    this.services = new Set();
    this.notices = [];
    this.calls = new Map();
    this.nextCall = 1;
    this.worker = startWorker();
    this.worker.onmessage = ({ data }) => this.told(data);
    this.worker.onerror = (event) => on.failed(`The page's connection failed (${event.message}). Reload it.`);
    this.worker.postMessage({ kind: "open", url });
  }

  /** Whether all skins of a robot are looked at. */
  get isWhole() {
    return this.space === WHOLE;
  }

  offers(service) {
    return this.services.has(service);
  }

  want(topic, isWanted) {
    this.worker.postMessage({ kind: "want", topic, isWanted });
  }

  /** Looks at another skin of those that the program tells of. */
  choose(space) {
    this.worker.postMessage({ kind: "choose", space });
  }

  retryNow() {
    this.worker.postMessage({ kind: "retry" });
  }

  /** What the service answers; rejects with words. */
  call(service, request) {
    const id = this.nextCall++;
    this.worker.postMessage({ kind: "call", id, service, request });
    return new Promise((resolve, reject) => this.calls.set(id, { resolve, reject }));
  }

  told(data) {
    const does = {
      messages: () => this.take(data.messages),
      state: () => this.setState(data),
      session: () => this.on.session(),
      answer: () => this.settle(data),
    };
    does[data.kind]();
  }

  take(messages) {
    this.worker.postMessage({ kind: "taken" });
    for (const { topic, schema, bytes, logTime } of messages) this.on.message(topic, schema, bytes, logTime);
  }

  setState({ state: { retryIn, ...state }, services, notices }) {
    Object.assign(this, state, { notices, services: new Set(services) });
    this.retryAt = retryIn > 0 ? performance.now() + retryIn : 0;
    this.on.change();
  }

  settle({ id, answer, error }) {
    const { resolve, reject } = this.calls.get(id);
    this.calls.delete(id);
    if (error === undefined) resolve(answer);
    else reject(new Error(error));
  }
}

function startWorker() {
  const url = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  const worker = new Worker(url);
  URL.revokeObjectURL(url);
  return worker;
}
