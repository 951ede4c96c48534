// A whole robot in the scene: its links, grey, and its skins, each where its link is.

import { Box3, BufferAttribute, BufferGeometry, Group, Sphere, Vector3 } from "three";

import { pixelValues } from "./messages.js";
import { SkinSurface, linkOf } from "./skin_surface.js";

// A robot that has reached farther than before by less, m, is looked at as before.
const SAME_REACH = 0.01;

export class RobotFigure {
  constructor() {
    this.group = new Group();
    /** Of each link, `{ frame, object }`. */
    this.links = [];
    /** Of each space, `{ frame, surface, object, values }`. */
    this.skins = new Map();
    /** All places where it has been, as boxes go. */
    this.reach = new Box3();
  }

  /** Brings it up to date with what of `robot` is new; says whether it has other parts, or reaches farther. */
  follow(robot) {
    const { news } = robot;
    if (news.has("links")) this.setLinks(robot.links);
    for (const [space, { skin, image }] of robot.skins) {
      if (skin && news.has(`skin ${space}`)) this.setSkin(space, skin);
      if (news.has(`image ${space}`) || news.has(`skin ${space}`)) this.setImage(space, image);
    }
    for (const { frame, object } of this.parts) place(object, robot.place(frame));
    const hasNewParts = news.has("links") || [...news].some((name) => name.startsWith("skin "));
    if (hasNewParts) this.reach.makeEmpty();
    return this.reachesFarther() || hasNewParts;
  }

  reachesFarther() {
    const now = this.reach.clone();
    for (const corner of this.partCorners) now.expandByPoint(corner);
    const isFarther = this.reach.isEmpty() || now.min.distanceTo(this.reach.min) + now.max.distanceTo(this.reach.max) > SAME_REACH;
    if (isFarther) this.reach = now;
    return isFarther;
  }

  get parts() {
    return [...this.links, ...this.skins.values()];
  }

  get surfaces() {
    return [...this.skins.values()].map(({ surface }) => surface);
  }

  setLinks(markers) {
    for (const { object } of this.links) this.remove(object);
    this.links = markers.map(({ header, points }) => ({ frame: header.frame_id, object: this.add(linkOf(geometryOf(points))) }));
  }

  setSkin(space, skin) {
    const before = this.skins.get(space);
    if (before) this.removeSkin(before);
    const surface = new SkinSurface(skin);
    const object = this.add(new Group().add(...surface.objects));
    this.skins.set(space, { frame: skin.header.frame_id, surface, object, values: undefined });
  }

  setImage(space, image) {
    const skin = this.skins.get(space);
    if (!skin) return;
    skin.values = image && pixelValues(image, skin.values);
    skin.surface.show(skin.values);
  }

  add(object) {
    object.matrixAutoUpdate = false;
    this.group.add(object);
    return object;
  }

  remove(object) {
    this.group.remove(object);
    object.geometry.dispose();
    object.material.dispose();
  }

  removeSkin({ surface, object }) {
    this.group.remove(object);
    surface.dispose();
  }

  showLinks(areShown) {
    for (const { object } of this.links) object.visible = areShown;
  }

  dispose() {
    for (const { object } of this.links) this.remove(object);
    for (const skin of this.skins.values()) this.removeSkin(skin);
  }

  get partCorners() {
    return this.parts.flatMap(({ object, surface }) => {
      const { geometry } = surface?.mesh ?? object;
      if (!geometry.boundingBox) geometry.computeBoundingBox();
      return cornersOf(geometry.boundingBox).map((corner) => corner.applyMatrix4(object.matrix));
    });
  }

  /** Points that lie round all places where it has been, x, y, z each. */
  get corners() {
    return this.reach.isEmpty() ? [] : cornersOf(this.reach).flatMap((corner) => corner.toArray());
  }

  /** As of a skin: centre, radius, and the mean normal of its skins. */
  get frame() {
    if (this.reach.isEmpty()) return undefined;
    const { center, radius } = this.reach.getBoundingSphere(new Sphere());
    const normal = new Vector3();
    for (const { surface, object } of this.skins.values()) normal.add(surface.frame.normal.clone().transformDirection(object.matrix));
    const isClear = normal.length() > 0.1 * this.skins.size;
    return { centre: center, radius, normal: isClear ? normal.normalize() : new Vector3(1, 0, 0), isFlat: false };
  }

  /** Radius of its largest skin, m. */
  get skinRadius() {
    return Math.max(0, ...this.surfaces.map((surface) => surface.frame.radius));
  }
}

function place(object, matrix) {
  object.matrix.copy(matrix);
  object.matrixWorldNeedsUpdate = true;
}

function geometryOf(points) {
  const geometry = new BufferGeometry();
  const places = Float32Array.from(points.flatMap(({ x, y, z }) => [x, y, z]));
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  geometry.computeVertexNormals();
  geometry.computeBoundingSphere();
  return geometry;
}

function cornersOf({ min, max }) {
  const ends = [min, max];
  return ends.flatMap(({ x }) => ends.flatMap(({ y }) => ends.map(({ z }) => new Vector3(x, y, z))));
}
