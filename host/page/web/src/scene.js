// The picture in 3D: skin, link and contacts, drawn when `draw` is called and never by itself.

import {
  Color,
  DirectionalLight,
  HemisphereLight,
  PerspectiveCamera,
  Scene as Objects,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import { ContactMarkers } from "./contact_markers.js";
import { SkinSurface, linkMesh } from "./skin_surface.js";
import { fitting, turn, viewpointOf, zoom } from "./viewpoint.js";

const MOST_PIXELS_PER_POINT = 2;

export class Scene {
  /** Throws where the browser has no WebGL. `onView` is called when the camera has moved, to ask for a `draw`. */
  constructor(canvas, { keepsPixels, onView }) {
    this.renderer = new WebGLRenderer({
      canvas,
      alpha: true,
      antialias: !isSoftware(),
      powerPreference: "low-power",
      preserveDrawingBuffer: keepsPixels,
    });
    this.canvas = canvas;
    this.onView = onView;
    this.camera = new PerspectiveCamera(32, 1, 0.01, 10);
    this.objects = new Objects();
    this.markers = new ContactMarkers();
    this.objects.add(this.markers.group, new HemisphereLight(0xffffff, 0x60666e, 1.6), this.camera);
    addHeadlight(this.camera);
    this.theme = undefined;
    this.surface = undefined;
    this.link = undefined;
    this.figure = undefined;
    this.isFitted = true;
    // In points; the canvas is not asked for it while drawing, which would lay out the page.
    this.size = [1, 1];
  }

  get frame() {
    return this.figureFrame ?? this.surface?.frame;
  }

  /** Shows a whole robot in place of a skin, or none where it is undefined. */
  setFigure(figure) {
    if (figure === this.figure) return;
    if (this.figure) this.objects.remove(this.figure.group);
    this.figure?.dispose();
    this.figure = figure;
    this.figureFrame = undefined;
    if (figure) this.objects.add(figure.group);
    this.markers.reset();
  }

  /** The robot has other parts, or reaches farther. */
  fitFigure() {
    this.figureFrame = this.figure.frame;
    if (this.theme) this.setTheme(this.theme);
    if (this.figureFrame && this.isFitted) this.resetView();
  }

  setSkin(skin) {
    this.removeSkin();
    this.surface = new SkinSurface(skin);
    this.link = linkMesh(skin);
    this.objects.add(...this.surface.objects, ...(this.link ? [this.link] : []));
    this.markers.reset();
    if (this.theme) this.setTheme(this.theme);
    this.resetView();
  }

  removeSkin() {
    if (!this.surface) return;
    this.objects.remove(...this.surface.objects);
    this.surface.dispose();
    if (this.link) this.removeLink();
    this.surface = undefined;
    this.markers.reset();
  }

  removeLink() {
    this.objects.remove(this.link);
    this.link.geometry.dispose();
    this.link.material.dispose();
    this.link = undefined;
  }

  /** Those that are seen. */
  get surfaces() {
    return this.figure?.surfaces ?? (this.surface ? [this.surface] : []);
  }

  setTheme(theme) {
    this.theme = theme;
    const line = new Color().setRGB(...theme.line, "srgb").toArray();
    for (const surface of this.surfaces) surface.setTheme({ blank: theme.blank, line });
  }

  showLink(isShown) {
    if (this.link) this.link.visible = isShown;
    this.figure?.showLinks(isShown);
  }

  showContacts(contacts) {
    this.markers.show(contacts, this.figure?.skinRadius ?? this.frame?.radius ?? 1);
  }

  /** The view in which all is seen. */
  resetView() {
    if (!this.frame) return;
    const viewpoint = viewpointOf(this.frame);
    const { target, position } = fitting(this.camera, this.vertices, viewpoint, Boolean(this.link));
    this.camera.up.copy(viewpoint.up);
    this.camera.position.copy(position);
    this.replaceControls(target);
    this.isFitted = true;
    this.onView();
  }

  // What the view is fitted to.
  get vertices() {
    return this.figure?.corners ?? this.surface.geometry.attributes.position.array;
  }

  // The controls keep the direction that was up when they were made.
  replaceControls(target) {
    this.controls?.dispose();
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.target.copy(target);
    this.controls.minDistance = this.frame.radius * 0.2;
    this.controls.maxDistance = this.frame.radius * 30;
    this.controls.update();
    this.controls.addEventListener("change", () => this.moved());
  }

  moved() {
    this.isFitted = false;
    this.onView();
  }

  turn(sideways, upwards) {
    if (this.controls) turn(this.controls, sideways, upwards);
  }

  zoom(factor) {
    if (this.controls) zoom(this.controls, factor);
  }

  resize(width, height, pixelsPerPoint) {
    this.renderer.setPixelRatio(Math.min(pixelsPerPoint, MOST_PIXELS_PER_POINT));
    this.renderer.setSize(width, height, false);
    this.size = [width, height];
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.isFitted) this.resetView();
    else this.onView();
  }

  draw() {
    if (this.frame) this.setDepths();
    this.markers.face(this.camera);
    this.renderer.render(this.objects, this.camera);
  }

  // Near and far as close to the skin as they may be, for the depth's resolution.
  setDepths() {
    const { centre, radius } = this.frame;
    const distance = this.camera.position.distanceTo(centre);
    const ball = this.link?.geometry.boundingSphere;
    const reach = 1.6 * Math.max(radius, ball ? ball.center.distanceTo(centre) + ball.radius : 0);
    this.camera.near = Math.max(distance - reach, distance * 0.01);
    this.camera.far = distance + reach;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  /** Where a place (m) is on the canvas, in points from its left upper corner. */
  project({ x, y, z }) {
    const place = new Vector3(x, y, z).project(this.camera);
    const [width, height] = this.size;
    return [((place.x + 1) / 2) * width, ((1 - place.y) / 2) * height];
  }

  /** Whether a surface with `normal` at `place` is turned towards the camera. */
  faces(place, normal) {
    return new Vector3().copy(this.camera.position).sub(place).dot(normal) > 0;
  }

  /** How long a metre is on the screen at the target, in points. */
  pointsPerMetre() {
    const distance = this.camera.position.distanceTo(this.controls?.target ?? new Vector3());
    return this.size[1] / (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360));
  }

  /** The directions of x, y and z on the screen, each `[right, up, towards the viewer]`. */
  axes() {
    const toCamera = this.camera.matrixWorldInverse;
    return [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => new Vector3(...axis).transformDirection(toCamera).toArray());
  }
}

// Where the processor draws, smooth edges cost a third of the images.
function isSoftware() {
  const context = document.createElement("canvas").getContext("webgl2");
  const names = context?.getExtension("WEBGL_debug_renderer_info");
  const name = names ? String(context.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

function addHeadlight(camera) {
  const light = new DirectionalLight(0xffffff, 1.4);
  light.position.set(0.3, 0.5, 1);
  camera.add(light, light.target);
}
