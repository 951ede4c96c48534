// What there is to see and, where there is nothing, what is missing and what to do about it, in words.

import { STATES } from "./words.js";

/**
 * `{ level, word, text, advice, covers, action }` of a session: `covers` where it is said in the middle of the picture,
 * `action` "tare" or "retry" where a button helps.
 */
export function situationOf(session) {
  if (session.player) return ofRecording(session);
  if (!session.program.isOpen) return ofNoProgram(session.program);
  if (session.program.silence > 0) return ofSilence(session.program.silence);
  if (session.isWhole) return ofRobot(session.robot);
  const { status, skin } = session.shown;
  if (!status) return waiting("Connected to the program", "It has not yet said how the skin is.");
  if (status.state !== "live") return ofStatus(status);
  if (!skin) return waiting("Waiting for the skin's shape", status.text);
  return ofImages(status);
}

function ofRecording({ player, shown, robot, isWhole, fault }) {
  const { recording } = player;
  const cut = recording.isCut ? "The file was cut: it is shown up to its last whole chunk." : "";
  const hasSkin = isWhole ? [...robot.skins.values()].some(({ skin }) => skin) : shown.skin;
  const hasNothing = !hasSkin && !fault;
  return {
    level: "off",
    word: "Recording",
    text: hasNothing ? "The skin's shape is not in the recording, or not yet read" : recording.name,
    advice: cut,
    covers: hasNothing,
  };
}

function ofNoProgram(program) {
  if (!program.everOpen && program.attempts === 0) return waiting("Connecting to the program", "");
  const seconds = Math.ceil((program.retryAt - performance.now()) / 1000);
  const next = program.retryAt > 0 && seconds > 0 ? `The next attempt is in ${seconds} s.` : "Trying now.";
  return {
    level: "bad",
    word: "No program",
    text: "The program `dermatome view` does not answer",
    advice: `Start it again in a terminal, if it has ended; this page connects by itself. ${next}`,
    covers: true,
    action: "retry",
  };
}

// Skins that are not live are named; one that is is enough to see something.
function ofRobot({ skins }) {
  const all = [...skins].filter(([, { status }]) => status);
  if (all.length === 0) return waiting("Connected to the program", "It has not yet said how the skins are.");
  const others = all.filter(([, { status }]) => status.state !== "live");
  const said = others.map(([space, { status }]) => `${space}: ${status.text || (STATES[status.state]?.word ?? status.state)}`);
  if (others.length === all.length) return waiting("No skin is live", said.join("; "));
  const isAll = others.length === 0;
  return {
    level: isAll ? "good" : "warn",
    word: isAll ? "Live" : `${all.length - others.length} of ${all.length} live`,
    text: isAll ? `${all.length} skins` : said.join("; "),
    advice: others.map(([, { status }]) => status.advice).find(Boolean) ?? "",
    covers: false,
  };
}

function ofSilence(silence) {
  return {
    level: "warn",
    word: "Silent",
    text: `The program has said nothing for ${Math.round(silence / 1000)} s`,
    advice: "It may be busy, or the machine was asleep. If it goes on, look at its terminal.",
    covers: false,
  };
}

function ofStatus(status) {
  const { word, level } = STATES[status.state] ?? { word: status.state, level: "warn" };
  const action = status.state === "not_tared" ? "tare" : undefined;
  return { level, word, text: status.text || word, advice: status.advice, covers: true, action };
}

function ofImages(status) {
  const { word, level } = STATES[status.state];
  return { level, word, text: status.text, advice: status.advice, covers: false };
}

function waiting(text, advice) {
  return { level: "off", word: "Waiting", text, advice, covers: true };
}

// Each with its skin.
function warningsOfRobot({ skins }) {
  return [...skins].flatMap(([space, { status }]) => (status?.warnings ?? []).map((text) => `${space}: ${text}`));
}

/** The warnings of a session, in words, each once. */
export function warningsOf(session) {
  const { status } = session.shown;
  const notices = session.player ? [] : session.program.notices.filter(({ level }) => level > 0);
  const stale = session.isStale ? ["No new image has come for some seconds, although the program says that the skin is live."] : [];
  const isConnected = session.player || session.program.isOpen;
  const ofStatus = isConnected ? (session.isWhole ? warningsOfRobot(session.robot) : (status?.warnings ?? [])) : [];
  const texts = [session.lack, session.fault, ...stale, ...ofStatus, ...notices.map(({ message }) => message)];
  return [...new Set(texts.filter((text) => text))];
}
