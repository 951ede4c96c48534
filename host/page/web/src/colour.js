// Colour maps: perceptually uniform, and told apart by people who are colour-blind. Each is a few points, joined
// by straight lines in Oklab (https://bottosson.github.io/posts/oklab/).

// viridis and cividis of matplotlib at equal steps.
const VIRIDIS = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];
const CIVIDIS = ["#00224e", "#213d6b", "#4d556b", "#6c6e72", "#8e8978", "#b8a769", "#e1cc55", "#fee838"];
const STEPS = 256;

/** The maps by name: `points` from low to high; a map that `isDiverging` has zero in its middle. */
export const MAPS = {
  viridis: { title: "Viridis", points: VIRIDIS.map(oklabOf), isDiverging: false },
  cividis: { title: "Cividis", points: CIVIDIS.map(oklabOf), isDiverging: false },
  diverging: { title: "Blue–red, zero in the middle", points: diverging(), isDiverging: true },
};

// Lightness is the same on both sides and falls evenly from the middle; hues are blue (255 degrees) and red-brown (40),
// which differ for all common kinds of colour blindness.
function diverging() {
  const side = (hue) => [1, 0.75, 0.5, 0.25].map((share) => arm(share, hue));
  return [...side(255), [0.97, 0, 0], ...side(40).reverse()];
}

function arm(share, degrees) {
  const chroma = 0.145 * Math.sin(Math.PI * Math.min(1, 0.25 + share * 0.5));
  const hue = (degrees * Math.PI) / 180;
  return [0.97 - 0.62 * share, chroma * share ** 0.5 * Math.cos(hue), chroma * share ** 0.5 * Math.sin(hue)];
}

/** Red, green and blue, 0 to 255, of `share` (0 to 1, clamped) of the map. */
export function colourAt(map, share) {
  const { points } = MAPS[map];
  const place = Math.min(1, Math.max(0, share)) * (points.length - 1);
  const index = Math.min(points.length - 2, Math.floor(place));
  const part = place - index;
  return rgbOf(points[index].map((from, i) => from + (points[index + 1][i] - from) * part));
}

/** The map as `[step][red, green, blue, 255]`, 256 steps. */
export function tableOf(map) {
  const table = new Uint8Array(STEPS * 4);
  for (let step = 0; step < STEPS; step++) {
    table.set([...colourAt(map, step / (STEPS - 1)), 255], step * 4);
  }
  return table;
}

export function css([red, green, blue]) {
  return `rgb(${red}, ${green}, ${blue})`;
}

/** A CSS gradient of the map, low values at the bottom. */
export function gradientOf(map, direction = "to top") {
  const stops = Array.from({ length: 17 }, (_, i) => css(colourAt(map, i / 16)));
  return `linear-gradient(${direction}, ${stops.join(", ")})`;
}

function oklabOf(hex) {
  const [r, g, b] = [1, 3, 5].map((at) => linear(parseInt(hex.slice(at, at + 2), 16) / 255));
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

function rgbOf([lightness, a, b]) {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ].map((part) => Math.round(255 * Math.min(1, Math.max(0, gamma(part)))));
}

function linear(part) {
  return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
}

function gamma(part) {
  return part <= 0.0031308 ? 12.92 * part : 1.055 * Math.max(0, part) ** (1 / 2.4) - 0.055;
}
