// `window.dermatome`: what the page shows, to read. It is there for tests, and no part of the page's interface.

/** `state()`; `framesDrawn`; `lastDrawnDeviceTime` (us); `latencies` (ms from a message's log time until its image was drawn); `project(x, y, z)`: where a place (m) is on the canvas, in points. */
export function setUpTestHook(session, picture, tabs) {
  window.dermatome = Object.freeze({
    state: () => stateOf(session, picture, tabs),
    get framesDrawn() {
      return picture.framesDrawn;
    },
    get lastDrawnDeviceTime() {
      return picture.lastDrawnDeviceTime;
    },
    get latencies() {
      return [...session.latencies];
    },
    project: (x, y, z) => picture.scene.project({ x, y, z }),
  });
}

function robotOf(robot, picture) {
  const contacts = robot.contacts.map(({ space, position, onLink }) => ({ space, position: { ...position }, onLink }));
  const { figure } = picture.scene;
  return { contacts, skins: [...(figure?.skins.keys() ?? [])], links: (figure?.links ?? []).map(({ frame }) => frame) };
}

function stateOf(session, picture, tabs) {
  const { player, program, shown } = session;
  return {
    isOpen: program.isOpen,
    sessionId: program.sessionId,
    state: shown.status?.state,
    skin: shown.skin?.name,
    isFlat: picture.scene?.frame?.isFlat,
    sequence: shown.image?.sequence,
    contacts: (shown.contacts?.contacts ?? []).map(({ id, force, strength, position }) => ({ id, force, strength, position })),
    robot: session.isWhole ? robotOf(session.robot, picture) : undefined,
    isHeld: session.isHeld,
    panel: tabs.selected,
    map: picture.map,
    range: picture.range,
    isScaleAutomatic: picture.scale.isAutomatic,
    theme: document.documentElement.dataset.theme,
    recording: player && { seconds: player.seconds, duration: player.recording.duration, isPlaying: player.isPlaying, isCut: player.recording.isCut },
  };
}
