// From where the skin is looked at: a flat one from above, a curved one at an angle; and turning by keys.

import { Spherical, Vector3 } from "three";

const TILT = (40 * Math.PI) / 180;
const MARGIN = 1.12;

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

/** The distance at which a ball of `radius` fills the narrower side of the picture. */
export function fittingDistance(camera, radius) {
  const vertical = (camera.fov * Math.PI) / 360;
  const horizontal = Math.atan(Math.tan(vertical) * camera.aspect);
  return (radius * MARGIN) / Math.sin(Math.min(vertical, horizontal));
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
