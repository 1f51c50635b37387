// Draws every figure of class "plot" with uPlot from the data within it. Curves may have their own abscissae, which need
// not ascend, so all plots use uPlot's mode 2: x and y for each curve. Figures over the same axis share their cursor by
// the event "moment" { words, x }, as does the film.
(() => {
  "use strict";

  const { make } = page;
  const DASH = [7, 5];
  const STEPS = 100; // key presses across a plot
  const MOST_READ = 6; // curves whose values a screen reader reads
  const COLOURS = 8; // --c0 to --c7 of the style

  /** Four significant digits without zeros at the end. */
  const short = (value) => {
    if (value === 0) return "0";
    const size = Math.abs(value);
    const text = size < 1e-3 || size >= 1e6 ? value.toExponential(2) : String(Number(value.toPrecision(4)));
    return text.replace("-", "−");
  };

  const tick = (value) => {
    if (value == null) return "";
    if (value === 0) return "0";
    const size = Math.abs(value);
    const number = Number(value.toPrecision(10));
    const text = size < 1e-3 || size >= 1e5 ? number.toExponential() : String(number);
    return text.replace("e+", "e").replaceAll("-", "−");
  };

  /** `time (ms)` → ["time", "ms"]. */
  const split = (words) => {
    const found = /^(.*?)\s*\(([^()]*)\)$/.exec(words);
    return found ? [found[1], found[2]] : [words, ""];
  };

  /** Ends of a logarithmic axis rounded to one digit. */
  const roundEnds = ([low, high]) => {
    const digit = (value) => 10 ** Math.floor(Math.log10(value) + 1e-9);
    return [Math.floor(low / digit(low) + 1e-9) * digit(low), Math.ceil(high / digit(high) - 1e-9) * digit(high)];
  };

  /** The values within the ends that are marked, at most one to `least` of the share of the axis. */
  const marks = (log, low, high, least) => {
    // Places are counted, not added up: a small step does not change a large value.
    const between = (from, to, value) => Array.from({ length: Math.max(to - from + 1, 0) }, (_, at) => value(from + at));
    if (log) {
      const decades = Math.log10(high) - Math.log10(low);
      const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
      const step = Math.max(Math.ceil(decades * least), 1);
      const factors = step > 1 ? [1] : [[1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 5]].find((some) => 0.8 / some.length >= decades * least) ?? [1];
      const powers = between(Math.ceil(first / step), Math.floor(last / step), (count) => 10 ** (count * step));
      return powers.flatMap((power) => factors.map((factor) => factor * power)).filter((value) => value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9));
    }
    const wanted = (high - low) * least;
    const power = 10 ** Math.floor(Math.log10(wanted));
    const step = power * [1, 2, 2.5, 5, 10].find((factor) => factor * power >= wanted * (1 - 1e-9));
    const [first, last] = [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
    return last - first > 1 / least + 1 ? [] : between(first, last, (count) => count * step);
  };

  /** CSS colours of all curves: lines in turn, a single dashed one in ink, several in the colours of their lines. */
  const colours = (curves) => {
    const dashed = curves.filter((curve) => curve.look === "dashed").length;
    const lines = curves.length - dashed;
    const turn = { line: 0, dashed: 0 };
    return curves.map((curve) => {
      const kind = curve.look === "dashed" ? "dashed" : "line";
      const place = turn[kind]++;
      if (kind === "dashed" && (dashed === 1 || lines === 0)) return "var(--ink)";
      // Many lines have the colours of a sequence.
      if (lines > COLOURS) return page.rgb(page.viridis(0.1 + (0.8 * place) / (lines - 1)));
      return `var(--c${place % COLOURS})`;
    });
  };

  class Figure {
    constructor(element) {
      const data = JSON.parse(element.querySelector("script").textContent);
      this.element = element;
      this.title = element.querySelector("h3").textContent;
      this.axes = { x: data.x, y: data.y };
      this.marked = data.window;
      this.events = data.marks ?? [];
      this.filled = data.filled;
      this.curves = data.curves;
      for (const curve of this.curves) {
        if (typeof curve.x === "number") curve.x = this.curves[curve.x].x;
        curve.ascends = curve.x.every((x, at) => at === 0 || x >= curve.x[at - 1]);
      }
      this.whole = this.span();
      this.view = this.whole;
      this.build();
      this.draw();
      new ResizeObserver(() => this.resize()).observe(this.area);
      document.addEventListener("theme", () => this.plot.redraw(true));
      document.addEventListener("moment", (event) => this.follow(event.detail));
    }

    /** First and last place of all curves along x. */
    span() {
      let low = Infinity;
      let high = -Infinity;
      for (const { x, y } of this.curves) {
        x.forEach((place, at) => {
          if (place == null || y[at] == null) return;
          low = Math.min(low, place);
          high = Math.max(high, place);
        });
      }
      if (low < high && this.axes.x.log) return roundEnds([low, high]);
      // A margin for the size of the points.
      const margin = this.curves.some(({ look }) => look === "points") ? 0.03 * (high - low) : 0;
      if (low < high) return [low - margin, high + margin];
      return this.axes.x.log ? [low / 2, high * 2] : [low - 0.5, high + 0.5];
    }

    /** Range of y of the visible curves within the view, with a margin. */
    heights() {
      let low = Infinity;
      let high = -Infinity;
      this.curves.forEach(({ x, y, ascends }, index) => {
        if (this.plot && !this.plot.series[index + 1].show) return;
        let [from, to] = [0, x.length - 1];
        if (ascends) {
          // With the neighbours outside the view, so that a line across it is drawn.
          from = Math.max(this.nearest(x, this.view[0]) - 1, 0);
          to = Math.min(this.nearest(x, this.view[1]) + 1, to);
        }
        for (let at = from; at <= to; at++) {
          if (y[at] == null) continue;
          low = Math.min(low, y[at]);
          high = Math.max(high, y[at]);
        }
      });
      if (low > high) return this.axes.y.log ? [1, 10] : [0, 1];
      if (this.axes.y.log) return roundEnds(low < high ? [low / 1.05, high * 1.05] : [low / 3, high * 3]);
      const margin = 0.06 * (high - low) || 0.5 * Math.abs(high) || 1;
      // The name of what is marked stands above the bars, and the names of events above the curves.
      let room = this.filled && this.marked ? 3 * margin : margin;
      if (this.events.length > 0) {
        // As many rows as the names needed when they were drawn last, above the highest point.
        const length = this.plot ? this.plot.bbox.height / uPlot.pxRatio : 220;
        const share = Math.min((8 + 14 * (this.rows ?? 1)) / Math.max(length, 1), 0.5);
        room = Math.max(room, ((high - low + margin) * share) / (1 - share));
      }
      return [this.filled ? 0 : low - margin, high + room];
    }

    /** Index of the value nearest to `place` in ascending values. */
    nearest(values, place) {
      let [from, to] = [0, values.length - 1];
      while (to - from > 1) {
        const middle = (from + to) >> 1;
        if (values[middle] < place) from = middle;
        else to = middle;
      }
      return place - values[from] <= values[to] - place ? from : to;
    }

    build() {
      const shades = colours(this.curves);
      this.legend = make("ul", { className: "legend" });
      this.entries = this.curves.map((curve, index) => {
        const swatch = make("span", { className: `swatch ${this.filled ? "filled" : curve.look}` });
        swatch.style.color = shades[index];
        const value = make("span", { className: "value" });
        value.setAttribute("aria-hidden", "true");
        const button = make("button", { type: "button" }, swatch, make("span", { textContent: curve.name }), value);
        button.setAttribute("aria-pressed", "true");
        button.title = "show or hide";
        button.addEventListener("click", () => this.toggle(index));
        this.legend.append(make("li", {}, button));
        return { button, swatch, value };
      });
      this.area = make("div", { className: "area", tabIndex: 0 });
      this.area.setAttribute("role", "application");
      this.area.setAttribute("aria-roledescription", "interactive plot");
      const keys = "arrow keys move the cursor, plus and minus zoom, zero or Escape shows everything";
      this.area.setAttribute("aria-label", `${this.title}. ${this.element.querySelector("figcaption").textContent}. ${keys}`);
      this.area.addEventListener("keydown", (event) => this.key(event));
      this.at = make("span", { className: "at" });
      const tool = (text, label, act) => {
        const button = make("button", { type: "button", textContent: text, title: label });
        // What is seen is part of what is said, for those who speak to the page.
        button.setAttribute("aria-label", `${text}, ${label}: ${this.title}`);
        button.addEventListener("click", act);
        return button;
      };
      this.all = tool("all", "show everything", () => this.look(this.whole));
      this.all.disabled = true;
      const tools = make(
        "div",
        { className: "tools" },
        tool("+", "zoom in", () => this.zoom(0.5)),
        tool("−", "zoom out", () => this.zoom(2)),
        this.all,
        tool("csv", "save the points as a table", () => this.save()),
      );
      this.reading = make("p", { className: "reading unseen" });
      this.reading.setAttribute("role", "status");
      this.element.append(this.at, this.area, make("div", { className: "under" }, this.legend, tools), this.reading);
    }

    draw() {
      const css = (element, property) => getComputedStyle(element)[property];
      const pen = document.createElement("canvas").getContext("2d");
      const room = { x: this.size().width - 60, y: this.size().height - 40 };
      const fitting = (scale) => {
        pen.font = "12px system-ui, sans-serif";
        return Math.max(Math.min(12, (12 * room[scale]) / pen.measureText(this.axes[scale].words).width), 8);
      };
      const axis = (scale, size) => ({
        scale,
        label: this.axes[scale].words,
        labelSize: 20,
        labelFont: `${fitting(scale)}px system-ui, sans-serif`,
        font: "12px system-ui, sans-serif",
        stroke: () => css(this.at, "color"),
        grid: { stroke: () => css(this.element, "borderTopColor"), width: 1 },
        ticks: { stroke: () => css(this.element, "borderTopColor"), width: 1, size: 5 },
        values: (_, places) => places.map(tick),
        filter: (_, places) => places,
        splits: (plot, _, low, high) => {
          const { width, height } = plot.bbox;
          const length = (scale === "x" ? width : height) / uPlot.pxRatio;
          const apart = scale === "y" ? 34 : length < 260 ? 46 : 64;
          return marks(this.axes[scale].log, low, high, apart / Math.max(length, 1));
        },
        size,
      });
      const wide = (plot, values) => {
        if (!values?.length) return 40;
        plot.ctx.font = `${12 * uPlot.pxRatio}px system-ui, sans-serif`;
        return 16 + Math.max(...values.map((text) => plot.ctx.measureText(text).width)) / uPlot.pxRatio;
      };
      const series = this.curves.map((curve, index) => ({
        label: curve.name,
        facets: [
          { scale: "x", auto: true },
          { scale: "y", auto: true },
        ],
        stroke: () => css(this.entries[index].swatch, "color"),
        fill: this.filled ? () => css(this.entries[index].swatch, "color").replace(")", " / 0.35)").replaceAll(",", " ") : null,
        width: 2,
        dash: curve.look === "dashed" ? DASH : null,
        paths: (plot, at) => (curve.look === "points" ? this.dots(plot, at) : this.line(plot, at)),
        points: { show: false },
      }));
      this.plot = new uPlot(
        {
          mode: 2,
          ...this.size(),
          legend: { show: false },
          padding: [10, 14, 0, 0],
          scales: {
            x: { time: false, distr: this.axes.x.log ? 3 : 1, range: () => this.view },
            y: { distr: this.axes.y.log ? 3 : 1, range: () => this.heights() },
          },
          axes: [axis("x", 30), axis("y", wide)],
          series: [{}, ...series],
          cursor: {
            y: false,
            drag: { x: true, y: false, dist: 8, setScale: false },
            dataIdx: (_, at) => this.index(at - 1),
            points: { size: 9, width: 2, stroke: (plot, at) => css(this.entries[at - 1].swatch, "color"), fill: () => css(document.body, "backgroundColor") },
            bind: { dblclick: () => () => this.look(this.whole) },
          },
          hooks: {
            drawClear: [(plot) => this.mark(plot)],
            drawAxes: [(plot) => this.name(plot)],
            draw: [(plot) => this.drawEvents(plot)],
            setCursor: [() => this.read()],
            setSelect: [(plot) => this.selected(plot)],
          },
        },
        [null, ...this.curves.map(({ x, y }) => [x, y])],
        this.area,
      );
      const over = this.plot.over;
      over.addEventListener("pointermove", (event) => {
        if (event.pointerType !== "touch") return;
        const box = over.getBoundingClientRect();
        this.plot.setCursor({ left: event.clientX - box.left, top: event.clientY - box.top });
      });
    }

    size() {
      const width = Math.max(Math.floor(this.area.clientWidth), 160);
      return { width, height: Math.round(Math.min(Math.max(0.62 * width, 230), 330)) };
    }

    resize() {
      // On paper the drawing of the screen is scaled, so that labels keep their room.
      if (matchMedia("print").matches) return;
      const size = this.size();
      if (size.width !== this.plot.width) this.plot.setSize(size);
    }

    line(plot, at) {
      const [stroke, fill] = [new Path2D(), this.filled ? new Path2D() : null];
      uPlot.orient(plot, at, (_series, x, y, scaleX, scaleY, toX, toY, left, top, width, height) => {
        let down = false;
        const floor = top + height;
        for (let index = 0; index < x.length; index++) {
          if (x[index] == null || y[index] == null) {
            down = false;
            continue;
          }
          const place = [toX(x[index], scaleX, width, left), toY(y[index], scaleY, height, top)];
          if (down) stroke.lineTo(...place);
          else stroke.moveTo(...place);
          if (fill) {
            if (index === 0) fill.moveTo(place[0], floor);
            fill.lineTo(...place);
          }
          down = true;
        }
      });
      return { stroke, fill };
    }

    dots(plot, at) {
      const fill = new Path2D();
      const radius = 3 * uPlot.pxRatio;
      uPlot.orient(plot, at, (_series, x, y, scaleX, scaleY, toX, toY, left, top, width, height) => {
        for (let index = 0; index < x.length; index++) {
          if (x[index] == null || y[index] == null) continue;
          const [h, v] = [toX(x[index], scaleX, width, left), toY(y[index], scaleY, height, top)];
          fill.moveTo(h + radius, v);
          fill.arc(h, v, radius, 0, 2 * Math.PI);
        }
      });
      return { stroke: fill };
    }

    /** Ends of the marked window on the canvas, if it is in view. */
    markedEnds({ bbox, valToPos }) {
      if (!this.marked) return null;
      const inside = (place) => Math.min(Math.max(place, bbox.left), bbox.left + bbox.width);
      const [from, to] = this.marked.range.map((place) => inside(valToPos(place, "x", true)));
      return to > from ? [from, to] : null;
    }

    /** Shades the marked window of the x axis. */
    mark(plot) {
      const ends = this.markedEnds(plot);
      if (!ends) return;
      plot.ctx.fillStyle = getComputedStyle(this.at).outlineColor;
      plot.ctx.fillRect(ends[0], plot.bbox.top, ends[1] - ends[0], plot.bbox.height);
    }

    /** Labels the marked window, over the grid and below the curves. */
    name(plot) {
      const ends = this.markedEnds(plot);
      if (!ends) return;
      const { ctx, bbox } = plot;
      const ratio = uPlot.pxRatio;
      const { color, outlineColor } = getComputedStyle(this.at);
      ctx.save();
      ctx.font = `${11 * ratio}px system-ui, sans-serif`;
      ctx.textBaseline = "top";
      ctx.textAlign = "left";
      const width = ctx.measureText(this.marked.words).width;
      const [left, top] = [ends[0] + 6 * ratio, bbox.top + 4 * ratio];
      if (width < ends[1] - ends[0] - 12 * ratio) {
        ctx.fillStyle = outlineColor;
        ctx.fillRect(left - 2 * ratio, top - ratio, width + 4 * ratio, 13 * ratio);
        ctx.fillStyle = color;
        ctx.fillText(this.marked.words, left, top);
      }
      ctx.restore();
    }

    /** Draws a line at each event, its name beside it in the first row where there is room. */
    drawEvents(plot) {
      const { ctx, bbox } = plot;
      const ratio = uPlot.pxRatio;
      const [low, high] = this.view;
      const seen = this.events.filter(({ at }) => at >= low && at <= high);
      if (seen.length === 0) return;
      const { color } = getComputedStyle(this.at);
      const paper = getComputedStyle(document.body).backgroundColor;
      const right = bbox.left + bbox.width;
      const rows = [];
      ctx.save();
      ctx.font = `${11 * ratio}px system-ui, sans-serif`;
      ctx.textBaseline = "top";
      ctx.textAlign = "left";
      const placed = seen.map(({ words, at }) => {
        const place = plot.valToPos(at, "x", true);
        const width = ctx.measureText(words).width;
        const left = Math.min(place + 4 * ratio, right - width - 2 * ratio);
        let row = rows.findIndex((end) => left > end + 6 * ratio);
        if (row < 0) row = rows.push(0) - 1;
        rows[row] = left + width;
        return { words, place, width, left, top: bbox.top + (3 + 14 * row) * ratio };
      });
      if (rows.length !== this.rows) {
        this.rows = rows.length;
        queueMicrotask(() => plot.setScale("x", { min: low, max: high }));
      }
      ctx.strokeStyle = color;
      ctx.lineWidth = ratio;
      ctx.setLineDash([3 * ratio, 3 * ratio]);
      for (const { place } of placed) {
        ctx.beginPath();
        ctx.moveTo(place, bbox.top);
        ctx.lineTo(place, bbox.top + bbox.height);
        ctx.stroke();
      }
      for (const { words, width, left, top } of placed) {
        ctx.fillStyle = paper;
        ctx.fillRect(left - 2 * ratio, top - ratio, width + 4 * ratio, 13 * ratio);
        ctx.fillStyle = color;
        ctx.fillText(words, left, top);
      }
      ctx.restore();
    }

    /** Index of the point of a curve that the cursor is at. */
    index(curve) {
      const { x, y, ascends } = this.curves[curve];
      const { left, top } = this.plot.cursor;
      if (left < 0 || x.length === 0) return null;
      if (ascends) {
        const place = this.plot.posToVal(left, "x");
        const slack = (this.view[1] - this.view[0]) / STEPS;
        if (place < x[0] - slack || place > x[x.length - 1] + slack) return null;
        const at = this.nearest(x, place);
        return y[at] == null ? null : at;
      }
      if (this.stepped?.curve === curve) return this.stepped.at;
      let [best, least] = [null, Infinity];
      for (let at = 0; at < x.length; at++) {
        if (y[at] == null) continue;
        const distance = Math.hypot(this.plot.valToPos(x[at], "x") - left, this.plot.valToPos(y[at], "y") - top);
        if (distance < least) [best, least] = [at, distance];
      }
      return best;
    }

    /** Shows the values at the cursor, and moves the cursors of the other figures. */
    read() {
      if (!this.plot) return;
      const { left } = this.plot.cursor;
      const values = [];
      const unit = split(this.axes.y.words)[1];
      this.entries.forEach(({ value }, curve) => {
        const at = left < 0 || !this.plot.series[curve + 1].show ? null : this.index(curve);
        value.textContent = at == null ? "" : short(this.curves[curve].y[at]);
        if (at != null) values.push(`${this.curves[curve].name} ${value.textContent}${unit && ` ${unit}`}`);
      });
      if (left < 0) {
        this.at.textContent = "";
        return;
      }
      const x = this.plot.posToVal(left, "x");
      const [quantity, of] = split(this.axes.x.words);
      this.at.textContent = `${quantity} ${short(x)}${of && ` ${of}`}`;
      const rest = values.length > MOST_READ ? `, and ${values.length - MOST_READ} more` : "";
      this.reading.textContent = `${this.at.textContent}: ${values.slice(0, MOST_READ).join(", ")}${rest}`;
      if (this.following) return;
      document.dispatchEvent(new CustomEvent("moment", { detail: { words: this.axes.x.words, x, from: this } }));
    }

    /** Moves the cursor to that of another figure. */
    follow({ words, x, from }) {
      if (from === this || words !== this.axes.x.words) return;
      this.following = true;
      const inside = x >= this.view[0] && x <= this.view[1];
      this.plot.setCursor(inside ? { left: this.plot.valToPos(x, "x"), top: 0 } : { left: -10, top: -10 });
      // The other figure has the reading.
      this.reading.textContent = "";
      this.following = false;
    }

    selected(plot) {
      const { left, width } = plot.select;
      if (width > 0) this.look([plot.posToVal(left, "x"), plot.posToVal(left + width, "x")]);
      plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    }

    /** Shows an interval of the x axis, clamped to the whole. */
    look(wanted) {
      const [low, high] = this.whole;
      const [from, to] = this.axes.x.log ? roundEnds(wanted) : wanted;
      const view = [Math.max(from, low), Math.min(to, high)];
      if (!(view[1] > view[0])) return;
      this.view = view;
      this.all.disabled = view[0] === low && view[1] === high;
      this.plot.setScale("x", { min: view[0], max: view[1] });
    }

    /** Widens or narrows the view about the cursor. */
    zoom(factor) {
      const scale = this.axes.x.log ? [Math.log, Math.exp] : [(x) => x, (x) => x];
      const [low, high] = this.view.map(scale[0]);
      const { left } = this.plot.cursor;
      const about = left > 0 ? scale[0](this.plot.posToVal(left, "x")) : (low + high) / 2;
      const least = 1e-6 * Math.abs(scale[0](this.whole[1]) - scale[0](this.whole[0]));
      if (factor < 1 && high - low < least) return;
      const ends = [about - factor * (about - low), about + factor * (high - about)].map(scale[1]);
      this.look(ends);
    }

    key(event) {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const actions = {
        ArrowLeft: () => this.step(event.shiftKey ? -10 : -1),
        ArrowRight: () => this.step(event.shiftKey ? 10 : 1),
        Home: () => this.step(-Infinity),
        End: () => this.step(Infinity),
        "+": () => this.zoom(0.5),
        "=": () => this.zoom(0.5),
        "-": () => this.zoom(2),
        0: () => this.look(this.whole),
        Escape: () => {
          this.look(this.whole);
          this.plot.setCursor({ left: -10, top: -10 });
          this.reading.textContent = "everything is shown";
        },
      };
      const action = actions[event.key];
      if (!action) return;
      event.preventDefault();
      action();
    }

    /** Moves the cursor by hundredths of the view, or along the first visible curve where its abscissae do not ascend. */
    step(count) {
      const plot = this.plot;
      const first = this.curves.findIndex((_, curve) => plot.series[curve + 1].show);
      if (first < 0) return;
      const { x, y, ascends } = this.curves[first];
      const bounded = (value, most) => Math.min(Math.max(value, 0), most);
      if (ascends) {
        const width = plot.over.clientWidth;
        const start = plot.cursor.left < 0 ? (count > 0 ? 0 : width) : plot.cursor.left;
        plot.setCursor({ left: bounded(start + (count * width) / STEPS, width), top: 0 });
        return;
      }
      const before = this.stepped?.at ?? (plot.cursor.left < 0 ? 0 : this.index(first) ?? 0);
      const at = bounded(before + count * Math.max(1, Math.round(x.length / STEPS)), x.length - 1);
      this.stepped = { curve: first, at };
      if (y[at] != null) plot.setCursor({ left: plot.valToPos(x[at], "x"), top: plot.valToPos(y[at], "y") });
      delete this.stepped;
    }

    toggle(curve) {
      const show = !this.plot.series[curve + 1].show;
      this.entries[curve].button.setAttribute("aria-pressed", String(show));
      this.plot.setSeries(curve + 1, { show });
      this.look(this.view);
    }

    /** Saves the curves as a table, one line a point. */
    save() {
      const quoted = (text) => `"${text.replaceAll('"', '""')}"`;
      const lines = [["curve", this.axes.x.words, this.axes.y.words].map(quoted).join()];
      for (const { name, x, y } of this.curves) {
        x.forEach((place, at) => lines.push([quoted(name), place ?? "", y[at] ?? ""].join()));
      }
      const link = make("a", { download: `${this.title.replace(/[^\p{L}\p{N}]+/gu, "-")}.csv` });
      link.href = URL.createObjectURL(new Blob([lines.join("\n"), "\n"], { type: "text/csv" }));
      link.click();
      URL.revokeObjectURL(link.href);
    }
  }

  // Other scripts find the figure at its element.
  for (const element of document.querySelectorAll("figure.plot")) element.plot = new Figure(element);
})();
