// A whole robot as the page knows it: what its links look like, how frames lie to each other, and the newest of each skin.

import { Matrix4, Quaternion, Vector3 } from "three";

import { spaceOf } from "./spaces.js";
import { standing, taken } from "./standing.js";

const JOINT_TOPICS = ["/tf", "/tf_static"];
// More frames than that one under the other go in a circle.
const DEEPEST = 1000;

export class Robot {
  constructor() {
    this.clear();
  }

  clear() {
    /** Markers of triangles, each in the frame of its link. */
    this.links = [];
    /** Of each frame, `{ parent, place }`. */
    this.joints = new Map();
    /** Of each space, `{ skin, image, contacts, status }`, each when it has come and is not over. */
    this.skins = new Map();
    /** Of each space, the newest of each, `{ messages, times }`. */
    this.known = new Map();
    /** What is new since the last time: `links`, `joints`, and `KIND SPACE` of a skin. */
    this.news = new Set();
  }

  /**
   * Takes a message of a topic that came at a time; none where nothing is known of it any more. What is shown of frames stays
   * while it is held.
   */
  take(topic, message, time, isHeld) {
    if (topic === "/links") this.setLinks(message?.markers ?? []);
    else if (JOINT_TOPICS.includes(topic)) this.setJoints(message?.transforms ?? []);
    else this.setOfSkin(topic, message, time, isHeld);
  }

  setLinks(markers) {
    this.links = markers;
    this.news.add("links");
  }

  setJoints(transforms) {
    for (const { header, child_frame_id: child, transform } of transforms) {
      this.joints.set(child, { parent: header.frame_id, place: placeOf(transform) });
    }
    this.news.add("joints");
  }

  setOfSkin(topic, message, time, isHeld) {
    const [space, kind] = [spaceOf(topic), topic.slice(topic.lastIndexOf("/") + 1)];
    const known = taken(this.known.get(space) ?? { messages: {}, times: {} }, kind, message, time);
    this.known.set(space, known);
    const before = this.skins.get(space) ?? {};
    const now = standing(known, isHeld && before);
    this.skins.set(space, now);
    for (const name of Object.keys(now)) if (now[name] !== before[name]) this.news.add(`${name} ${space}`);
  }

  /** Takes places of a frame to where they are on the robot: a matrix. */
  place(frame) {
    const place = new Matrix4();
    let joint = this.joints.get(frame);
    for (let depth = 0; joint && depth < DEEPEST; depth++) {
      place.premultiply(joint.place);
      joint = this.joints.get(joint.parent);
    }
    return place;
  }

  /** Contacts of all skins, where they are on the robot, each with its skin's `space` and its place `onLink`. */
  get contacts() {
    return [...this.skins].flatMap(([space, { contacts }]) => {
      const place = contacts && this.place(contacts.header.frame_id);
      return (contacts?.contacts ?? []).map((contact) => onRobot(contact, place, space));
    });
  }
}

function placeOf({ translation, rotation }) {
  const turn = new Quaternion(rotation.x, rotation.y, rotation.z, rotation.w);
  return new Matrix4().compose(new Vector3().copy(translation), turn, new Vector3(1, 1, 1));
}

function onRobot(contact, place, space) {
  const position = new Vector3().copy(contact.position).applyMatrix4(place);
  const normal = new Vector3().copy(contact.normal).transformDirection(place);
  return { ...contact, position, normal, space, onLink: contact.position };
}
