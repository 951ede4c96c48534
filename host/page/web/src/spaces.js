// Spaces: of which skin a topic is, or of the whole robot, and what it is called here. Live and recorded alike.

/** Topics and services are named after the space of their skin; the page knows those of a single skin, which begin so. */
export const SINGLE = "/dermatome/";
export const SINGLE_SPACE = "dermatome";
// Topics of a whole robot, and of each of its skins, that are looked at where all of it is.
const ROBOT_TOPICS = ["/links", "/tf", "/tf_static"];
const ROBOT_SKIN_TOPICS = ["/skin", "/image", "/contacts", "/status"];
/** Stands for all skins of a robot, in place of one's space. */
export const WHOLE = "*";

/** What a skin is called on its robot, by its space. */
export function nameOf(space) {
  return space.slice(space.indexOf("/") + 1);
}

/** The space of a topic as it is called here. */
export function spaceOf(topic) {
  return topic.slice(topic.indexOf("/") + 1, topic.lastIndexOf("/"));
}

/** Whether these channels tell of a whole robot. */
export function tellOfRobot(channels) {
  return channels.some(({ topic }) => topic === ROBOT_TOPICS[0]);
}

/** A topic's or service's name as that of a single skin, the one in `space`; `undefined` where it is another's. */
export function singly(name, space) {
  const start = `/${space}/`;
  return name.startsWith(start) ? SINGLE + name.slice(start.length) : undefined;
}

/** The name of a single skin's topic or service as that of the skin in `space`. */
export function nameIn(space, name) {
  return name.replace(SINGLE, `/${space}/`);
}

/**
 * What a topic is called here where `space` is looked at: as that of a single skin, or, where all `spaces` of the robot are,
 * by its channel, as several may have one name. `undefined` where it is not looked at.
 */
export function nameHere({ id, topic }, space, spaces) {
  if (space !== WHOLE) return singly(topic, space);
  const ofSkin = spaces.some((space) => ROBOT_SKIN_TOPICS.some((end) => topic === `/${space}${end}`));
  return ofSkin || ROBOT_TOPICS.includes(topic) ? `${id}${topic}` : undefined;
}
