// The data of each pixel: render/compare/pixel_data.h, decoded. Reports may contain only every n-th pixel; x and y are
// always the picture's coordinates.

export const pixelClasses = ["nothing", "measured", "border", "only the surface", "only the mesh"];
export const certificates = ["certified", "converged", "unresolved"];
export const planeRoles = ["pixel-faces", "pixel-depths", "pixel-normals", "pixel-deviation", "pixel-status"];

const noFace = 0xffffffff;

// Returns the exact bytes of a picture, without colour conversion and without premultiplied alpha.
const decode = async (blob) => {
  const bitmap = await createImageBitmap(blob, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  return context.getImageData(0, 0, bitmap.width, bitmap.height);
};

const words = (image) => {
  const values = new Uint32Array(image.width * image.height);
  for (let i = 0; i < values.length; ++i) values[i] = image.data[4 * i] << 16 | image.data[4 * i + 1] << 8 | image.data[4 * i + 2];
  return values;
};

export class Pixels {
  // `load(role)` returns a Blob. Planes are read one after the other, so that the page stays responsive.
  static async load(view, load) {
    const images = {};
    for (const role of planeRoles) {
      images[role] = await decode(await load(role));
      await new Promise((resolve) => { setTimeout(resolve); });
    }
    return new Pixels(view, images);
  }
  constructor(view, images) {
    const any = images["pixel-faces"];
    this.width = any.width; this.height = any.height;
    this.stride = Math.ceil(view.camera.width / any.width);
    [this.near, this.far] = view.pixel_data.depth_mm;
    this.faces = words(images["pixel-faces"]).map((code) => (code === 0 ? noFace : code - 1));
    this.depths = words(images["pixel-depths"]);
    this.normals = words(images["pixel-normals"]);
    this.deviations = new Float32Array(words(images["pixel-deviation"]).map((code) => code << 8).buffer);
    this.status = images["pixel-status"].data;
  }
  index(x, y) {
    return Math.min(this.height - 1, Math.floor(y / this.stride)) * this.width + Math.min(this.width - 1, Math.floor(x / this.stride));
  }
  faceAt(x, y) {
    const face = this.faces[this.index(x, y)];
    return face === noFace ? null : face;
  }
  at(x, y) {
    const i = this.index(x, y), kind = this.status[4 * i];
    const hit = this.depths[i] > 0;
    return {
      kind, certificate: this.status[4 * i + 1], otherFace: this.status[4 * i + 2] === 1, face: this.faceAt(x, y),
      depth: hit ? this.near + (this.depths[i] - 1) / 0xfffffe * (this.far - this.near) : null,
      deviation: kind === 1 || kind === 2 ? this.deviations[i] : null,
      normal: hit ? this.normal(this.normals[i]) : null,
    };
  }
  normal(code) {
    let u = (code >> 12) / 4095 * 2 - 1, v = (code & 4095) / 4095 * 2 - 1;
    const z = 1 - Math.abs(u) - Math.abs(v);
    if (z < 0) [u, v] = [(1 - Math.abs(v)) * (u < 0 ? -1 : 1), (1 - Math.abs(u)) * (v < 0 ? -1 : 1)];
    const length = Math.hypot(u, v, z);
    return [u / length, v / length, z / length];
  }
  // Returns a canvas of the planes' size with a face's border, and a tint within it.
  outline(face, color) {
    const canvas = new OffscreenCanvas(this.width, this.height), context = canvas.getContext("2d");
    const image = context.createImageData(this.width, this.height), { width, height, faces } = this;
    let box = [width, height, -1, -1];
    const inside = (x, y) => x >= 0 && y >= 0 && x < width && y < height && faces[y * width + x] === face;
    for (let y = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x) {
        const own = faces[y * width + x] === face;
        const edge = own ? !(inside(x - 1, y) && inside(x + 1, y) && inside(x, y - 1) && inside(x, y + 1))
          : inside(x - 1, y) || inside(x + 1, y) || inside(x, y - 1) || inside(x, y + 1);
        if (!own && !edge) continue;
        if (own) box = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
        image.data.set([...color, edge ? 255 : 40], 4 * (y * width + x));
      }
    }
    context.putImageData(image, 0, 0);
    return { canvas, box: box[2] < 0 ? null : box.map((value, i) => (value + (i > 1 ? 1 : 0)) * this.stride) };
  }
}
