// The skin's surface: a mesh whose vertices have the values of their pixels. The colour is looked up for each fragment,
// so that the colours on the screen are those of the colour bar, also between vertices.

import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  DoubleSide,
  LinearFilter,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  ShaderMaterial,
  Vector3,
} from "three";

// Stands for "no value", which a shader cannot test as NaN reliably.
const NO_VALUE = -1e30;

const VERTEX_SHADER = `
attribute float value;
varying float shownValue;
varying vec3 viewNormal;
void main() {
  shownValue = value;
  viewNormal = normalMatrix * normal;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

// Curved skins are shaded a little, so that their shape is seen; flat ones have exactly the map's colours.
const FRAGMENT_SHADER = `
uniform sampler2D map;
uniform vec2 range;
uniform vec3 blank;
uniform float shading;
varying float shownValue;
varying vec3 viewNormal;
void main() {
  float share = clamp((shownValue - range.x) / (range.y - range.x), 0.0, 1.0);
  vec3 colour = shownValue < -1e20 ? blank : texture2D(map, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  float light = mix(1.0, 0.72 + 0.28 * abs(normalize(viewNormal).z), shading);
  gl_FragColor = vec4(colour * light, 1.0);
}`;

export class SkinSurface {
  /** Of a Skin message. */
  constructor(skin) {
    this.pixels = skin.vertex_pixels;
    this.geometry = geometryOf(skin.vertices, skin.triangles);
    this.values = new Float32Array(skin.vertices.length / 3).fill(NO_VALUE);
    this.geometry.setAttribute("value", new BufferAttribute(this.values, 1));
    this.frame = frameOf(this.geometry);
    this.material = surfaceMaterial(this.frame.isFlat);
    this.mesh = new Mesh(this.geometry, this.material);
    this.outline = outlineOf(this.geometry);
    this.objects = [this.mesh, this.outline];
  }

  /** Shows `values` of each pixel; none where they are undefined. */
  show(values) {
    const { pixels } = this;
    for (let vertex = 0; vertex < this.values.length; vertex++) {
      const value = values?.[pixels[vertex]];
      this.values[vertex] = Number.isFinite(value) ? value : NO_VALUE;
    }
    this.geometry.attributes.value.needsUpdate = true;
  }

  setColours(table, low, high) {
    const { map, range } = this.material.uniforms;
    if (table !== map.value?.image.data) {
      map.value?.dispose();
      map.value = textureOf(table);
    }
    range.value = [low, high];
  }

  setTheme({ blank, line }) {
    this.material.uniforms.blank.value = blank;
    this.outline.material.color.setRGB(...line);
  }

  dispose() {
    this.material.uniforms.map.value?.dispose();
    for (const part of [this.geometry, this.material, this.outline.geometry, this.outline.material]) part.dispose();
  }
}

/** The robot link behind a skin, grey; `undefined` where the skin has none. */
export function linkMesh(skin) {
  if (skin.link_triangles.length === 0) return undefined;
  return linkOf(geometryOf(skin.link_vertices, skin.link_triangles));
}

/** A robot link of this shape. */
export function linkOf(geometry) {
  // The skin lies on it: behind where both are at the same depth.
  const behind = { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8 };
  return new Mesh(geometry, new MeshLambertMaterial({ color: 0x8b939d, side: DoubleSide, ...behind }));
}

function geometryOf(vertices, triangles) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(Float32Array.from(vertices), 3));
  geometry.setIndex(new BufferAttribute(Uint32Array.from(triangles), 1));
  geometry.computeVertexNormals();
  geometry.computeBoundingSphere();
  return geometry;
}

function surfaceMaterial(isFlat) {
  return new ShaderMaterial({
    vertexShader: VERTEX_SHADER,
    fragmentShader: FRAGMENT_SHADER,
    side: DoubleSide,
    uniforms: {
      map: { value: null },
      range: { value: [0, 1] },
      blank: { value: [0.5, 0.5, 0.5] },
      shading: { value: isFlat ? 0 : 1 },
    },
  });
}

function textureOf(table) {
  const texture = new DataTexture(table, table.length / 4, 1);
  texture.magFilter = texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Centre, radius, mean normal, and whether nearly all of the surface faces the same way. */
function frameOf(geometry) {
  const { center, radius } = geometry.boundingSphere;
  const sum = new Vector3();
  let area = 0;
  forEachTriangle(geometry, (a, b, c) => {
    const cross = b.sub(a).cross(c.sub(a));
    area += cross.length();
    sum.add(cross);
  });
  const straightness = area > 0 ? sum.length() / area : 0;
  const normal = straightness > 0.05 ? sum.normalize() : new Vector3(0, 0, 1);
  return { centre: center.clone(), radius: radius || 1, normal, isFlat: straightness > 0.995 };
}

function forEachTriangle({ index, attributes: { position } }, visit) {
  const corner = (i) => new Vector3().fromBufferAttribute(position, index.getX(i));
  for (let i = 0; i + 2 < index.count; i += 3) visit(corner(i), corner(i + 1), corner(i + 2));
}

// The edges that belong to one triangle only. Vertices at the same place count as one: pixels may not share theirs.
function outlineOf({ index, attributes: { position } }) {
  const places = new Map();
  const placeOf = Uint32Array.from({ length: position.count }, (_, vertex) => {
    const key = [position.getX(vertex), position.getY(vertex), position.getZ(vertex)].map((x) => Math.round(x * 1e6)).join();
    if (!places.has(key)) places.set(key, vertex);
    return places.get(key);
  });
  const edges = new Map();
  for (let i = 0; i + 2 < index.count; i += 3) {
    const corners = [0, 1, 2].map((corner) => placeOf[index.getX(i + corner)]);
    for (const [from, to] of [[0, 1], [1, 2], [2, 0]]) {
      const edge = [corners[from], corners[to]].sort((a, b) => a - b);
      const key = edge[0] * position.count + edge[1];
      edges.set(key, edges.has(key) ? undefined : edge);
    }
  }
  const single = [...edges.values()].filter((edge) => edge !== undefined).flat();
  const points = single.map((vertex) => new Vector3().fromBufferAttribute(position, vertex));
  return new LineSegments(new BufferGeometry().setFromPoints(points), new LineBasicMaterial());
}
