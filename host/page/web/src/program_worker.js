// The connection to the program, in a thread of its own, so that the socket is emptied however busy the page is: bytes
// that wait in a socket are a queue as well, and the program would fill it with old images. What the page has not taken
// is replaced by what is newer: one batch is under way at a time, with the newest message of each topic.

import { Connection } from "./connection.js";
import { Latest } from "./latest.js";

// An image and its contacts come one after the other: they are waited for, to be shown together.
const GATHER_MS = 3;

const latest = new Latest();
let connection;
let isUnderWay = false;
let isGathering = false;

const orders = {
  open: ({ url }) => (connection = new Connection(url, { message: keep, session: begin, change: tellState })),
  want: ({ topic, isWanted }) => connection.want(topic, isWanted),
  choose: ({ space }) => connection.choose(space),
  retry: () => connection.retryNow(),
  taken: () => {
    isUnderWay = false;
    gather();
  },
  call: ({ id, service, request }) =>
    connection.call(service, request).then(
      (answer) => postMessage({ kind: "answer", id, answer }),
      (error) => postMessage({ kind: "answer", id, error: error.message }),
    ),
};

onmessage = ({ data }) => orders[data.kind](data);

function keep(topic, schema, bytes, logTime) {
  latest.put(topic, schema, bytes, logTime);
  gather();
}

function gather() {
  if (isUnderWay || isGathering || latest.isEmpty) return;
  isGathering = true;
  setTimeout(send, GATHER_MS);
}

function send() {
  isGathering = false;
  const messages = latest.take();
  if (messages.length === 0) return;
  isUnderWay = true;
  postMessage({ kind: "messages", messages }, messages.map(({ bytes }) => bytes.buffer));
}

function begin() {
  latest.clear();
  postMessage({ kind: "session" });
}

function tellState() {
  const { isOpen, everOpen, attempts, retryAt, sessionId, silence, spaces, hasRobot, space, offered, notices } = connection;
  const retryIn = retryAt > 0 ? retryAt - performance.now() : 0;
  const state = { isOpen, everOpen, attempts, retryIn, sessionId, silence, spaces, hasRobot, space };
  postMessage({ kind: "state", state, services: offered, notices: [...notices.values()] });
}
