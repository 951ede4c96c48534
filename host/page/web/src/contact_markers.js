// Contacts in the scene: a ring of the contact's area on the skin, and an arrow along the normal, as long as the contact
// is strong.

import {
  CircleGeometry,
  ConeGeometry,
  CylinderGeometry,
  DoubleSide,
  Group,
  Mesh,
  MeshBasicMaterial,
  Quaternion,
  RingGeometry,
  Vector3,
} from "three";

const Z = new Vector3(0, 0, 1);
const HALO = new RingGeometry(0.9, 1.05, 64);
const RING = new RingGeometry(0.94, 1.01, 64);
const SHAFT = new CylinderGeometry(0.025, 0.025, 0.8, 10).translate(0, 0.4, 0).rotateX(Math.PI / 2);
const HEAD = new ConeGeometry(0.075, 0.2, 14).translate(0, 0.9, 0).rotateX(Math.PI / 2);
const DOT = new CircleGeometry(0.16, 24);
// Towards the camera an arrow is seen from its end only: a dot is shown in its place.
const END_ON_COSINE = 0.93;
const ARROW_COLOUR = 0xe4572e;
const LONGEST = 0.45;
const SHORTEST = 0.08;

export class ContactMarkers {
  constructor() {
    this.group = new Group();
    this.markers = [];
    this.greatest = 0;
  }

  /** Shows `contacts` on a skin of `radius`, m. */
  show(contacts, radius) {
    while (this.markers.length < contacts.length) this.add();
    this.greatest = Math.max(this.greatest, ...contacts.map(loadOf));
    this.markers.forEach((marker, i) => {
      marker.group.visible = i < contacts.length;
      if (marker.group.visible) this.place(marker, contacts[i], radius);
    });
  }

  /** A new skin has another range of loads. */
  reset() {
    this.greatest = 0;
    this.show([], 1);
  }

  /** Contacts on the side that is turned away are paler. */
  face(camera) {
    for (const { group, arrow, dot, materials, normal } of this.markers) {
      const cosine = normal.dot(camera.position.clone().sub(group.position).normalize());
      for (const material of materials) material.opacity = cosine < 0 ? 0.25 : 1;
      dot.visible = Math.abs(cosine) > END_ON_COSINE;
      arrow.visible = !dot.visible;
    }
  }

  add() {
    const flat = (color) =>
      new MeshBasicMaterial({ color, side: DoubleSide, transparent: true, depthTest: false, depthWrite: false });
    const materials = [flat(0x10151c), flat(0xffffff), flat(ARROW_COLOUR)];
    const dot = ordered(DOT, materials[2], 12);
    const ring = new Group().add(ordered(HALO, materials[0], 10), ordered(RING, materials[1], 11), dot);
    const arrow = new Group().add(ordered(SHAFT, materials[2], 12), ordered(HEAD, materials[2], 12));
    const group = new Group().add(ring, arrow);
    this.markers.push({ group, ring, arrow, dot, materials, normal: new Vector3(0, 0, 1) });
    this.group.add(group);
  }

  place(marker, contact, radius) {
    const { group, ring, arrow, normal } = marker;
    group.position.copy(contact.position);
    normal.copy(contact.normal);
    if (!(normal.lengthSq() > 0.01)) normal.copy(Z);
    group.quaternion.copy(new Quaternion().setFromUnitVectors(Z, normal.normalize()));
    ring.scale.setScalar(ringRadius(contact, radius));
    const share = this.greatest > 0 ? loadOf(contact) / this.greatest : 0;
    arrow.scale.setScalar(radius * (SHORTEST + (LONGEST - SHORTEST) * share));
  }
}

/** Radius of a circle of the contact's area, m; one that is seen where the area is not known. */
export function ringRadius(contact, radius) {
  const ofArea = Math.sqrt(contact.area / Math.PI);
  return Number.isFinite(ofArea) && ofArea > 0 ? Math.max(ofArea, radius * 0.02) : radius * 0.05;
}

function loadOf(contact) {
  const load = Number.isFinite(contact.force) ? contact.force : contact.strength;
  return Number.isFinite(load) ? Math.max(0, load) : 0;
}

function ordered(geometry, material, order) {
  const mesh = new Mesh(geometry, material);
  mesh.renderOrder = order;
  return mesh;
}
