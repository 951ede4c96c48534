// From where the skin is looked at: a flat one from above, a curved one at an angle; and turning by keys.

import { Spherical, Vector3 } from "three";

const TILT = (40 * Math.PI) / 180;
// Room for the electrodes' numbers around the skin; a link around it is seen a little as well.
const MARGIN = 1.14;
const MARGIN_WITH_LINK = 1.4;

/** The direction that is up on the screen, and the one in which the camera stands, both of length 1. */
export function viewpointOf({ normal, isFlat }) {
  const up = upOf(normal);
  if (isFlat) return { up, direction: normal.clone() };
  // The axis about which the view turns is z, the robot's; a skin that faces up or down is seen obliquely.
  const axis = new Vector3(0, 0, 1);
  const sideways = new Vector3().crossVectors(up, normal).normalize();
  const tilted = normal.clone().multiplyScalar(Math.cos(TILT)).addScaledVector(up, -Math.sin(TILT));
  if (Math.abs(normal.z) < 0.5) tilted.copy(normal).addScaledVector(axis, Math.tan(TILT / 2));
  return { up: axis, direction: tilted.addScaledVector(sideways, 0.35).normalize() };
}

// z where the skin stands, y where it lies.
function upOf(normal) {
  const up = Math.abs(normal.z) > 0.7 ? new Vector3(0, 1, 0) : new Vector3(0, 0, 1);
  return up.addScaledVector(normal, -up.dot(normal)).normalize();
}

/**
 * Where the camera stands and looks at, so that all of `vertices` (x, y, z each) just fill the picture when it looks from
 * `direction` with `up` upwards.
 */
export function fitting(camera, vertices, { up, direction }, hasLink) {
  const margin = hasLink ? MARGIN_WITH_LINK : MARGIN;
  const right = new Vector3().crossVectors(up, direction).normalize();
  const axes = [right, new Vector3().crossVectors(direction, right), direction];
  const [across, along, towards] = axes.map((axis) => extentAlong(vertices, axis));
  const target = new Vector3();
  [across, along, towards].forEach(([low, high], i) => target.addScaledVector(axes[i], (low + high) / 2));
  const vertical = Math.tan((camera.fov * Math.PI) / 360);
  const tangents = [vertical * camera.aspect, vertical];
  let distance = 0;
  forEachVertex(vertices, (vertex) => {
    vertex.sub(target);
    const nearer = vertex.dot(direction);
    tangents.forEach((tangent, i) => (distance = Math.max(distance, (Math.abs(vertex.dot(axes[i])) * margin) / tangent + nearer)));
  });
  return { target, position: target.clone().addScaledVector(direction, distance || 1) };
}

function extentAlong(vertices, axis) {
  let [low, high] = [Infinity, -Infinity];
  forEachVertex(vertices, (vertex) => {
    const place = vertex.dot(axis);
    low = Math.min(low, place);
    high = Math.max(high, place);
  });
  return [low, high];
}

function forEachVertex(vertices, visit) {
  const vertex = new Vector3();
  for (let i = 0; i + 2 < vertices.length; i += 3) visit(vertex.fromArray(vertices, i));
}

/** Turns the camera about its target by angles, sideways and upwards. */
export function turn(controls, sideways, upwards) {
  const { object: camera, target } = controls;
  const toY = new Vector3(0, 1, 0);
  const offset = camera.position.clone().sub(target);
  const spherical = new Spherical();
  const rotation = camera.quaternion.clone().setFromUnitVectors(camera.up, toY);
  spherical.setFromVector3(offset.applyQuaternion(rotation));
  spherical.theta += sideways;
  spherical.phi += upwards;
  spherical.makeSafe();
  camera.position.setFromSpherical(spherical).applyQuaternion(rotation.clone().invert()).add(target);
  controls.update();
}

/** Comes nearer (`factor` below 1) or goes away. */
export function zoom(controls, factor) {
  const { object: camera, target } = controls;
  camera.position.sub(target).multiplyScalar(factor).add(target);
  controls.update();
}
