// Rasterises patches in space with a depth buffer, which is right for patches that touch or intersect. Pictures are drawn
// at twice the size of the page and scaled down, which smooths slanted edges.
page.Raster = class {
  constructor() {
    this.canvas = document.createElement("canvas");
    this.size(1, 1);
  }

  size(width, height) {
    if (this.width === width && this.height === height) return;
    Object.assign(this, { width, height });
    Object.assign(this.canvas, { width, height });
    this.image = new ImageData(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.depths = new Float32Array(width * height);
    this.glass = { pixels: new Uint32Array(width * height), depths: new Float32Array(width * height) };
  }

  clear() {
    this.pixels.fill(0);
    this.depths.fill(-Infinity);
    this.glass.pixels.fill(0);
    this.glass.depths.fill(-Infinity);
  }

  /** A patch of three or four corners [right, down, near]; `rim` is the width of its drawn edges, in pixels. */
  patch(corners, colour, edge, rim) {
    const [p, q, r, s] = corners;
    if (s === undefined) return this.triangle(this, [p, q, r], [rim, rim, rim], colour, edge);
    this.triangle(this, [p, q, r], [rim, rim, 0], colour, edge);
    this.triangle(this, [p, r, s], [0, rim, rim], colour, edge);
  }

  /** A line between two points [right, down, near], `width` pixels wide. */
  line([ax, ay, az], [bx, by, bz], width, colour) {
    const half = width / 2 / (Math.hypot(bx - ax, by - ay) || 1);
    const [right, down] = [(ay - by) * half, (bx - ax) * half];
    const corners = [[ax + right, ay + down, az], [bx + right, by + down, bz], [bx - right, by - down, bz], [ax - right, ay - down, az]];
    this.patch(corners, colour, colour, 0);
  }

  /** A translucent patch. */
  pane([p, q, r, s], colour) {
    this.triangle(this.glass, [p, q, r], [0, 0, 0], colour, colour);
    if (s !== undefined) this.triangle(this.glass, [p, r, s], [0, 0, 0], colour, colour);
  }

  triangle({ pixels, depths }, corners, rims, colour, edge) {
    const { width, height } = this;
    const [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners;
    const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (!(Math.abs(area) > 1e-6)) return;
    const across = ((bz - az) * (cy - ay) - (cz - az) * (by - ay)) / area;
    const downwards = ((cz - az) * (bx - ax) - (bz - az) * (cx - ax)) / area;
    // For every side: distance of a pixel from it, less the width of its edge.
    const sides = corners.map(([x0, y0], at) => {
      const [x1, y1] = corners[(at + 1) % 3];
      const length = (Math.sign(area) * Math.hypot(x1 - x0, y1 - y0)) || 1;
      const [right, down] = [(y0 - y1) / length, (x1 - x0) / length];
      return rims[at] ? { right, down, from: -right * x0 - down * y0 - rims[at] } : { right: 0, down: 0, from: 1 };
    });
    const [first, second, third] = sides;
    const top = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5));
    const bottom = Math.min(height - 1, Math.floor(Math.max(ay, by, cy) - 0.5));
    for (let row = top; row <= bottom; row++) {
      const y = row + 0.5;
      let [left, right] = [Infinity, -Infinity];
      for (let at = 0; at < 3; at++) {
        const [x0, y0] = corners[at];
        const [x1, y1] = corners[(at + 1) % 3];
        if (y0 <= y === y1 <= y) continue;
        const x = x0 + ((y - y0) * (x1 - x0)) / (y1 - y0);
        left = Math.min(left, x);
        right = Math.max(right, x);
      }
      const end = Math.min(width, Math.ceil(right - 0.5));
      for (let column = Math.max(0, Math.ceil(left - 0.5)); column < end; column++) {
        const x = column + 0.5;
        const depth = az + across * (x - ax) + downwards * (y - ay);
        const at = row * width + column;
        if (depth <= depths[at]) continue;
        depths[at] = depth;
        const inside =
          first.from + first.right * x + first.down * y > 0 &&
          second.from + second.right * x + second.down * y > 0 &&
          third.from + third.right * x + third.down * y > 0;
        pixels[at] = inside ? colour : edge;
      }
    }
  }

  /** Blends translucent patches over the others with a share of their own colour, where nearer by more than `least`. */
  glaze(share, least) {
    const { pixels, depths, glass } = this;
    for (let at = 0; at < pixels.length; at++) {
      const over = glass.pixels[at];
      if (over === 0 || glass.depths[at] <= depths[at] + least) continue;
      const under = pixels[at];
      if (under === 0) {
        pixels[at] = ((Math.round(255 * share) << 24) | (over & 0xffffff)) >>> 0;
        continue;
      }
      let sum = 0xff000000;
      for (let shift = 0; shift < 24; shift += 8) {
        sum |= Math.round(((over >>> shift) & 255) * share + ((under >>> shift) & 255) * (1 - share)) << shift;
      }
      pixels[at] = sum >>> 0;
    }
  }

  /** Draws the picture on a canvas, scaled to its size. */
  show(context, width, height) {
    this.canvas.getContext("2d").putImageData(this.image, 0, 0);
    context.imageSmoothingQuality = "high";
    context.drawImage(this.canvas, 0, 0, width, height);
  }

  /** Red, green and blue as a pixel. */
  static colour([red, green, blue]) {
    return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
  }
};
