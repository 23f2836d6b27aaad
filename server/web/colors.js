// The colours of the heat map: those of the difference picture (render/compare/color_map).

const encoded = (linear) => {
  const x = Math.min(1, Math.max(0, linear));
  return Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
};

// Returns the sRGB colour for −1 … 1: blue, near white, orange-red, in even steps in Oklab (Ottosson 2020).
export const diverging = (t) => {
  const part = Math.min(Math.abs(t), 1), hue = t < 0 ? [-0.20, -0.98] : [0.80, 0.60];
  const lightness = 0.975 + (0.46 - 0.975) * part, a = 0.165 * part * hue[0], b = 0.165 * part * hue[1];
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3;
  return [encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s), encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
    encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)];
};

export const css = (rgb) => `rgb(${rgb.join(" ")})`;
export const paper = [222, 221, 217], onlySurface = [24, 24, 28], onlyMesh = [250, 200, 20], border = [150, 152, 158];

// Rounds up to 1, 2 or 5 times a power of ten.
export const roundUp = (value) => {
  if (!(value > 0)) return 1e-9;
  const power = 10 ** Math.floor(Math.log10(value));
  return Number((([1, 2, 5, 10].find((digit) => digit * power >= value * (1 - 1e-12)) || 10) * power).toPrecision(1));
};
