// The modules that need no browser.

import assert from "node:assert/strict";
import { once } from "node:events";
import { describe, test } from "node:test";
import lz4 from "lz4js";
import { WebSocket, WebSocketServer } from "ws";

import { meanAndSpread } from "../src/calibrate_panel.js";
import { MAPS, colourAt, tableOf } from "../src/colour.js";
import { Connection } from "../src/connection.js";
import { electrodeStates } from "../src/electrode_states.js";
import { readBinary, serviceRequest } from "../src/foxglove.js";
import { History, onGrid } from "../src/history.js";
import { Latest } from "../src/latest.js";
import { decompressFrame } from "../src/lz4.js";
import { decode, flagWords, pixelValues } from "../src/messages.js";
import { openRecording } from "../src/recording.js";
import { Robot } from "../src/robot.js";
import { Scale, nextStep } from "../src/scale.js";
import { bytes, clock, contactLabel, number, ohm } from "../src/words.js";
import { Mock, encode } from "./mock.mjs";
import { record } from "./recordings.mjs";
import { schemaOf } from "./schemas.mjs";
import { hemisphere } from "./skins.mjs";

describe("a robot", () => {
  const turn = { x: 0, y: 0, z: Math.SQRT1_2, w: Math.SQRT1_2 };
  const joint = (parent, child, x, rotation = { x: 0, y: 0, z: 0, w: 1 }) => ({
    header: { frame_id: parent },
    child_frame_id: child,
    transform: { translation: { x, y: 0, z: 0 }, rotation },
  });
  const contact = { id: 1, position: { x: 0.5, y: 0, z: 0.25 }, normal: { x: 1, y: 0, z: 0 } };
  const near = (point, expected) => point.toArray().forEach((part, axis) => assert.ok(Math.abs(part - expected[axis]) < 1e-12, `${point.toArray()}`));

  test("contacts of a skin are where its link is, through all joints, whichever topic tells them", () => {
    const robot = new Robot();
    robot.take("/arm/palm/contacts", { header: { frame_id: "hand" }, contacts: [contact] });
    near(robot.contacts[0].position, [0.5, 0, 0.25]);
    robot.take("/tf_static", { transforms: [joint("base", "arm", 1, turn)] });
    robot.take("/tf", { transforms: [joint("arm", "hand", 2)] });
    near(robot.contacts[0].position, [1, 2.5, 0.25]);
    near(robot.contacts[0].normal, [0, 1, 0]);
    assert.deepEqual([robot.contacts[0].space, robot.contacts[0].onLink], ["arm/palm", contact.position]);
    robot.take("/tf", { transforms: [joint("arm", "hand", 3)] });
    near(robot.contacts[0].position, [1, 3.5, 0.25]);
    assert.deepEqual([...robot.news], ["contacts arm/palm", "joints"]);
  });

  test("frames that go in a circle do not hang the page", () => {
    const robot = new Robot();
    robot.take("/tf", { transforms: [joint("a", "b", 0), joint("b", "a", 0)] });
    assert.equal(robot.place("a").elements.every(Number.isFinite), true);
  });
});

describe("what a skin's board said", () => {
  const contacts = { header: { frame_id: "hand" }, contacts: [{ id: 1, position: { x: 0, y: 0, z: 0 }, normal: { x: 1, y: 0, z: 0 } }] };
  const seen = (robot) => [robot.contacts.length, robot.skins.get("arm/palm").image?.sequence];
  const told = (robot, messages) => messages.forEach(([kind, message, time, isHeld]) => robot.take(`/arm/palm/${kind}`, message, time, isHeld));

  test("is over when it is lost, and not where it is known again, in whichever order both come", () => {
    const robot = new Robot();
    told(robot, [["status", { state: "live" }, 1n], ["image", { sequence: 7 }, 2n], ["contacts", contacts, 2n]]);
    assert.deepEqual(seen(robot), [1, 7]);
    robot.news.clear();
    told(robot, [["status", { state: "lost" }, 3n]]);
    assert.deepEqual(seen(robot), [0, undefined]);
    assert.deepEqual([...robot.news].toSorted(), ["contacts arm/palm", "image arm/palm", "status arm/palm"]);
    told(robot, [["image", { sequence: 6 }, 2n]]);
    assert.deepEqual(seen(robot), [0, undefined], "it came before");
    told(robot, [["image", { sequence: 8 }, 4n], ["contacts", contacts, 4n]]);
    assert.deepEqual(seen(robot), [1, 8], "the next status is not there yet");
    told(robot, [["status", { state: "lost" }, 5n], ["status", { state: "live" }, 6n]]);
    assert.deepEqual(seen(robot), [0, undefined], "what came before the loss does not come back with the board");
    // Scrubbed back to between the last frame and the loss: only the status is another there.
    told(robot, [["status", { state: "live" }, 1n]]);
    assert.deepEqual(seen(robot), [1, 8]);
  });

  test("stays while the picture is held", () => {
    const robot = new Robot();
    told(robot, [["image", { sequence: 7 }, 2n], ["contacts", contacts, 2n], ["status", { state: "lost" }, 3n, true]]);
    assert.deepEqual(seen(robot), [1, 7]);
    told(robot, [["status", { state: "lost" }, 4n, false]]);
    assert.deepEqual(seen(robot), [0, undefined]);
  });
});

describe("LZ4", () => {
  // printf 'dermatome %.0s' $(seq 1 40) | lz4 -B4 -BD -BX --content-size | base64 -w0 (lz4 1.9.4)
  const GOLDEN = "BCJNGHxAkAEAAAAAAAC4FQAAAK9kZXJtYXRvbWUgCgD/b1B0b21lIHS9HysAAAAAXqpIiQ==";

  test("a frame of the reference program, with linked blocks, checksums and its size", () => {
    const text = Buffer.from(decompressFrame(Buffer.from(GOLDEN, "base64"), 400)).toString();
    assert.equal(text, "dermatome ".repeat(40));
  });

  test("what another compressor wrote comes back, compressible or not", () => {
    let seed = 1;
    const random = () => (seed = (seed * 48271) % 2147483647);
    const regular = Uint8Array.from({ length: 300000 }, (_, i) => (i * i) % 251);
    const noise = Uint8Array.from({ length: 100000 }, () => random() & 255);
    for (const data of [regular, noise, new Uint8Array(0), Uint8Array.of(7)]) {
      assert.deepEqual(decompressFrame(lz4.compress(data), data.length), data);
    }
  });

  test("a frame that is cut at any byte, or of another length, is refused", () => {
    const frame = Buffer.from(GOLDEN, "base64");
    for (let length = 0; length < frame.length - 8; length++) {
      assert.throws(() => decompressFrame(frame.subarray(0, length), 400), `cut to ${length} bytes`);
    }
    assert.throws(() => decompressFrame(frame, 399), /more bytes than expected/);
    assert.throws(() => decompressFrame(frame, 401), /400 bytes where 401 are expected/);
  });

  test("a match before the start is refused", () => {
    const frame = Uint8Array.of(4, 0x22, 0x4d, 0x18, 0x60, 0x40, 0x82, 5, 0, 0, 0, 0x10, 65, 9, 0, 0, 0, 0, 0, 0);
    assert.throws(() => decompressFrame(frame, 10), /before the start/);
  });
});

describe("colours", () => {
  test("the ends and the middle of viridis and cividis are matplotlib's", () => {
    const expected = { viridis: ["440154", "21918c", "fde725"], cividis: ["00224e", "7c7b78", "fee838"] };
    for (const [map, colours] of Object.entries(expected)) {
      colours.forEach((hex, i) => {
        const rgb = [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16));
        colourAt(map, i / 2).forEach((part, k) => assert.ok(Math.abs(part - rgb[k]) <= 6, `${map} ${i}: ${colourAt(map, i / 2)}`));
      });
    }
  });

  test("lightness rises all along the sequential maps, and is the same on both sides of the diverging one", () => {
    const lightness = (map, share) => {
      const linear = colourAt(map, share).map((part) => (part / 255 <= 0.04045 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4));
      return 116 * Math.cbrt(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]) - 16;
    };
    for (const map of ["viridis", "cividis"]) {
      for (let i = 0; i < 64; i++) assert.ok(lightness(map, (i + 1) / 64) > lightness(map, i / 64), `${map} at ${i}`);
    }
    for (let i = 0; i <= 32; i++) {
      const [low, high] = [lightness("diverging", i / 64), lightness("diverging", 1 - i / 64)];
      assert.ok(Math.abs(low - high) < 6, `at ${i}: ${low} and ${high}`);
    }
    assert.deepEqual(colourAt("diverging", 0.5).map((part) => part > 240), [true, true, true]);
  });

  test("tables have 256 opaque steps, and shares outside are clamped", () => {
    for (const map of Object.keys(MAPS)) {
      const table = tableOf(map);
      assert.equal(table.length, 1024);
      assert.ok(table.every((part, i) => i % 4 !== 3 || part === 255));
      assert.deepEqual(colourAt(map, -3), colourAt(map, 0));
      assert.deepEqual(colourAt(map, 7), colourAt(map, 1));
    }
  });
});

describe("scale", () => {
  test("automatic: up at once, down slowly, and never below twice the threshold", () => {
    const scale = new Scale();
    scale.threshold = 0.05;
    scale.follow([0.01, -0.02], 0);
    assert.equal(scale.maximum, 0.1);
    scale.follow([0.4, -0.5], 0.01);
    assert.equal(scale.maximum, 0.5);
    scale.follow([0], 1.01);
    assert.ok(Math.abs(scale.maximum - 0.5 * Math.exp(-0.5)) < 1e-9);
    scale.follow([0], 60);
    assert.equal(scale.maximum, 0.1);
  });

  test("steps go through 1, 2, 5", () => {
    assert.deepEqual([0.1, 0.11, 0.2, 0.5, 1, 9].map((value) => nextStep(value, true)), [0.2, 0.2, 0.5, 1, 2, 10]);
    assert.deepEqual([0.1, 0.11, 0.2, 0.5, 1, 9].map((value) => nextStep(value, false)), [0.05, 0.1, 0.1, 0.2, 0.5, 5]);
  });
});

describe("messages", () => {
  test("an image of the schema comes back as values", () => {
    const header = { stamp: { sec: 1, nanosec: 2 }, frame_id: "skin" };
    const image = { header, sequence: 7, device_time_us: 123456789012n, flags: 5, exponent: 10, mantissas: Int16Array.of(512, -1024, 0) };
    const read = decode(schemaOf("Image"), encode("/dermatome/image", image));
    assert.equal(read.sequence, 7);
    assert.equal(read.device_time_us, 123456789012n);
    assert.deepEqual([...pixelValues(read)], [0.5, -1, 0]);
    assert.deepEqual(flagWords(read.flags), ["saturated", "electrodes connected to each other"]);
  });

  test("only the newest message of a topic waits", () => {
    const latest = new Latest();
    for (let i = 0; i < 1000; i++) latest.put("a", "", i, 0n);
    latest.put("b", "", 1, 0n);
    assert.deepEqual(latest.take((topic) => topic === "a").map((message) => message.bytes), [999]);
    assert.deepEqual(latest.take().map(({ topic }) => topic), ["b"]);
    assert.deepEqual(latest.take(), []);
  });

  test("a service request has the bytes of the protocol; cut frames are refused", () => {
    const frame = serviceRequest(3, 7, { a: 1 });
    assert.deepEqual([...frame], [2, 3, 0, 0, 0, 7, 0, 0, 0, 4, 0, 0, 0, ...Buffer.from('json{"a":1}')]);
    assert.throws(() => readBinary(Uint8Array.of(1, 0, 0).buffer));
    assert.equal(readBinary(Uint8Array.of(99).buffer), undefined);
  });
});

describe("history", () => {
  test("a short press is kept, bins are joined, and a minute is all", () => {
    const history = new History();
    for (let i = 0; i < 400; i++) history.add("force", i / 400, i === 201 ? 9 : 1);
    const { times, values } = history.of("force");
    assert.ok(times.length <= 21, `${times.length} points`);
    assert.ok(values.includes(9));
    history.add("force", 70, 2);
    assert.deepEqual(history.of("force").times, [70]);
    history.add("force", 5, 3);
    assert.deepEqual(history.of("force").values, [3]);
    history.add("force", 6, NaN);
    assert.deepEqual(history.of("force").values, [3, null]);
  });

  test("of a whole recording, the minute before any time; loss is a rate", () => {
    const history = new History(Infinity);
    for (let i = 0; i <= 300; i++) history.addStatus(i, { state: "live", frames_lost: BigInt(2 * i), frames_per_second: 50, signal_to_noise: NaN });
    assert.deepEqual(history.before("lost", 200.5).times.length, 60);
    assert.deepEqual(history.before("lost", 200.5).times.at(-1), 200);
    assert.deepEqual(history.before("lost", 200.5).values.at(-1), 2);
    assert.deepEqual(history.before("noise", 3).values, [null, null, null, null]);
  });

  test("contacts of a lost board are not known until they come again", () => {
    const history = new History();
    const status = (state) => ({ state, frames_lost: 0n, frames_per_second: 0, signal_to_noise: NaN });
    history.take("contacts", 1, { contacts: [{ force: 2, strength: 0.5 }] });
    history.take("status", 1.5, status("live"));
    assert.deepEqual(history.of("count").values, [1]);
    history.take("status", 2, status("lost"));
    for (const name of ["force", "strength", "count"]) assert.equal(history.of(name).values.at(-1), null);
    history.take("status", 2.5, status("lost"));
    history.take("contacts", 3, { contacts: [] });
    assert.deepEqual(history.of("count").values, [1, null, 0]);
    // At once with the last contacts, in whichever bin.
    history.take("status", 3, status("taring"));
    history.take("contacts", 3.4, { contacts: [] });
    assert.deepEqual(history.of("count").values, [1, null, 0, null, 0]);
    // At any time: bins are fractions that binary numbers do not hold.
    for (let time = 0; time < 40; time += 0.01) {
      const other = new History();
      other.take("contacts", time, { contacts: [] });
      other.take("status", time, status("lost"));
      assert.deepEqual(other.of("count").values, [0, null], `at ${time}`);
    }
  });
});

test("series of several skins as one table: each bin has a place of its own, what is not known stays so", () => {
  const one = { times: [100.01, 100.061, 130, 159.99], values: [1, 2, null, 4] };
  const [times, ...columns] = onGrid([one, { times: [30, 160], values: [8, 9] }], 160);
  assert.equal(times.length, 1201);
  assert.ok(Math.abs(times[0] + 60) < 1e-9 && Math.abs(times.at(-1)) < 1e-9, `${times[0]} to ${times.at(-1)}`);
  const known = columns.map((column) => [...column.entries()].filter(([, value]) => value !== undefined));
  assert.deepEqual(known, [[[0, 1], [1, 2], [600, null], [1199, 4]], [[1200, 9]]]);
});

describe("words", () => {
  test("numbers, sizes, times, resistances", () => {
    assert.deepEqual([12.345, 0.0123, 1234, 0, NaN].map((value) => number(value)), ["12.3", "0.0123", "1234", "0", "–"]);
    assert.deepEqual([999n, 1500n, 2500000n].map(bytes), ["999 B", "1.5 kB", "2.5 MB"]);
    assert.deepEqual([0, 61.5, 3661.25].map(clock), ["0:00.000", "1:01.500", "1:01:01.250"]);
    assert.deepEqual([320, 1830, Infinity, NaN].map(ohm), ["320 Ω", "1.83 kΩ", "above range", "–"]);
  });

  test("a contact's label", () => {
    const contact = { is_tracked: true, id: 4, pressure: 12300, force: 0.42, strength: 0.1 };
    assert.equal(contactLabel(contact), "#4 12.3 kPa 0.42 N");
    assert.equal(contactLabel({ ...contact, pressure: NaN, force: NaN }), "#4 strength 0.100");
    assert.equal(contactLabel({ ...contact, is_tracked: false, force: NaN }), "new strength 0.100");
  });

  test("the worst state of an electrode is told", () => {
    const health = { contact_impedance: Float32Array.of(100, 1000, Infinity), open: 4, shorted: 0, worse: 6 };
    assert.deepEqual(electrodeStates(3, health).map(({ state }) => state), ["sound", "worse", "open"]);
    assert.deepEqual(electrodeStates(1, undefined)[0].state, "unknown");
  });

  test("a reading needs frames", () => {
    assert.throws(() => meanAndSpread([0.1, NaN, 0.1]), /No contact was seen/);
    assert.deepEqual(meanAndSpread([1, 2, 3]), { strength: 2, spread: 1 });
  });
});

describe("recordings", () => {
  const IMAGE = "/dermatome/image";

  test("each topic's last message at any time, and the frames before and after", async () => {
    const recording = await openRecording(new Blob([await record({ seconds: 2, rate: 100 })]), "a.mcap");
    assert.ok(recording.chunks.length > 3 && !recording.isCut);
    const at = recording.start + 1_234_000_000n;
    const [image, skin] = await recording.at(at, [IMAGE, "/dermatome/skin"]);
    assert.equal(decode(image.schema, image.bytes).sequence, 123);
    assert.equal(decode(skin.schema, skin.bytes).name, "mock-disc");
    assert.equal(await recording.neighbour(at, true), recording.start + 1_240_000_000n);
    assert.equal(await recording.neighbour(at, false), recording.start + 1_230_000_000n);
    assert.equal(await recording.neighbour(recording.end, true), undefined);
  });

  test("of several skins each is shown by itself", async () => {
    const mocks = { "arm/palm": new Mock({ rate: 100 }), "arm/back": new Mock({ rate: 100, skin: hemisphere() }) };
    const whole = await record({ seconds: 2, mocks });
    for (const blob of [new Blob([whole]), new Blob([whole.subarray(0, whole.length * 0.8)])]) {
      const recording = await openRecording(blob, "robot.mcap");
      assert.deepEqual([recording.spaces, recording.space], [["arm/palm", "arm/back"], "arm/palm"]);
      for (const [space, skin] of [["arm/palm", "mock-disc"], ["arm/back", "mock-hemisphere"]]) {
        const messages = await recording.of(space).at(recording.start + 500_000_000n, ["/dermatome/skin", IMAGE]);
        const [shape, image] = messages.map(({ schema, bytes }) => decode(schema, bytes));
        assert.deepEqual([shape.name, image.sequence, image.mantissas.length], [skin, 50, shape.pixel_areas.length]);
      }
    }
  });

  const robotOf = (positions) => [["/links", { markers: [] }, -1], ["/tf_static", { transforms: [] }, -1], ...positions.map((at) => ["/tf", { transforms: [] }, at])];

  test("of a robot all is told at once, each channel by itself, and the frames of all its skins are stepped through", async () => {
    const mocks = { "arm/palm": new Mock({ rate: 100 }), "arm/back": new Mock({ rate: 100, skin: hemisphere() }) };
    const whole = await record({ seconds: 2, mocks, begins: { "arm/back": 1.005 }, robot: robotOf([-1, 0.5, 1.5]) });
    const recording = await openRecording(new Blob([whole]), "robot.mcap");
    assert.ok(recording.isWhole && recording.hasRobot);
    const told = async (seconds) => {
      const found = await recording.at(recording.start + BigInt(Math.round(seconds * 1e9)));
      return Object.fromEntries(found.map(({ topic, ...message }) => [topic.replace(/^\d+/, ""), message]));
    };
    const ofPalm = ["/arm/palm/contacts", "/arm/palm/image", "/arm/palm/skin", "/arm/palm/status"];
    const early = await told(0.7);
    assert.deepEqual(Object.keys(early).sort(), ["/arm/back/skin", ...ofPalm, "/links", "/tf", "/tf_static"]);
    assert.equal(early["/tf"].logTime, recording.start + 500_000_000n);
    const late = await told(1.6);
    assert.equal(Object.keys(late).length, 11);
    assert.deepEqual(["palm", "back"].map((skin) => decode(late[`/arm/${skin}/image`].schema, late[`/arm/${skin}/image`].bytes).sequence), [160, 160]);
    const single = recording.of("arm/back");
    assert.deepEqual([single.isWhole, single.start, single.end], [false, recording.start, recording.end]);
    assert.equal(await single.neighbour(single.start, true), single.start + 1_010_000_000n);
    assert.equal(await recording.neighbour(recording.start + 1_004_000_000n, true), recording.start + 1_010_000_000n);
  });

  test("begins with the first frame, not with what is told before", async () => {
    const whole = await record({ seconds: 2, robot: robotOf([-1, -0.5, 0]) });
    const recording = await openRecording(new Blob([whole]), "robot.mcap");
    assert.ok(Math.abs(recording.duration - 1.99) < 1e-9, `${recording.duration} s`);
    assert.equal(recording.start - recording.chunks[0].start, 1_000_000_000n);
  });

  test("cut anywhere, it opens up to a whole chunk or says why not", async () => {
    const whole = await record({ seconds: 0.6, rate: 100, chunkSize: 16 * 1024 });
    let last = 0;
    for (let length = 0; length < whole.length; length += 1013) {
      try {
        const recording = await openRecording(new Blob([whole.subarray(0, length)]), "cut.mcap");
        assert.ok(recording.duration >= last, `${length} bytes: ${recording.duration} s after ${last}`);
        last = recording.duration;
        assert.ok((await recording.at(recording.end, ["/dermatome/skin"])).length === 1);
      } catch (error) {
        assert.match(error.message, /empty|not MCAP|no images/, `${length} bytes`);
      }
    }
    assert.ok(last > 0.4, `${last} s`);
  });

  test("a damaged chunk ends what is trusted", async () => {
    const bytes = Buffer.from(await record({ seconds: 1, rate: 100 }));
    const cut = bytes.subarray(0, Math.floor(bytes.length * 0.9));
    cut[Math.floor(bytes.length * 0.5)] ^= 0xff;
    const recording = await openRecording(new Blob([cut]), "damaged.mcap");
    assert.ok(recording.duration > 0.1 && recording.duration < 0.6, `${recording.duration} s`);
  });
});

describe("the connection", () => {
  const channel = (id, topic, schemaName) => ({ id, topic, schemaName, encoding: "cdr", schemaEncoding: "ros2msg" });
  const OF_PALM = [channel(1, "/arm/palm/skin", "dermatome_msgs/msg/Skin"), channel(2, "/arm/palm/status", "dermatome_msgs/msg/Status")];
  const OF_ROBOT = [channel(3, "/links", "visualization_msgs/msg/MarkerArray")];

  /** Answers each subscription with one message, and tells of the robot after the first. */
  function serve(socket) {
    const send = (message) => socket.send(JSON.stringify(message));
    const tellOfRobot = [() => send({ op: "advertise", channels: OF_ROBOT })];
    socket.on("message", (text) => {
      const { op, subscriptions } = JSON.parse(text);
      if (op !== "subscribe") return;
      for (const { id } of subscriptions) {
        const message = Buffer.alloc(14);
        message[0] = 1;
        message.writeUInt32LE(id, 1);
        socket.send(message);
      }
      tellOfRobot.pop()?.();
    });
    send({ op: "serverInfo", sessionId: "1" });
    send({ op: "advertise", channels: OF_PALM });
  }

  test("begins anew where the program tells of one skin first, and then of the robot", async ({ mock }) => {
    // It watches for silence as long as the page is open.
    mock.timers.enable({ apis: ["setInterval"] });
    globalThis.WebSocket = WebSocket;
    const server = new WebSocketServer({ port: 0, host: "127.0.0.1", handleProtocols: () => "foxglove.sdk.v1" });
    server.on("connection", serve);
    await once(server, "listening");
    const told = [];
    const connection = await new Promise((resolve) => {
      const connection = new Connection(`ws://127.0.0.1:${server.address().port}`, {
        message: (topic) => told.push(topic) && topic === "3/links" && resolve(connection),
        session: () => told.push("session"),
        change: () => {},
      });
      for (const topic of ["/dermatome/skin", "/dermatome/status"]) connection.want(topic, true);
    });
    connection.socket.onclose = undefined;
    connection.socket.terminate();
    server.close();
    const [ofPalm, ofRobot] = [["/dermatome/skin", "/dermatome/status"], ["1/arm/palm/skin", "2/arm/palm/status", "3/links"]];
    assert.deepEqual(told, ["session", ...ofPalm, "session", ...ofRobot]);
  });
});
