// What still holds of what a skin's board said.

/** What a board says in frames, which is over when they no longer come. */
const OF_FRAMES = ["image", "contacts"];

/**
 * The newest messages of a skin and when they came, `{ messages, times }`, after another one. `times.over` is when frames last
 * ended: what came before does not hold again when the board is back.
 */
export function taken({ messages, times }, kind, message, time) {
  const now = { messages: { ...messages, [kind]: message }, times: { ...times, [kind]: time } };
  if (kind === "status") now.times.over = overSince(times.over, message, time);
  return now;
}

// A recording may be put back.
function overSince(before, status, time) {
  if (status && status.state !== "live") return time;
  return status && before < time ? before : undefined;
}

/** Of the messages that are known of a skin those that are not over. What is `held`, if anything is, stays as it is. */
export function standing({ messages, times }, held) {
  const shown = { ...messages };
  for (const kind of OF_FRAMES.filter((kind) => kind in messages)) {
    if (held) shown[kind] = held[kind];
    else if (times[kind] < times.over) shown[kind] = undefined;
  }
  return shown;
}
