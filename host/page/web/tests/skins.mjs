// Skins for the mock: a flat disc whose pixels are squares, and a hemisphere with the robot link under it.

const ELECTRODES = 16;

function skinOf(name, vertices, triangles, vertexPixels, pixels, electrodes, link = { vertices: [], triangles: [] }) {
  const steps = Array.from({ length: ELECTRODES }, (_, i) => i).flatMap((drive) =>
    [3, 5].map((offset) => [drive, (drive + 1) % 16, (drive + offset) % 16, (drive + offset + 1) % 16]),
  );
  return {
    name,
    patch_crc: 0x1234abcd,
    vertices: Float32Array.from(vertices),
    triangles: Uint32Array.from(triangles),
    vertex_pixels: Uint16Array.from(vertexPixels),
    pixel_centres: Float32Array.from(pixels.flat()),
    pixel_areas: new Float32Array(pixels.length).fill(4e-5),
    electrodes: Float32Array.from(electrodes.flat()),
    steps: Uint8Array.from(steps.flat()),
    link_vertices: Float32Array.from(link.vertices),
    link_triangles: Uint32Array.from(link.triangles),
    contact_threshold: 0.05,
    is_calibrated: false,
  };
}

/** A disc of `diameter`, m, whose image is a raster of `columns`; each pixel is a square of its own vertices. */
export function disc(diameter = 0.21, columns = 32) {
  const [radius, side] = [diameter / 2, diameter / columns];
  const vertices = [], triangles = [], vertexPixels = [], pixels = [];
  for (let row = 0; row < columns; row++) {
    for (let column = 0; column < columns; column++) {
      const [x, y] = [column, row].map((index) => (index + 0.5) * side - radius);
      if (Math.hypot(x, y) > radius) continue;
      const first = vertices.length / 3;
      for (const [dx, dy] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) vertices.push(x + (dx * side) / 2, y + (dy * side) / 2, 0);
      vertexPixels.push(...Array(4).fill(pixels.length));
      triangles.push(first, first + 1, first + 2, first, first + 2, first + 3);
      pixels.push([x, y, 0]);
    }
  }
  const electrodes = Array.from({ length: ELECTRODES }, (_, i) => {
    const angle = Math.PI / 2 - (i * 2 * Math.PI) / ELECTRODES;
    return [radius * Math.cos(angle), radius * Math.sin(angle), 0];
  });
  return skinOf("mock-disc", vertices, triangles, vertexPixels, pixels, electrodes);
}

/** A hemisphere whose vertices each are a pixel, over a link: a ball on a column. */
export function hemisphere(radius = 0.06, rings = 18, sectors = 48) {
  const pixels = [], triangles = [];
  for (let ring = 0; ring <= rings; ring++) {
    for (let sector = 0; sector < sectors; sector++) {
      pixels.push(onBall(radius, (ring / rings) * (Math.PI / 2), (sector / sectors) * 2 * Math.PI));
    }
  }
  joinRings(triangles, rings, sectors, 0);
  const electrodes = Array.from({ length: ELECTRODES }, (_, i) =>
    onBall(radius, Math.PI / 2 - (i % 2) * 0.35, (i * 2 * Math.PI) / ELECTRODES),
  );
  return skinOf("mock-hemisphere", pixels.flat(), triangles, pixels.map((_, i) => i), pixels, electrodes, link(radius * 0.97));
}

function onBall(radius, polar, azimuth) {
  const across = radius * Math.sin(polar);
  return [across * Math.cos(azimuth), across * Math.sin(azimuth), radius * Math.cos(polar)];
}

function joinRings(triangles, rings, sectors, first) {
  for (let ring = 0; ring < rings; ring++) {
    for (let sector = 0; sector < sectors; sector++) {
      const at = (r, s) => first + r * sectors + (s % sectors);
      const [a, b, c, d] = [at(ring, sector), at(ring + 1, sector), at(ring + 1, sector + 1), at(ring, sector + 1)];
      triangles.push(a, b, c, a, c, d);
    }
  }
}

function link(radius, sectors = 48) {
  const profile = [];
  for (let i = 0; i <= 12; i++) profile.push([radius * Math.sin((i / 12) * (Math.PI / 2)), radius * Math.cos((i / 12) * (Math.PI / 2))]);
  profile.push([radius * 1.08, 0], [radius * 1.08, -0.25 * radius], [radius * 0.6, -0.3 * radius], [radius * 0.6, -1.4 * radius]);
  const vertices = profile.flatMap(([across, height]) =>
    Array.from({ length: sectors }, (_, s) => [across * Math.cos((s * 2 * Math.PI) / sectors), across * Math.sin((s * 2 * Math.PI) / sectors), height]),
  );
  const triangles = [];
  joinRings(triangles, profile.length - 1, sectors, 0);
  return { vertices: vertices.flat(), triangles };
}
