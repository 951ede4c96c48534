// What still holds of what a skin's board said.

/** What a board says in frames, which is over when they no longer come. */
const OF_FRAMES = ["image", "contacts"];

/**
 * Of the messages that are `known` of a skin, each of which came at `times`, those that its status has not ended since.
 * What is `held`, if anything is, stays as it is.
 */
export function standing(known, times, held) {
  const isOver = (kind) => known.status && known.status.state !== "live" && times[kind] < times.status;
  const shown = { ...known };
  for (const kind of OF_FRAMES.filter((kind) => kind in known)) {
    if (held) shown[kind] = held[kind];
    else if (isOver(kind)) shown[kind] = undefined;
  }
  return shown;
}
