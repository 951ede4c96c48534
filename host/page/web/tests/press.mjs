// What the mock's skin feels: presses that go round, or one that stands still, as images, contacts and health.

const WIDTH = 0.09;

/** Presses `[{ id, place, strength }]` on a skin at `time` (s). */
export function presses(skin, time, { still } = {}) {
  if (still) return [{ id: 1, place: still.place, strength: still.strength }];
  const radius = reach(skin);
  return [
    { id: 4, angle: time * 0.7, share: 0.55, strength: 0.16 + 0.05 * Math.sin(time * 1.3) },
    { id: 7, angle: 2.4 - time * 0.4, share: 0.35, strength: 0.1 + 0.04 * Math.sin(time * 2.1) },
  ].map(({ id, angle, share, strength }) => ({ id, place: onSkin(skin, radius, angle, share), strength }));
}

function reach(skin) {
  return Math.max(...skin.electrodes.map(Math.abs));
}

function onSkin(skin, radius, angle, share) {
  const [x, y] = [radius * share * Math.cos(angle), radius * share * Math.sin(angle)];
  return [x, y, isFlat(skin) ? 0 : Math.sqrt(radius ** 2 - x ** 2 - y ** 2)];
}

function isFlat(skin) {
  return skin.link_triangles.length === 0;
}

/** Relative conductivity change of each pixel. */
export function imageOf(skin, list) {
  const width = reach(skin) * WIDTH * 2;
  const values = new Float32Array(skin.pixel_centres.length / 3);
  for (let pixel = 0; pixel < values.length; pixel++) {
    values[pixel] = 0.004 * Math.sin(pixel * 12.9898);
    for (const { place, strength } of list) {
      const distance2 = [0, 1, 2].reduce((sum, i) => sum + (skin.pixel_centres[3 * pixel + i] - place[i]) ** 2, 0);
      values[pixel] += 1.5 * strength * Math.exp(-distance2 / (2 * width ** 2));
    }
  }
  return values;
}

/** Mantissas and exponent of an Image. */
export function quantised(values) {
  const greatest = Math.max(1e-6, ...values.map(Math.abs));
  const exponent = Math.floor(Math.log2(32767 / greatest));
  return { exponent, mantissas: Int16Array.from(values, (value) => Math.round(value * 2 ** exponent)) };
}

/** Contact messages of presses; kPa and N where the skin is calibrated. */
export function contactsOf(skin, list) {
  const area = Math.PI * (reach(skin) * WIDTH * 1.6) ** 2;
  return list
    .map(({ id, place, strength }) => {
      const [x, y, z] = place;
      const length = Math.hypot(x, y, z) || 1;
      const normal = isFlat(skin) ? { x: 0, y: 0, z: 1 } : { x: x / length, y: y / length, z: z / length };
      const pressure = skin.is_calibrated ? strength * 1e5 : NaN;
      return {
        is_tracked: true,
        id,
        merged: 0,
        split_from: 0,
        position: { x, y, z },
        normal,
        velocity: { x: 0, y: 0, z: 0 },
        area,
        strength,
        peak: strength * 1.5,
        pressure,
        force: pressure * area,
        load_area: area,
        significance: 40,
        position_deviation: 0.0004,
        strength_deviation: 0.002,
      };
    })
    .sort((a, b) => b.strength - a.strength);
}

/** Health: electrode 4 open, 9 and 10 shorted, 13 worse where `isFaulty`. */
export function healthOf(skin, isFaulty) {
  const count = skin.electrodes.length / 3;
  const impedance = Float32Array.from({ length: count }, (_, i) => 320 + 60 * Math.sin(i * 1.7) + (i === 12 ? 900 : 0));
  if (isFaulty) impedance[3] = Infinity;
  return {
    flags: isFaulty ? 2 | 4 | 2048 : 0,
    contact_impedance: impedance,
    open: isFaulty ? 1 << 3 : 0,
    shorted: isFaulty ? (1 << 8) | (1 << 9) : 0,
    worse: isFaulty ? 1 << 12 : 0,
    reciprocity_error: 0.0021,
    temperature: 34.5,
    load: 0.42,
    free_stack: 5120,
    drift: 0.0031,
    missed: 0,
  };
}
