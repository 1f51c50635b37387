// Draws the figure of class "film": faces and impactor in 3-D on a 2-D canvas with its own rasteriser, so that it needs
// no WebGL. Its time follows the event "moment", as the cursors of the plots do.
(() => {
  "use strict";

  const { make, Raster } = page;
  const WORDS = "time (ms)";
  const FAILED = 255;
  const EDGES = 2500; // number of patches from which edges are not drawn
  const OVERSAMPLING = 2; // pixels of the raster per pixel of the page
  const GLASS = 0.42; // share of the impactor's own colour
  const APART = 0.06; // offset of faces in contact with each other, over the size of a patch
  const SPRING = [120, 126, 134];
  const PLAY_TIME = 5000; // ms from the first to the last state
  const LIGHT = [0.35, -0.5, 0.79];
  const VIEWS = {
    aslant: [-0.6, 0.42],
    "from above": [0, Math.PI / 2],
    "from the side": [0, 0.03],
    "from below": [-0.6, -0.5],
  };
  const COLOURS = Array.from({ length: 256 }, (_, at) => page.viridis(at / 255));

  /** What patches are coloured by: its name, its value from the strains, and its range. */
  const QUANTITIES = {
    larger: { words: "larger fibre strain", of: (md, td) => Math.max(md, td), range: "fibre" },
    md: { words: "strain along MD", of: (md) => md, range: "fibre" },
    td: { words: "strain along TD", of: (_, td) => td, range: "fibre" },
    // Mirror images differ in its sign.
    shear: { words: "magnitude of the shear angle", of: (_md, _td, shear) => Math.abs(shear), range: "angle" },
  };

  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const mixed = (a, b, share) => a + (b - a) * share;

  /** Rotates a point by a unit quaternion i, j, k, w. */
  const rotated = ([x, y, z], [i, j, k, w]) => {
    const [a, b, c] = [2 * (j * z - k * y), 2 * (k * x - i * z), 2 * (i * y - j * x)];
    return [x + w * a + j * c - k * b, y + w * b + k * a - i * c, z + w * c + i * b - j * a];
  };

  class Film {
    constructor(element) {
      const data = JSON.parse(element.querySelector("script").textContent);
      this.element = element;
      this.ranges = { fibre: data.fibre, shear: data.shear, angle: [0, Math.max(...data.shear.map(Math.abs))] };
      this.moments = data.moments;
      this.faces = data.faces.map((face) => ({ ...face, patches: new Uint32Array(bytes(face.patches).buffer) }));
      this.states = data.states.map((state) => this.state(state, data.box));
      this.bodies = data.bodies;
      this.mirrored = this.faces.some((face) => face.mirrored.some(Boolean));
      // The axis whose negative side is hidden where the film is cut in half.
      this.cut = this.faces.some((face) => face.mirrored[1]) ? 1 : 0;
      this.time = this.states[0].time;
      this.quantity = "larger";
      this.whole = true;
      [this.yaw, this.pitch] = VIEWS.aslant;
      this.zoom = 1;
      this.raster = new Raster();
      this.centre = this.middle(data.box);
      this.fit();
      this.build();
      new ResizeObserver(() => this.draw()).observe(this.canvas);
      document.addEventListener("theme", () => this.draw());
      document.addEventListener("moment", ({ detail }) => {
        if (detail.from !== this && detail.words === WORDS) this.show(detail.x, false);
      });
      this.show(this.busiest(), false);
    }

    /** A state with positions in m and strains as bytes. */
    state({ time, places, strains, poses }, [low, high]) {
      const steps = new Uint16Array(bytes(places).buffer);
      const points = Float32Array.from(steps, (step, at) => low[at % 3] + (step / 65535) * (high[at % 3] - low[at % 3]));
      return { time, points, strains: bytes(strains), poses };
    }

    /** Middle of the undeformed film, about which the view rotates. */
    middle([low, high]) {
      const { mirrored } = this.faces[0];
      return [0, 1, 2].map((axis) => (mirrored[axis] ? 0 : (low[axis] + high[axis]) / 2));
    }

    /** Extent of the film in the present view, m: right, left, down, up. */
    fit() {
      const { project } = this.camera(0, 0, 1);
      const { mirrored } = this.faces[0];
      const ends = [-Infinity, Infinity, -Infinity, Infinity];
      const take = (x, y, z) => {
        const [right, down] = project(x, y, z);
        ends[0] = Math.max(ends[0], right);
        ends[1] = Math.min(ends[1], right);
        ends[2] = Math.max(ends[2], down);
        ends[3] = Math.min(ends[3], down);
      };
      const heights = this.bodies.map(({ points }) => points.map(([, , z]) => z));
      for (const { points, poses } of this.states) {
        poses.forEach((pose, at) => take(pose[0], pose[1], pose[2] + Math.min(0, ...heights[at])));
        for (let at = 0; at < points.length; at += 3) {
          for (const sx of mirrored[0] ? [1, -1] : [1]) {
            for (const sy of mirrored[1] ? [1, -1] : [1]) take(sx * points[at], sy * points[at + 1], points[at + 2]);
          }
        }
      }
      for (const { springs, mirrored } of this.faces) {
        for (const [x, y, z] of springs) {
          for (const sx of mirrored[0] ? [1, -1] : [1]) {
            for (const sy of mirrored[1] ? [1, -1] : [1]) take(sx * x, sy * y, z);
          }
        }
      }
      // The upper part of an impactor may be out of view.
      const top = Math.max(0, ...heights.flat());
      const [x, y, z] = this.centre;
      if (top) take(x, y, z + Math.min(top, 0.3 * (ends[0] - ends[1])));
      this.ends = ends;
    }

    /** The first time to show: of the lowest point or of the largest force, but not after rupture. */
    busiest() {
      const time = (name) => this.moments.find(([words]) => words.startsWith(name))?.[1] ?? Infinity;
      const rupture = time("rupture");
      const held = this.states.filter((state) => state.time < rupture).pop() ?? this.states[0];
      return Math.min(time("lowest point"), time("largest force"), held.time);
    }

    build() {
      this.canvas = make("canvas", { tabIndex: 0 });
      this.canvas.setAttribute("role", "application");
      this.canvas.setAttribute("aria-roledescription", "rotatable picture");
      this.canvas.setAttribute("aria-label", "The film in three dimensions, coloured by strain. Arrow keys rotate it, plus and minus zoom, space plays, zero resets.");
      this.canvas.addEventListener("keydown", (event) => this.key(event));
      this.canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
      this.drag();

      const button = (text, act) => {
        const made = make("button", { type: "button", textContent: text });
        made.addEventListener("click", () => act());
        return made;
      };
      const choice = (label, options, act) => {
        const select = make("select", {}, ...options.map(([value, text]) => make("option", { value, textContent: text })));
        select.setAttribute("aria-label", label);
        select.addEventListener("change", () => act(select.value));
        return select;
      };
      const [first, last] = [this.states[0].time, this.states[this.states.length - 1].time];
      this.play = button("play", () => this.run());
      this.slider = make("input", { type: "range", min: first, max: last, step: (last - first) / 400 || 1, value: this.time });
      this.slider.setAttribute("aria-label", "time");
      this.slider.addEventListener("input", () => this.show(Number(this.slider.value), true));
      this.at = make("output", { className: "at" });
      const moments = this.moments.map(([words, time]) => button(words, () => this.show(time, true)));
      const quantities = Object.entries(QUANTITIES).map(([name, { words }]) => [name, words]);
      const colour = choice("colour", quantities, (name) => {
        this.quantity = name;
        this.draw();
      });
      const views = Object.keys(VIEWS).map((name) => button(name, () => this.lookFrom(name)));
      const cut = this.mirrored
        ? [choice("part", [["whole", "whole film"], ["half", "cut in half"]], (part) => {
            this.whole = part === "whole";
            this.draw();
          })]
        : [];
      const bar = make("div", { className: "scale" });
      bar.style.background = `linear-gradient(to right, ${COLOURS.filter((_, at) => at % 17 === 0).map(page.rgb).join()})`;
      this.numbers = [0, 1, 2].map(() => make("span"));
      const key = make("div", { className: "key" }, bar, make("div", { className: "ends" }, ...this.numbers));
      this.element.prepend(
        make("div", { className: "tools" }, colour, ...cut, ...views),
        this.canvas,
        key,
        make("div", { className: "tools time" }, this.play, this.slider, this.at),
        make("div", { className: "tools moments" }, ...moments),
      );
    }

    /** Rotation with one finger or the mouse, zoom with two fingers. */
    drag() {
      const held = new Map();
      const spread = () => {
        const [a, b] = [...held.values()];
        return Math.hypot(a[0] - b[0], a[1] - b[1]);
      };
      this.canvas.addEventListener("pointerdown", (event) => {
        held.set(event.pointerId, [event.clientX, event.clientY]);
        this.canvas.setPointerCapture(event.pointerId);
      });
      this.canvas.addEventListener("pointermove", (event) => {
        const before = held.get(event.pointerId);
        if (!before) return;
        const apart = held.size === 2 ? spread() : 0;
        held.set(event.pointerId, [event.clientX, event.clientY]);
        if (held.size === 2) {
          if (apart > 0) this.scaleBy(spread() / apart);
          return;
        }
        this.rotateBy(0.008 * (event.clientX - before[0]), 0.008 * (event.clientY - before[1]));
      });
      for (const end of ["pointerup", "pointercancel"]) this.canvas.addEventListener(end, (event) => held.delete(event.pointerId));
    }

    /** The page scrolls unless the picture has the focus, or the wheel event is a pinch. */
    wheel(event) {
      if (document.activeElement !== this.canvas && !event.ctrlKey) return;
      event.preventDefault();
      this.scaleBy(Math.exp(-0.0015 * event.deltaY));
    }

    key(event) {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const actions = {
        ArrowLeft: () => this.rotateBy(-0.1, 0),
        ArrowRight: () => this.rotateBy(0.1, 0),
        ArrowUp: () => this.rotateBy(0, 0.1),
        ArrowDown: () => this.rotateBy(0, -0.1),
        "+": () => this.scaleBy(1.2),
        "=": () => this.scaleBy(1.2),
        "-": () => this.scaleBy(1 / 1.2),
        0: () => this.lookFrom("aslant"),
        Escape: () => this.lookFrom("aslant"),
        " ": () => this.run(),
      };
      const action = actions[event.key];
      if (!action) return;
      event.preventDefault();
      action();
    }

    lookFrom(view) {
      [this.yaw, this.pitch] = VIEWS[view];
      this.zoom = 1;
      this.fit();
      this.draw();
    }

    rotateBy(yaw, pitch) {
      this.yaw += yaw;
      this.pitch = Math.min(Math.max(this.pitch + pitch, -Math.PI / 2), Math.PI / 2);
      this.draw();
    }

    scaleBy(factor) {
      this.zoom = Math.min(Math.max(this.zoom * factor, 0.4), 12);
      this.draw();
    }

    /** Shows the film at a time (ms), and moves the cursors of the plots where `shared`. */
    show(time, shared) {
      const [first, last] = [this.states[0].time, this.states[this.states.length - 1].time];
      this.time = Math.min(Math.max(time, first), last);
      this.slider.value = this.time;
      this.at.textContent = `${this.time.toFixed(last < 1000 ? 1 : 0)} ms`;
      this.slider.setAttribute("aria-valuetext", this.at.textContent);
      this.draw();
      if (shared) document.dispatchEvent(new CustomEvent("moment", { detail: { words: WORDS, x: this.time, from: this } }));
    }

    /** Plays to the end, from the start where the end is reached; stops where it plays. */
    run() {
      if (this.running) {
        cancelAnimationFrame(this.running);
        this.running = null;
        this.play.textContent = "play";
        return;
      }
      const [first, last] = [this.states[0].time, this.states[this.states.length - 1].time];
      const from = this.time >= last ? first : this.time;
      let begin;
      const next = (now) => {
        begin ??= now;
        const time = from + ((now - begin) / PLAY_TIME) * (last - first);
        this.running = requestAnimationFrame(next);
        this.show(time, true);
        if (time >= last) this.run();
      };
      this.play.textContent = "stop";
      this.running = requestAnimationFrame(next);
    }

    /** The states around the present time, and the share of the second. */
    between() {
      const after = Math.max(1, this.states.findIndex((state) => state.time >= this.time));
      const [a, b] = [this.states[after - 1], this.states[after] ?? this.states[after - 1]];
      return [a, b, b.time > a.time ? (this.time - a.time) / (b.time - a.time) : 0];
    }

    draw() {
      if (this.due) return;
      this.due = requestAnimationFrame(() => {
        this.due = null;
        this.paint();
      });
    }

    paint() {
      const ratio = Math.min(devicePixelRatio || 1, 2);
      const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight].map((side) => Math.round(side * ratio));
      if (!width || !height) return;
      if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
      const context = this.canvas.getContext("2d");
      const style = getComputedStyle(this.canvas);
      context.clearRect(0, 0, width, height);

      const look = this.camera(width, height, this.scaleIn(width, height));
      const [wide, tall] = [this.canvas.clientWidth, this.canvas.clientHeight].map((side) => Math.round(OVERSAMPLING * side));
      this.raster.size(wide, tall);
      this.raster.clear();
      const sharper = this.camera(wide, tall, this.scaleIn(wide, tall));
      this.film(sharper);
      this.impactors(sharper);
      this.raster.glaze(GLASS, 0.01 * (this.ends[0] - this.ends[1]));
      this.raster.show(context, width, height);
      this.triad(context, look, ratio, height, style.color);
      const { range } = QUANTITIES[this.quantity];
      const [low, high] = this.ranges[range];
      const [factor, unit] = range === "angle" ? [180 / Math.PI, "°"] : [100, " %"];
      const step = Math.max(Math.abs(low), Math.abs(high)) * factor;
      const digits = Math.min(Math.max(2 - Math.floor(Math.log10(step)), 0), 4);
      const written = (value) => `${Number((factor * value).toFixed(digits)) || 0}${unit}`.replace("-", "−");
      [low, (low + high) / 2, high].forEach((value, at) => (this.numbers[at].textContent = written(value)));
      if (range === "fibre") this.numbers[0].textContent = "0 % or slack";
    }

    /** Scale at which the film fits, pixels per metre. */
    scaleIn(width, height) {
      const [right, left, down, up] = this.ends;
      return this.zoom * Math.min((0.92 * width) / (right - left || 1), (0.9 * height) / (down - up || 1));
    }

    /** Projection of a point in m: right and down in pixels, and towards the eye. */
    camera(width, height, scale) {
      const [sy, cy, sp, cp] = [Math.sin(this.yaw), Math.cos(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch)];
      const [x0, y0, z0] = this.centre;
      const [right = 0, left = 0, down = 0, up = 0] = width ? this.ends : [];
      const [h0, v0] = [width / 2 - (scale * (right + left)) / 2, height / 2 - (scale * (down + up)) / 2];
      const project = (x, y, z) => {
        const [a, b, c] = [x - x0, y - y0, z - z0];
        const [right, away] = [cy * a - sy * b, sy * a + cy * b];
        return [h0 + scale * right, v0 - scale * (sp * away + cp * c), sp * c - cp * away];
      };
      /** Cosines of the angles of a normal to the eye and to the light. */
      const facing = (x, y, z) => {
        const [right, away] = [cy * x - sy * y, sy * x + cy * y];
        const [up, near] = [sp * away + cp * z, sp * z - cp * away];
        return [near, LIGHT[0] * right + -LIGHT[1] * up + LIGHT[2] * near];
      };
      return { project, facing };
    }

    film(look) {
      const [a, b, share] = this.between();
      const { of, range } = QUANTITIES[this.quantity];
      const [low, high] = this.ranges[range];
      const parts = ["fibre", "fibre", "shear"].map((name) => this.ranges[name]);
      const strain = (state, at, part) => parts[part][0] + (state.strains[at + part] / (FAILED - 1)) * (parts[part][1] - parts[part][0]);
      const edges = this.faces.reduce((sum, face) => sum + face.patches.length / 4, 0) < EDGES;
      let [node, element] = [0, 0];
      for (const [face, { nodes, patches: corners, mirrored, springs }] of this.faces.entries()) {
        const colours = [];
        for (let at = 0; at < corners.length / 4; at++) {
          const place = 3 * (element + at);
          const [now, then] = [a, b].map((state) => state.strains[place] !== FAILED);
          if (!now || (share === 1 && !then)) {
            colours.push(null);
            continue;
          }
          // Until it fails, an element has the strain of the last state.
          const value = of(...[0, 1, 2].map((part) => mixed(strain(a, place, part), strain(then ? b : a, place, part), share)));
          colours.push(COLOURS[Math.round(255 * Math.min(Math.max((value - low) / (high - low), 0), 1))]);
        }
        const points = new Float32Array(3 * nodes);
        for (let at = 0; at < points.length; at++) points[at] = mixed(a.points[3 * node + at], b.points[3 * node + at], share);
        const signs = (axis) => (mirrored[axis] && (this.whole || axis !== this.cut) ? [1, -1] : [1]);
        for (const sx of signs(0)) {
          for (const sy of signs(1)) {
            this.sheet(look, points, corners, colours, { face, sx, sy, edges });
            this.springs(look, points.subarray(3 * (nodes - springs.length)), springs, [sx, sy]);
          }
        }
        node += nodes;
        element += corners.length / 4;
      }
    }

    /** One image of a face. */
    sheet({ project, facing }, points, corners, colours, { face, sx, sy, edges }) {
      const seen = new Float32Array(points.length);
      for (let at = 0; at < points.length; at += 3) seen.set(project(sx * points[at], sy * points[at + 1], points[at + 2]), at);
      for (let at = 0; at < colours.length; at++) {
        const colour = colours[at];
        if (!colour) continue;
        const [p, q, r, s] = corners.subarray(4 * at, 4 * at + 4);
        const d = (from, to, axis) => points[3 * to + axis] - points[3 * from + axis];
        const [ux, uy, uz] = [sx * d(p, r, 0), sy * d(p, r, 1), d(p, r, 2)];
        const other = s === r ? [p, q] : [q, s];
        const [vx, vy, vz] = [sx * d(...other, 0), sy * d(...other, 1), d(...other, 2)];
        const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
        const length = Math.hypot(nx, ny, nz) || 1;
        const [near, lit] = facing(nx / length, ny / length, nz / length);
        const shade = 0.74 + 0.26 * Math.max(0, near < 0 ? -lit : lit);
        // Of faces in contact with each other, the first is the upper one, seen from either side.
        const size = Math.max(Math.hypot(ux, uy, uz), Math.hypot(vx, vy, vz));
        const under = APART * size * (face + 1) * Math.sign(near * sx * sy);
        const places = (s === r ? [p, q, r] : [p, q, r, s]).map((corner) => [
          seen[3 * corner],
          seen[3 * corner + 1],
          seen[3 * corner + 2] - under,
        ]);
        const [fill, edge] = [shade, 0.72 * shade].map((light) => Raster.colour(colour.map((part) => part * light)));
        this.raster.patch(places, fill, edge, edges ? 0.35 * OVERSAMPLING : 0);
      }
    }

    /** The springs of one image of a face, from the frame to the film. */
    springs({ project }, ends, anchors, [sx, sy]) {
      for (const [at, [x, y, z]] of anchors.entries()) {
        const end = project(sx * ends[3 * at], sy * ends[3 * at + 1], ends[3 * at + 2]);
        this.raster.line(project(sx * x, sy * y, z), end, 1.1 * OVERSAMPLING, Raster.colour(SPRING));
      }
    }

    /** The visible sides of the impactors, translucent so that the film behind them is seen. */
    impactors(camera) {
      const [a, b, share] = this.between();
      this.bodies.forEach((body, at) => this.impactor(camera, body, [a.poses[at], b.poses[at]], share));
    }

    /** One of them between two poses. */
    impactor({ project, facing }, { points, patches }, [from, to], share) {
      // A quaternion and its negative are the same rotation; the nearer of both is interpolated to.
      const sense = from.slice(3).reduce((sum, part, at) => sum + part * to[3 + at], 0) < 0 ? -1 : 1;
      const pose = from.map((part, at) => mixed(part, at < 3 ? to[at] : sense * to[at], share));
      const size = Math.hypot(...pose.slice(3)) || 1;
      const rotation = pose.slice(3).map((part) => part / size);
      const places = points.map((point) => rotated(point, rotation).map((c, axis) => c + pose[axis]));
      const seen = places.map((place) => project(...place));
      for (const [p, q, r, s] of patches) {
        const [u, v] = [[p, r], s === r ? [p, q] : [q, s]].map(([from, to]) => places[to].map((c, axis) => c - places[from][axis]));
        const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        const length = Math.hypot(...normal);
        if (!length) continue;
        const [near, lit] = facing(...normal.map((c) => (s === r ? -c : c) / length));
        if (near <= 0 || (!this.whole && [p, q, r, s].every((corner) => places[corner][this.cut] < 1e-9))) continue;
        const shade = 95 + 120 * Math.max(0, lit);
        this.raster.pane((s === r ? [p, q, r] : [p, q, r, s]).map((corner) => seen[corner]), Raster.colour([shade, shade, shade + 8]));
      }
    }

    /** The directions of x, y and z. */
    triad(context, { project }, ratio, height, colour) {
      const origin = project(...this.centre);
      const size = 26 * ratio;
      const unit = 1;
      const full = Math.max(...[[unit, 0, 0], [0, unit, 0], [0, 0, unit]].map((step) => {
        const tip = project(...this.centre.map((c, axis) => c + step[axis]));
        return Math.hypot(tip[0] - origin[0], tip[1] - origin[1]);
      }));
      context.font = `${11 * ratio}px system-ui, sans-serif`;
      context.fillStyle = context.strokeStyle = colour;
      context.lineWidth = 1.3 * ratio;
      context.textAlign = "center";
      context.textBaseline = "middle";
      const corner = [38 * ratio, height - 38 * ratio];
      ["x", "y", "z"].forEach((name, axis) => {
        const tip = project(...this.centre.map((c, at) => c + (at === axis ? unit : 0)));
        const [h, v] = [tip[0] - origin[0], tip[1] - origin[1]].map((side) => (size * side) / full);
        if (Math.hypot(h, v) < 0.15 * size) return;
        context.beginPath();
        context.moveTo(...corner);
        context.lineTo(corner[0] + h, corner[1] + v);
        context.stroke();
        context.fillText(name, corner[0] + 1.3 * h, corner[1] + 1.3 * v);
      });
    }
  }

  for (const element of document.querySelectorAll("figure.film")) new Film(element);
})();
