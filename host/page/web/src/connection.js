// The connection to the program: opens the WebSocket, subscribes to the topics that are wanted, calls services, and
// comes back by itself with growing pauses when the program goes away.

import { SUBPROTOCOL, readBinary, serviceRequest } from "./foxglove.js";
import { SINGLE, WHOLE, nameHere, nameIn, singly, tellOfRobot } from "./spaces.js";

const PAUSES_MS = [250, 500, 1000, 2000, 4000, 5000];
// Status comes twice a second. Silence is mentioned, then taken for a dead connection (a machine that slept).
const SILENT_MS = 3000;
const DEAD_MS = 15000;
const CALL_MS = { "/dermatome/check": 120000, "/dermatome/calibrate": 120000, "/dermatome/patch": 60000 };
const USUAL_CALL_MS = 15000;
const SKIN_SCHEMA = "dermatome_msgs/msg/Skin";

export class Connection {
  /** `on.message(topic, schema, bytes, logTime)`, `on.session()` where all is new, `on.change()` of what is below. */
  constructor(url, on) {
    this.url = url;
    this.on = on;
    this.isOpen = false;
    this.everOpen = false;
    this.attempts = 0;
    this.retryAt = 0;
    this.sessionId = undefined;
    this.notices = new Map();
    this.wanted = new Set();
    this.chosen = undefined;
    this.nextCall = 1;
    this.nextSubscription = 0;
    this.forget();
    setInterval(() => this.watch(), 500);
    this.open();
  }

  /** Milliseconds for which the program has been silent, 0 while that is usual. */
  get silence() {
    const silence = performance.now() - this.heard;
    return this.isOpen && silence > SILENT_MS ? silence : 0;
  }

  /** Spaces of the skins that the program tells of. */
  get spaces() {
    const skins = [...this.channels.values()].filter((channel) => channel.schemaName === SKIN_SCHEMA);
    return skins.map(({ topic }) => topic.slice(1, topic.lastIndexOf("/")));
  }

  /** Whether the program tells of a whole robot. */
  get hasRobot() {
    return tellOfRobot([...this.channels.values()]);
  }

  /** The space that is looked at: the chosen one, or all of the robot, or the first. */
  get space() {
    const { spaces, hasRobot } = this;
    if (spaces.includes(this.chosen)) return this.chosen;
    return hasRobot ? WHOLE : spaces[0];
  }

  /** What a channel's topic is called here. */
  nameHere(channel) {
    return nameHere(channel, this.space, this.spaces);
  }

  isWanted(channel) {
    if (this.space !== WHOLE) return this.wanted.has(this.nameHere(channel));
    // While a recording is shown only status is followed.
    const isFollowed = this.wanted.has(`${SINGLE}skin`) || channel.topic.endsWith("/status");
    return isFollowed && this.nameHere(channel) !== undefined;
  }

  choose(space) {
    this.chosen = space;
    this.beginAnew();
    this.matchSubscriptions();
    this.on.change();
  }

  // What lasts comes once for each subscription: all are new, also those that are wanted before and after.
  beginAnew() {
    this.dropSubscriptions([...this.subscriptions.keys()]);
    this.on.session();
  }

  /** Services of the skin that is looked at. */
  get offered() {
    return [...this.services.keys()].map((name) => singly(name, this.space)).filter(Boolean);
  }

  want(topic, isWanted) {
    if (isWanted === this.wanted.has(topic)) return;
    if (isWanted) this.wanted.add(topic);
    else this.wanted.delete(topic);
    this.matchSubscriptions();
  }

  /** What the service answers; rejects with words. */
  call(service, request) {
    const id = this.services.get(nameIn(this.space, service));
    if (id === undefined) return Promise.reject(new Error(this.whyNot()));
    const callId = this.nextCall++;
    const answer = new Promise((resolve, reject) => {
      const late = () => this.settle(callId, (call) => call.reject(new Error("The program did not answer in time.")));
      const timer = setTimeout(late, CALL_MS[service] ?? USUAL_CALL_MS);
      this.calls.set(callId, { resolve, reject, timer });
    });
    this.socket.send(serviceRequest(id, callId, request));
    return answer.then(orItsError);
  }

  whyNot() {
    return this.isOpen ? "The program does not offer that." : "The program does not answer.";
  }

  retryNow() {
    if (this.isOpen || this.socket?.readyState === WebSocket.CONNECTING) return;
    clearTimeout(this.timer);
    this.open();
  }

  open() {
    this.retryAt = 0;
    const socket = new WebSocket(this.url, [SUBPROTOCOL]);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.opened();
    socket.onmessage = (event) => this.received(event.data);
    socket.onclose = () => socket === this.socket && this.closed();
    this.socket = socket;
  }

  opened() {
    this.isOpen = true;
    this.everOpen = true;
    this.attempts = 0;
    this.heard = performance.now();
    this.on.change();
  }

  closed() {
    this.isOpen = false;
    for (const callId of [...this.calls.keys()]) {
      this.settle(callId, (call) => call.reject(new Error("The program went away before it answered.")));
    }
    this.forget();
    const pause = PAUSES_MS[Math.min(this.attempts++, PAUSES_MS.length - 1)];
    this.retryAt = performance.now() + pause;
    this.timer = setTimeout(() => this.open(), pause);
    this.on.change();
  }

  forget() {
    this.channels = new Map();
    this.subscriptions = new Map();
    this.services = new Map();
    this.calls = new Map();
    this.notices.clear();
    this.heard = performance.now();
  }

  watch() {
    if (!this.isOpen) return this.retryAt && this.on.change();
    const silence = performance.now() - this.heard;
    if (silence > DEAD_MS) this.drop();
    else if (silence > SILENT_MS) this.on.change();
  }

  // A dead connection may never say that it is closed.
  drop() {
    const { socket } = this;
    this.socket = undefined;
    socket.close();
    this.closed();
  }

  received(data) {
    const wasSilent = this.silence > 0;
    this.heard = performance.now();
    try {
      if (typeof data === "string") this.readText(JSON.parse(data));
      else this.readFrame(readBinary(data));
    } catch (error) {
      console.warn("a frame of the program could not be read:", error.message);
    }
    if (wasSilent) this.on.change();
  }

  readFrame(frame) {
    if (frame?.op === "message") {
      const channel = this.subscriptions.get(frame.subscriptionId);
      const topic = channel && this.nameHere(channel);
      if (topic) this.on.message(topic, channel.schema, frame.bytes, frame.logTime);
    } else if (frame?.op === "serviceResponse") {
      this.settle(frame.callId, (call) => call.resolve(frame.payload));
    }
  }

  readText(message) {
    const read = {
      serverInfo: () => this.begin(message.sessionId),
      advertise: () => message.channels.forEach((channel) => this.channels.set(channel.id, channel)),
      unadvertise: () => message.channelIds.forEach((id) => this.removeChannel(id)),
      advertiseServices: () => message.services.forEach((service) => this.services.set(service.name, service.id)),
      unadvertiseServices: () => message.serviceIds.forEach((id) => this.removeService(id)),
      serviceCallFailure: () => this.settle(message.callId, (call) => call.reject(new Error(message.message))),
      status: () => this.notices.set(message.id ?? message.message, message),
      removeStatus: () => message.statusIds.forEach((id) => this.notices.delete(id)),
    }[message.op];
    if (!read) return;
    const { space } = this;
    read();
    // As where a program has told of one skin first, and then of the robot.
    if (space !== undefined && this.space !== undefined && space !== this.space) this.beginAnew();
    this.matchSubscriptions();
    this.on.change();
  }

  begin(sessionId) {
    if (sessionId !== this.sessionId) this.on.session();
    this.sessionId = sessionId;
  }

  removeChannel(id) {
    this.channels.delete(id);
    for (const [subscription, channel] of this.subscriptions) {
      if (channel.id === id) this.subscriptions.delete(subscription);
    }
  }

  removeService(id) {
    for (const [name, other] of this.services) if (other === id) this.services.delete(name);
  }

  // Subscribes to what is wanted and advertised, and to nothing else.
  matchSubscriptions() {
    if (!this.isOpen) return;
    const isCdr = (channel) => channel.encoding === "cdr" && channel.schemaEncoding === "ros2msg";
    const held = new Set([...this.subscriptions.values()].map((channel) => channel.id));
    const missing = [...this.channels.values()].filter(
      (channel) => this.isWanted(channel) && isCdr(channel) && !held.has(channel.id),
    );
    const subscriptions = missing.map((channel) => ({ id: this.nextSubscription++, channelId: channel.id, channel }));
    for (const { id, channel } of subscriptions) this.subscriptions.set(id, channel);
    if (subscriptions.length > 0) {
      this.send({ op: "subscribe", subscriptions: subscriptions.map(({ id, channelId }) => ({ id, channelId })) });
    }
    this.dropUnwanted();
  }

  dropUnwanted() {
    const unwanted = [...this.subscriptions].filter(([, channel]) => !this.isWanted(channel));
    this.dropSubscriptions(unwanted.map(([id]) => id));
  }

  dropSubscriptions(ids) {
    if (ids.length === 0) return;
    for (const id of ids) this.subscriptions.delete(id);
    this.send({ op: "unsubscribe", subscriptionIds: ids });
  }

  send(message) {
    this.socket.send(JSON.stringify(message));
  }

  settle(callId, how) {
    const call = this.calls.get(callId);
    if (!call) return;
    clearTimeout(call.timer);
    this.calls.delete(callId);
    how(call);
  }
}

function orItsError(answer) {
  if (answer?.ok === true) return answer;
  throw new Error(answer?.error || "The program refused without saying why.");
}

/** Where the program listens, seen from the page's own address, with the page's token. */
export function addressOf(location) {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const token = new URLSearchParams(location.search).get("token");
  return `${scheme}://${location.host}/${token === null ? "" : `?token=${encodeURIComponent(token)}`}`;
}
