// The mechanism: its items drawn at any time, between the frames by straight lines.
const INK = "#2b323c", BODY = "#c3cad3", EDGE = "#6b7787", BEAM = "#0072b2", SPRING = "#009e73", MOTOR = "#e69f00";
const TRAIL = "rgba(213, 94, 0, 0.45)", TIP = "#d55e00";
const BORDER = 0.08, COILS = 6;

class Player {
  constructor(canvas, scene) {
    Object.assign(this, { canvas, scene, time: 0, trail: scene.trail });
    this.times = arrays[scene.time];
    this.frames = this.times.length;
    this.exaggerate(1);
  }

  // Draw deflections so many times as large, in a picture that has room for it.
  exaggerate(scale) {
    this.deflection = scale;
    this.extent = [...this.scene.extent];
    this.tracks = Object.fromEntries(Object.entries(this.scene.tracks).map(([name, place]) => [name, arrays[place]]));
    if (scale === 1) return;
    const present = this.time;
    for (const item of this.scene.items.filter((each) => each.straight !== undefined)) {
      const ends = [];
      for (this.time of this.times) {
        const points = this.pointsOf(item);
        points.forEach((value, i) => {
          const low = 2 * (i % 2);
          this.extent[low] = Math.min(this.extent[low], value);
          this.extent[low + 1] = Math.max(this.extent[low + 1], value);
        });
        ends.push(...points.slice(-2));
      }
      if (`${item.body}.end` in this.tracks) this.tracks[`${item.body}.end`] = ends;
    }
    this.time = present;
  }

  get duration() { return this.times[this.frames - 1]; }

  // Points of an array of frames at the present time: [x, y, x, y, ...].
  at(values, count) {
    const size = 2 * count;
    if (values.length === size) return values;
    const k = Math.min(before(this.times, this.time), this.frames - 2);
    const part = Math.min(Math.max((this.time - this.times[k]) / (this.times[k + 1] - this.times[k]), 0), 1);
    const found = new Float64Array(size);
    for (let i = 0; i < size; i++) {
      found[i] = (1 - part) * values[k * size + i] + part * values[(k + 1) * size + i];
    }
    return found;
  }

  pointsOf(item) {
    const points = this.at(arrays[item.points], item.count);
    if (item.straight === undefined || this.deflection === 1) return points;
    const [x0, y0, x1, y1] = this.at(arrays[item.straight], 2);
    return Float64Array.from(points, (value, i) => {
      const along = item.along[i >> 1];
      const straight = i % 2 ? y0 + along * (y1 - y0) : x0 + along * (x1 - x0);
      return straight + this.deflection * (value - straight);
    });
  }

  draw() {
    const [left, right, bottom, top] = this.extent;
    const border = BORDER * Math.max(right - left, top - bottom);
    const across = right - left + 2 * border, up = top - bottom + 2 * border;
    const ideal = (this.canvas.clientWidth * up) / across;
    const [context, width, height] = prepare(this.canvas, Math.round(Math.min(Math.max(ideal, 200), 480)));
    this.canvas.style.height = `${height}px`;
    this.pixels = Math.min(width / across, height / up);
    this.originX = width / 2 - (this.pixels * (left + right)) / 2;
    this.originY = height / 2 + (this.pixels * (bottom + top)) / 2;
    Object.assign(this.canvas.dataset, { pixels: this.pixels, originX: this.originX, originY: this.originY });
    this.context = context;
    context.lineCap = context.lineJoin = "round";
    this.drawScale(height);
    if (this.trail) this.drawTrail();
    for (const item of this.scene.items) this[`draw_${item.kind}`](this.toPixels(this.pointsOf(item)));
    if (this.trail) this.drawTip();
  }

  toPixels(points) {
    const found = [];
    for (let i = 0; i < points.length; i += 2) {
      found.push([this.originX + this.pixels * points[i], this.originY - this.pixels * points[i + 1]]);
    }
    return found;
  }

  path(points, closed = false) {
    this.context.beginPath();
    for (const [x, y] of points) this.context.lineTo(x, y);
    if (closed) this.context.closePath();
  }

  line(points, colour, width, dash = []) {
    this.path(points);
    this.context.strokeStyle = colour;
    this.context.lineWidth = width;
    this.context.setLineDash(dash);
    this.context.stroke();
    this.context.setLineDash([]);
  }

  area(points, fill, edge, width) {
    this.path(points, true);
    this.context.fillStyle = fill;
    this.context.fill();
    this.context.strokeStyle = edge;
    this.context.lineWidth = width;
    this.context.stroke();
  }

  disc([x, y], radius, fill, edge = null) {
    this.context.beginPath();
    this.context.arc(x, y, radius, 0, 2 * Math.PI);
    this.context.fillStyle = fill;
    this.context.fill();
    if (edge) {
      this.context.strokeStyle = edge;
      this.context.lineWidth = 1.5;
      this.context.stroke();
    }
  }

  // A bar of a round length in the corner.
  drawScale(height) {
    const [, length] = ticks(0, 120 / this.pixels, 1), end = 14 + length * this.pixels;
    this.line([[14, height - 14], [end, height - 14]], "#7b8695", 2);
    this.context.font = "11px system-ui, sans-serif";
    this.context.fillStyle = "#5f6b7a";
    this.context.fillText(`${Number(length.toPrecision(3))} m`, 14, height - 20);
  }

  drawTrail() {
    const track = this.tracks[this.trail], past = track.slice(0, 2 * (before(this.times, this.time) + 1));
    this.line(this.toPixels(track), "rgba(213, 94, 0, 0.18)", 1.2);
    this.line([...this.toPixels(past), ...this.toPixels(this.at(track, 1))], TRAIL, 2);
  }

  drawTip() {
    this.disc(this.toPixels(this.at(this.tracks[this.trail], 1))[0], 4, TIP);
  }

  get size() { return Math.max(5, this.pixels * this.scene.symbol); }

  draw_rail(points) { this.line(points, "#9aa4b1", 1.2, [7, 4]); }

  draw_body(points) {
    if (points.length > 2) return this.draw_shape(points);
    this.line(points, EDGE, 11);
    this.line(points, BODY, 8);
  }

  draw_shape(points) { this.area(points, "rgba(195, 202, 211, 0.85)", EDGE, 1.6); }

  draw_wheel([centre, rim]) {
    this.disc(centre, Math.hypot(rim[0] - centre[0], rim[1] - centre[1]), BODY, EDGE);
    this.line([centre, rim], EDGE, 2);
  }

  draw_beam(points) { this.line(points, BEAM, 4); }

  draw_block(points) { this.area(points, "white", INK, 1.6); }

  draw_pin([centre]) { this.disc(centre, 4.5, "white", INK); }

  draw_motor([centre]) { this.disc(centre, 8, MOTOR, INK); }

  draw_spring([[x0, y0], [x1, y1]]) {
    const length = Math.hypot(x1 - x0, y1 - y0) || 1, swing = (0.6 * this.size) / length;
    const points = [[0, 0], [0.17, 0]];
    for (let k = 0; k < 2 * COILS; k++) points.push([0.2 + (0.6 * k) / (2 * COILS - 1), k % 2 ? -swing : swing]);
    points.push([0.83, 0], [1, 0]);
    this.line(points.map(([s, n]) => [x0 + s * (x1 - x0) - n * (y1 - y0), y0 + s * (y1 - y0) + n * (x1 - x0)]), SPRING, 1.8);
  }

  draw_ground([[x, y]]) {
    const size = this.size, foot = y + 1.7 * size;
    this.area([[x, y], [x - size, foot], [x + size, foot]], "white", INK, 1.4);
    this.hatch([x, foot], [0, 1], 1.7 * size);
  }

  draw_clamp([[x, y], [toX, toY]]) {
    const length = Math.hypot(toX - x, toY - y) || 1;
    this.hatch([x, y], [(x - toX) / length, (y - toY) / length], 2.2 * this.size);
  }

  // A wall through a point; `away` points from the mechanism into it.
  hatch([x, y], [ax, ay], half) {
    const [sx, sy] = [-ay, ax], length = 0.55 * this.size;
    this.line([[x - sx * half, y - sy * half], [x + sx * half, y + sy * half]], INK, 1.4);
    for (let k = -1; k <= 1.01; k += 0.4) {
      const [fx, fy] = [x + k * half * sx, y + k * half * sy];
      this.line([[fx, fy], [fx + (ax + sx) * length, fy + (ay + sy) * length]], INK, 1);
    }
  }
}
