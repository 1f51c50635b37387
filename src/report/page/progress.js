// A page of a study that runs: it renews itself, keeps what the reader chose in its address, and stops where the study has ended
// or nothing is heard of it any more. Figures of points are drawn here, from the data that they share.
(() => {
  "use strict";

  const { make } = page;

  // ---- Points: pairs of what varies, parallel coordinates, and the front of two outcomes.

  /** The colour of a variable of the style, as a canvas takes it: `light-dark(…)` is resolved by an element. */
  const probe = document.body.appendChild(make("span", { hidden: true }));
  const colour = (name) => {
    probe.style.color = `var(${name})`;
    return getComputedStyle(probe).color;
  };

  const short = (value) => {
    if (value === 0) return "0";
    const size = Math.abs(value);
    return (size < 1e-3 || size >= 1e6 ? value.toExponential(1) : String(Number(value.toPrecision(3)))).replace("-", "−");
  };

  /** A canvas of this size in CSS pixels, cleared. */
  const sheet = (canvas, width, height) => {
    const ratio = devicePixelRatio || 1;
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    Object.assign(canvas.style, { width: `${width}px`, height: `${height}px` });
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px system-ui, sans-serif";
    return pen;
  };

  /** Text that fits a width. */
  const fitted = (pen, text, width) => {
    if (pen.measureText(text).width <= width) return text;
    let end = text.length;
    while (end > 1 && pen.measureText(`${text.slice(0, end)}…`).width > width) end--;
    return `${text.slice(0, end)}…`;
  };

  class Points {
    constructor(element) {
      const data = JSON.parse(element.querySelector("script").textContent);
      Object.assign(this, { element, of: data.of, axes: data.axes, rows: data.rows, best: data.best });
      this.outcomes = this.axes.flatMap(({ outcome }, at) => (outcome ? [at] : []));
      this.inputs = this.axes.flatMap(({ outcome }, at) => (outcome ? [] : [at]));
      this.ranges = this.axes.map((axis, at) => this.range(axis, at));
      const key = element.dataset.key;
      this.controls = make("p", { className: "choices" });
      this.shade = this.choice("coloured by", `${key} colour`, this.outcomes.map((at) => [at, this.axes[at].words]), 0);
      this.part = this.choice("shown", `${key} part`, [[1, `all ${this.rows.length}`], [0.5, "the lower half"], [0.1, "the lowest tenth"]], 0);
      this.scale = make("p", { className: "scale-of" });
      element.prepend(this.controls, this.scale);
      if (data.all > data.rows.length) this.scale.before(make("p", { className: "note", textContent: `${data.rows.length} of ${data.all} ${data.of} are drawn.` }));
      for (const figure of element.querySelectorAll("figure")) {
        if (figure.dataset.draw === "front") {
          const choices = this.outcomes.map((at) => [at, this.axes[at].words]);
          const bar = make("p", { className: "choices" });
          this.across = this.choice("across", `${key} across`, choices, data.front[0], bar);
          this.up = this.choice("up", `${key} up`, choices, data.front[1], bar);
          figure.append(bar);
        }
        const canvas = make("canvas");
        canvas.setAttribute("role", "img");
        canvas.setAttribute("aria-label", figure.querySelector("figcaption").textContent);
        figure.append(canvas);
      }
      new ResizeObserver(() => this.draw()).observe(element);
      document.addEventListener("theme", () => this.draw());
    }

    choice(words, key, options, chosen, bar = this.controls) {
      const select = make("select", {}, ...options.map(([value, text]) => make("option", { value, textContent: text })));
      select.selectedIndex = chosen;
      select.dataset.keep = key;
      select.addEventListener("change", () => this.draw());
      bar.append(make("label", {}, `${words} `, select), " ");
      return select;
    }

    range({ names }, at) {
      const values = this.rows.map((row) => row[at]).filter((value) => value != null);
      if (names.length) return { low: -0.5, high: names.length - 0.5, log: false };
      let low = Math.min(...values);
      let high = Math.max(...values);
      if (!(low <= high)) [low, high] = [0, 1];
      // An outcome over decades, as an error is, shows by its logarithm.
      const log = this.axes[at].outcome && low > 0 && high > 8 * low;
      if (low === high) [low, high] = log ? [low / 2, high * 2] : [low - 0.5, high + 0.5];
      return { low, high, log };
    }

    /** From 0 to 1 along an axis. */
    share(at, value) {
      const { low, high, log } = this.ranges[at];
      const [a, b, v] = log ? [low, high, value].map(Math.log) : [low, high, value];
      return (v - a) / (b - a);
    }

    /** The rows that are shown, those of the lowest outcome last, each with its colour. */
    shown() {
      const by = Number(this.shade.value);
      const part = Number(this.part.value);
      const known = this.rows.map((row, at) => ({ row, at })).filter(({ row }) => row[by] != null);
      known.sort((a, b) => b.row[by] - a.row[by]);
      const some = known.slice(Math.floor(known.length * (1 - part)));
      // Dark is low, on a light page; the other way round on a dark one.
      const dark = page.isDark();
      return some.map(({ row, at }) => {
        const share = this.share(by, row[by]);
        return { row, at, colour: page.rgb(page.viridis(dark ? 1 - 0.92 * share : 0.86 * share)) };
      });
    }

    draw() {
      const shown = this.shown();
      this.legend();
      for (const figure of this.element.querySelectorAll("figure")) {
        const canvas = figure.querySelector("canvas");
        const width = Math.max(Math.floor(figure.clientWidth), 200);
        this[figure.dataset.draw](canvas, width, shown);
      }
    }

    legend() {
      const by = Number(this.shade.value);
      const { low, high } = this.ranges[by];
      const dark = page.isDark();
      const stops = Array.from({ length: 9 }, (_, step) => page.rgb(page.viridis(dark ? 1 - (0.92 * step) / 8 : (0.86 * step) / 8)));
      const bar = make("span", { className: "ramp" });
      bar.style.background = `linear-gradient(90deg, ${stops.join()})`;
      this.scale.replaceChildren(`${this.axes[by].words}: ${short(low)} `, bar, ` ${short(high)}`);
    }

    dot(pen, x, y, { colour: fill, at }) {
      pen.beginPath();
      pen.arc(x, y, at === this.best ? 5 : 3, 0, 2 * Math.PI);
      pen.fillStyle = fill;
      pen.fill();
      if (at !== this.best) return;
      pen.strokeStyle = colour("--ink");
      pen.lineWidth = 2;
      pen.stroke();
    }

    /** A box with its axes; where a row stands in it. */
    box(pen, [left, top, width, height], x, y) {
      pen.strokeStyle = colour("--line");
      pen.lineWidth = 1;
      pen.strokeRect(left, top, width, height);
      pen.fillStyle = colour("--soft");
      const ends = (at) => (this.axes[at].names.length ? ["", ""] : [short(this.ranges[at].low), short(this.ranges[at].high)]);
      pen.textBaseline = "top";
      pen.textAlign = "left";
      const [first, last] = ends(x);
      pen.fillText(first, left, top + height + 3);
      pen.textAlign = "right";
      pen.fillText(last, left + width, top + height + 3);
      pen.textAlign = "center";
      pen.fillText(fitted(pen, this.axes[x].words, width - 8), left + width / 2, top + height + 17);
      pen.save();
      pen.translate(left - 4, top);
      pen.rotate(-Math.PI / 2);
      pen.textBaseline = "bottom";
      const [lowest, highest] = ends(y);
      pen.textAlign = "right";
      pen.fillText(highest, 0, 0);
      pen.textAlign = "left";
      pen.fillText(lowest, -height, 0);
      pen.textAlign = "center";
      pen.fillText(fitted(pen, this.axes[y].words, height - 8), -height / 2, -13);
      pen.restore();
      const inset = 7;
      return (row) => [left + inset + (width - 2 * inset) * this.share(x, row[x]), top + height - inset - (height - 2 * inset) * this.share(y, row[y])];
    }

    /** Every two inputs against each other; a single one against the outcome. */
    pairs(canvas, width, shown) {
      const inputs = this.inputs.slice(0, 6);
      const by = Number(this.shade.value);
      const pairs = inputs.length > 1 ? inputs.flatMap((x, at) => inputs.slice(at + 1).map((y) => [x, y])) : [[inputs[0], by]];
      const columns = Math.max(Math.min(Math.floor(width / 230), pairs.length), 1);
      const [wide, high] = [Math.floor(width / columns), Math.min(Math.floor(width / columns), 300)];
      const pen = sheet(canvas, width, Math.ceil(pairs.length / columns) * high);
      pairs.forEach(([x, y], at) => {
        const [left, top] = [(at % columns) * wide + 34, Math.floor(at / columns) * high + 6];
        const place = this.box(pen, [left, top, wide - 44, high - 44], x, y);
        for (const one of shown) if (one.row[x] != null && one.row[y] != null) this.dot(pen, ...place(one.row), one);
        const best = shown.find(({ at: row }) => row === this.best);
        if (best) this.dot(pen, ...place(best.row), best);
      });
    }

    /** A line through the values of each row on all axes. */
    lines(canvas, width, shown) {
      const [top, bottom, height] = [36, 22, 260];
      const axes = this.axes.slice(0, 12);
      const pen = sheet(canvas, width, height);
      const apart = axes.length > 1 ? (width - 60) / (axes.length - 1) : 0;
      const x = (at) => 30 + at * apart;
      const y = (share) => height - bottom - share * (height - top - bottom);
      for (const { row, at, colour: stroke } of shown) {
        pen.beginPath();
        axes.forEach((_, axis) => {
          if (row[axis] == null) return;
          pen.lineTo(x(axis), y(this.share(axis, row[axis])));
        });
        pen.strokeStyle = stroke;
        pen.lineWidth = at === this.best ? 3 : 1.2;
        pen.globalAlpha = at === this.best ? 1 : 0.75;
        pen.stroke();
      }
      pen.globalAlpha = 1;
      axes.forEach(({ words, names }, at) => {
        pen.strokeStyle = colour("--soft");
        pen.lineWidth = 1;
        pen.beginPath();
        pen.moveTo(x(at), y(0));
        pen.lineTo(x(at), y(1));
        pen.stroke();
        pen.fillStyle = colour("--ink");
        pen.textAlign = at === 0 ? "left" : at === axes.length - 1 ? "right" : "center";
        const place = at === 0 ? 0 : at === axes.length - 1 ? width : x(at);
        // In two rows, so that neighbours have room.
        pen.textBaseline = "top";
        pen.fillText(fitted(pen, words, 2 * apart - 16 || width), place, at % 2 ? 15 : 0);
        if (names.length) return;
        pen.fillStyle = colour("--soft");
        pen.fillText(fitted(pen, short(this.ranges[at].low), apart), place, height - bottom + 6);
      });
    }

    /** Two outcomes; those than which none is smaller in size in both are joined. */
    front(canvas, width, shown) {
      const [x, y] = [Number(this.across.value), Number(this.up.value)];
      const wide = Math.min(width, 560);
      const height = Math.min(Math.round(0.7 * wide), 340);
      const pen = sheet(canvas, wide, height);
      const place = this.box(pen, [40, 6, wide - 50, height - 46], x, y);
      const known = shown.filter(({ row }) => row[x] != null && row[y] != null);
      const size = ({ row }, at) => Math.abs(row[at]);
      const sorted = [...known].sort((a, b) => size(a, x) - size(b, x) || size(a, y) - size(b, y));
      let least = Infinity;
      const front = sorted.filter((one) => {
        const isOn = size(one, y) < least;
        least = Math.min(least, size(one, y));
        return isOn;
      });
      pen.strokeStyle = colour("--accent");
      pen.lineWidth = 2;
      pen.beginPath();
      front.forEach(({ row }, at) => (at ? pen.lineTo(...place(row)) : pen.moveTo(...place(row))));
      pen.stroke();
      known.forEach((one) => this.dot(pen, ...place(one.row), one));
      canvas.setAttribute("aria-label", `${this.of} over ${this.axes[x].words} and ${this.axes[y].words}: ${front.length} of ${known.length} on the front, than which none is smaller in size in both`);
    }
  }

  for (const element of document.querySelectorAll(".scatter")) element.points = new Points(element);

  // ---- What the reader chose stays in the address, since a file has no other memory in every browser.

  const kept = new URLSearchParams(location.hash.startsWith("#keep") ? location.hash.slice(1) : "");
  const root = document.documentElement;
  const controls = () => [...document.querySelectorAll("[data-keep], .filter input")];
  const keyOf = (control) => control.dataset.keep ?? `filter ${controls().indexOf(control)}`;
  const folds = () => [...document.querySelectorAll("details")];
  const nameOf = (fold) => `${fold.closest("section")?.querySelector("h2")?.textContent}/${fold.querySelector("summary").textContent}`;
  const figures = () => [...document.querySelectorAll("figure.plot")];
  const titleOf = (figure) => figure.querySelector("h3").textContent;
  const focusable = () => [...document.querySelectorAll("a[href], button, select, input, summary, [tabindex]")];

  const restore = () => {
    const theme = kept.get("theme");
    if (theme && theme !== (page.isDark() ? "dark" : "light")) document.querySelector("button.theme").click();
    const open = new Set(kept.getAll("open"));
    folds().forEach((fold) => (fold.open = open.has(nameOf(fold))));
    for (const control of controls()) {
      const value = kept.get(keyOf(control));
      if (value == null) continue;
      if (control.tagName !== "SELECT" || [...control.options].some((option) => option.value === value)) control.value = value;
      control.dispatchEvent(new Event(control.tagName === "SELECT" ? "change" : "input"));
    }
    const off = new Set(kept.getAll("off"));
    for (const figure of figures()) {
      for (const button of figure.querySelectorAll(".legend button")) {
        if (off.has(`${titleOf(figure)}/${button.children[1].textContent}`)) button.click();
      }
      const view = kept.get(`view ${titleOf(figure)}`)?.split("/").map(Number);
      if (view?.length === 2 && view.every(Number.isFinite)) figure.plot.look(view);
    }
    const focus = kept.get("focus");
    if (focus != null) focusable()[Number(focus)]?.focus({ preventScroll: true });
  };

  const keep = () => {
    const now = new URLSearchParams({ keep: "" });
    for (const name of ["beat", "seen", "pause"]) if (kept.has(name)) now.set(name, kept.get(name));
    if (root.dataset.theme) now.set("theme", root.dataset.theme);
    folds().filter((fold) => fold.open).forEach((fold) => now.append("open", nameOf(fold)));
    controls().forEach((control) => control.value && now.set(keyOf(control), control.value));
    for (const figure of figures()) {
      for (const button of figure.querySelectorAll(".legend button[aria-pressed='false']")) now.append("off", `${titleOf(figure)}/${button.children[1].textContent}`);
      const { view, whole } = figure.plot;
      if (view[0] !== whole[0] || view[1] !== whole[1]) now.set(`view ${titleOf(figure)}`, view.join("/"));
    }
    const focus = focusable().indexOf(document.activeElement);
    if (focus >= 0) now.set("focus", focus);
    history.replaceState(null, "", `#${now}`);
  };
  // A link to a section takes the address; what was chosen comes back into it.
  addEventListener("hashchange", () => location.hash.startsWith("#keep") || keep());

  // ---- Renewal.

  const AGAIN = 2000; // ms between two looks
  const QUIET = 2500; // ms without a touch of the reader's before the page may be renewed

  const line = document.querySelector(".renewal");
  const { lives, beat, written, silence } = line.dataset;
  const clock = (ms) => new Date(ms).toLocaleTimeString();
  const said = make("span");
  line.append(said);

  restore();

  let touched = 0;
  for (const name of ["pointerdown", "pointermove", "keydown", "wheel", "touchmove"]) addEventListener(name, () => (touched = performance.now()), { passive: true });
  const isBusy = () => {
    const waits = document.activeElement?.matches("select, input") ? 8 * QUIET : QUIET;
    const isTouched = touched > 0 && performance.now() - touched < waits;
    return isTouched || getSelection().type === "Range" || document.hidden;
  };

  if (lives !== "true") {
    said.textContent = `Written at ${clock(Number(written))}.`;
    return;
  }
  // By the clock of the reader, which may be another than that of the study: a new beat is a sign of life.
  const LIMIT = 3000 * Number(silence);
  const now = Date.now();
  if (kept.get("beat") !== `${written}.${beat}`) {
    // What is old when it is opened first may be of a clock that is behind: it is given one silence.
    const age = now - Number(written);
    const seen = kept.has("beat") || age < LIMIT ? now : now - LIMIT + 1000 * Number(silence);
    kept.set("beat", `${written}.${beat}`);
    kept.set("seen", seen);
  }
  const renew = () => {
    keep();
    location.reload();
  };
  const button = make("button", { type: "button" });
  button.className = "pause";
  line.append(" ", button);
  const isSilent = () => Date.now() - Number(kept.get("seen")) > LIMIT;
  const show = () => {
    if (isSilent()) {
      line.classList.add("silent");
      said.setAttribute("role", "status");
      said.textContent = `No news since ${clock(Number(written))}: the process has ended without a word, or its machine sleeps.`;
      button.textContent = "look again";
      return;
    }
    const paused = kept.has("pause");
    said.textContent = paused ? `As of ${clock(Number(written))}; not renewed.` : `As of ${clock(Number(written))}; renews itself.`;
    button.textContent = paused ? "go on" : "pause";
  };
  button.addEventListener("click", () => {
    if (isSilent()) {
      kept.set("seen", Date.now() - LIMIT + 1000 * Number(silence));
      renew();
      return;
    }
    if (kept.has("pause")) kept.delete("pause");
    else kept.set("pause", "1");
    keep();
    show();
  });
  const look = () => {
    show();
    if (isSilent()) return;
    if (kept.has("pause") || isBusy()) setTimeout(look, 500);
    else renew();
  };
  keep();
  show();
  setTimeout(look, AGAIN);
})();
