// Plots: curves over time that zoom together, with the values under the pointer in their legends.
const COLOURS = ["#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9"];
const DASHES = [[], [6, 3], [2, 2]];
const MARGIN = { left: 62, right: 8, top: 8, bottom: 34 };
const DRAG = 4;

class Plot {
  // `group` holds the plots over the same axis: their `range`, and `hover`, where the pointer is.
  constructor(parent, panel, across, group) {
    Object.assign(this, { panel, across, group });
    this.curves = panel.curves.map((curve, k) => ({
      label: curve.label, look: curve.look, x: arrays[curve.x], y: arrays[curve.y], visible: true, ...this.paint(curve, k),
    }));
    if (panel.title) create("h4", parent, "", panel.title);
    this.makeLegend(parent);
    this.canvas = create("canvas", parent);
    this.listen();
    group.plots.push(this);
    // where points are, and may be named on the axis
    this.stops = [...new Set(this.curves.filter((curve) => curve.look === "points").flatMap((curve) => [...curve.x]))];
    this.stops.sort((a, b) => a - b);
    const ends = this.curves.flatMap((curve) => [curve.x[0], curve.x[curve.x.length - 1]]);
    if (this.stops.length) {
      const [low, high] = [Math.min(...ends), Math.max(...ends)].map(group.scale), room = 0.06 * (high - low) || 0.1;
      ends.push(group.unscale(low - room), group.unscale(high + room));
    }
    group.all = [Math.min(group.all[0], ...ends), Math.max(group.all[1], ...ends)];
    group.range = [...group.all];
  }

  paint(curve, k) {
    const count = this.panel.curves.length;
    if (curve.look === "guide") return { colour: "#4a5563", dash: [2, 3] };
    if (this.panel.family || count > COLOURS.length * DASHES.length) {
      return { colour: `hsl(${265 - (200 * k) / Math.max(1, count - 1)} 65% ${32 + (22 * k) / count}%)`, dash: [] };
    }
    return { colour: COLOURS[k % COLOURS.length], dash: DASHES[Math.floor(k / COLOURS.length)] };
  }

  makeLegend(parent) {
    const list = create("ul", parent, "legend");
    for (const curve of this.curves) {
      const button = create("button", create("li", list));
      button.type = "button";
      create("i", button).style.background = curve.dash.length
        ? `repeating-linear-gradient(90deg, ${curve.colour} 0 ${curve.dash[0]}px, transparent 0 ${curve.dash[0] + curve.dash[1]}px)`
        : curve.colour;
      create("span", button, "", curve.label);
      curve.value = create("b", button);
      button.addEventListener("click", () => {
        curve.visible = !curve.visible;
        button.classList.toggle("hidden", !curve.visible);
        this.draw();
      });
    }
  }

  listen() {
    const at = (event) => {
      const place = event.clientX - this.canvas.getBoundingClientRect().left;
      return Math.min(Math.max(this.toValue(place), this.group.range[0]), this.group.range[1]);
    };
    let pressed = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      pressed = { pixel: event.clientX, value: at(event) };
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      this.group.hover = at(event);
      this.group.span = pressed && Math.abs(event.clientX - pressed.pixel) > DRAG ? [pressed.value, at(event)] : null;
      this.group.draw();
    });
    this.canvas.addEventListener("pointerup", (event) => {
      if (this.group.span) this.group.range = this.group.span.sort((a, b) => a - b);
      else if (pressed) this.group.click(at(event));
      pressed = this.group.span = null;
      this.group.draw();
    });
    this.canvas.addEventListener("pointerleave", () => {
      this.group.hover = null;
      this.group.draw();
    });
    this.canvas.addEventListener("dblclick", () => {
      this.group.range = [...this.group.all];
      this.group.draw();
    });
  }

  toValue(pixel) {
    const [low, high] = this.group.range.map(this.group.scale);
    const width = this.canvas.clientWidth - MARGIN.left - MARGIN.right;
    return this.group.unscale(low + ((pixel - MARGIN.left) / width) * (high - low));
  }

  // Lowest and highest value in the range, as the axis has them.
  limits() {
    const [from, to] = this.group.range, logarithmic = this.panel.logarithmic;
    let low = Infinity, high = -Infinity;
    for (const { x, y, visible } of this.curves) {
      if (!visible) continue;
      for (let k = before(x, from), last = before(x, to); k <= last; k++) {
        const value = logarithmic ? Math.log10(Math.abs(y[k])) : y[k];
        if (!isFinite(value)) continue;
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    if (low > high) return [0, 1];
    if (logarithmic) return [Math.floor(low), Math.max(Math.ceil(high), Math.floor(low) + 1)];
    const room = 0.06 * (high - low) || 0.1 * Math.abs(high) || 1;
    return [low - room, high + room];
  }

  draw() {
    const [context, width, height] = prepare(this.canvas, this.canvas.clientHeight);
    const { scale } = this.group, [from, to] = this.group.range.map(scale), [low, high] = this.limits();
    const { left, right, top, bottom } = MARGIN;
    const across = (x) => left + ((scale(x) - from) / (to - from)) * (width - left - right);
    const up = (y) => height - bottom - ((y - low) / (high - low)) * (height - top - bottom);
    this.drawAxes(context, width, height, across, up, low, high);
    context.save();
    context.beginPath();
    context.rect(left, top - 2, width - left - right, height - top - bottom + 4);
    context.clip();
    for (const curve of this.curves) if (curve.visible) this.drawCurve(context, curve, across, up);
    this.drawMarks(context, across, top, height - bottom);
    context.restore();
    this.showValues();
  }

  drawAxes(context, width, height, across, up, low, high) {
    const { left, right, top, bottom } = MARGIN, [from, to] = this.group.range;
    context.font = "11px system-ui, sans-serif";
    context.lineWidth = 1;
    context.strokeStyle = "#e6e9ee";
    context.fillStyle = "#4a5563";
    const [evenly, xStep] = ticks(from, to, Math.max(2, width / 75));
    const xs = this.stops.length ? this.stops.filter((x) => x >= from && x <= to) : evenly;
    let [ys, yStep] = ticks(low, high, 4);
    if (this.panel.logarithmic) ys = ys.filter((y) => Math.abs(y - Math.round(y)) < 1e-6);
    context.beginPath();
    for (const x of xs) { context.moveTo(across(x), top); context.lineTo(across(x), height - bottom); }
    for (const y of ys) { context.moveTo(left, up(y)); context.lineTo(width - right, up(y)); }
    context.stroke();
    context.textAlign = "center";
    for (const x of xs) {
      const text = this.stops.length ? `${Number(x.toPrecision(3))}` : shown(x, xStep), half = context.measureText(text).width / 2;
      context.fillText(text, Math.min(across(x), width - half), height - bottom + 13);
    }
    const [quantity, unit] = this.across;
    context.fillText(unit ? `${quantity} [${unit}]` : quantity, (left + width - right) / 2, height - 5);
    context.textAlign = "right";
    for (const y of ys) context.fillText(this.panel.logarithmic ? `1e${Math.round(y)}` : shown(y, yStep), left - 5, up(y) + 4);
    context.save();
    context.translate(11, (top + height - bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(`${this.panel.quantity} [${this.panel.unit}]`, 0, 0, height - 8);
    context.restore();
    context.strokeStyle = "#9aa4b1";
    context.strokeRect(left, top, width - left - right, height - top - bottom);
  }

  // One stroke for each column of pixels, from the lowest to the highest value in it.
  drawCurve(context, curve, across, up) {
    const { x, y } = curve, [from, to] = this.group.range, logarithmic = this.panel.logarithmic;
    const first = Math.max(0, before(x, from) - 1), last = Math.min(x.length - 1, before(x, to) + 2);
    context.strokeStyle = curve.colour;
    context.lineWidth = 1.4;
    context.lineJoin = "round";
    context.setLineDash(curve.dash);
    context.beginPath();
    let column = null, low = 0, high = 0, end = 0, started = false;
    const flush = () => {
      if (column === null) return;
      if (low !== high) { context.lineTo(column, low); context.lineTo(column, high); }
      context.lineTo(column, end);
    };
    for (let k = first; k <= last; k++) {
      const value = logarithmic ? Math.log10(Math.abs(y[k])) : y[k];
      if (!isFinite(value)) continue;
      const pixel = across(x[k]), place = up(value), own = Math.round(2 * pixel) / 2;
      if (!started) { context.moveTo(pixel, place); started = true; }
      if (own !== column) {
        flush();
        column = own;
        low = high = place;
      }
      low = Math.min(low, place);
      high = Math.max(high, place);
      end = place;
    }
    flush();
    context.stroke();
    context.setLineDash([]);
    if (curve.look === "points") this.drawPoints(context, curve, across, up);
  }

  drawPoints(context, { x, y, colour }, across, up) {
    context.fillStyle = colour;
    for (let k = 0; k < x.length; k++) {
      const value = this.panel.logarithmic ? Math.log10(Math.abs(y[k])) : y[k];
      if (!isFinite(value)) continue;
      context.beginPath();
      context.arc(across(x[k]), up(value), 4, 0, 2 * Math.PI);
      context.fill();
    }
  }

  drawMarks(context, across, top, bottom) {
    const { hover, span, now } = this.group;
    if (span) {
      context.fillStyle = "rgba(0, 114, 178, 0.15)";
      context.fillRect(across(span[0]), top, across(span[1]) - across(span[0]), bottom - top);
    }
    for (const [x, colour] of [[now, "#d55e00"], [hover, "#5f6b7a"]]) {
      if (x === null) continue;
      context.strokeStyle = colour;
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(across(x), top);
      context.lineTo(across(x), bottom);
      context.stroke();
    }
  }

  // Values at the pointer, else at the time of the mechanism; of points those at the nearest stop.
  showValues() {
    const { hover, now, scale } = this.group, distance = (x) => Math.abs(scale(x) - scale(hover));
    let at = hover ?? now;
    if (at !== null && this.stops.length) at = this.stops.reduce((a, b) => (distance(b) < distance(a) ? b : a));
    for (const curve of this.curves) {
      if (this.stops.length && !curve.x.includes(at)) {
        curve.value.textContent = "";
        continue;
      }
      const k = at === null ? -1 : before(curve.x, at);
      const next = Math.min(k + 1, curve.x.length - 1);
      const nearest = k >= 0 && Math.abs(curve.x[next] - at) < Math.abs(curve.x[k] - at) ? next : k;
      const value = nearest < 0 ? NaN : curve.y[nearest];
      curve.value.textContent = isFinite(value) ? Number(value.toPrecision(4)).toString() : "";
    }
  }
}

function makeGroup(click, logarithmic = false) {
  return {
    scale: logarithmic ? Math.log10 : (x) => x,
    unscale: logarithmic ? (x) => 10 ** x : (x) => x,
    plots: [], all: [Infinity, -Infinity], range: null, hover: null, span: null, now: null, click,
    draw() { for (const plot of this.plots) plot.draw(); },
  };
}
