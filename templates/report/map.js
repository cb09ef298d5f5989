// The map of the sheet: triangles are filled pixel by pixel (no seams, no GPU needed); zoomed in, the channels themselves.
const sheet = (() => {
  const STREAKS = 1500, STREAK_PX = 11, CHANNEL_PX = 2.5, REST_MS = 150;
  const canvas = $("map-canvas"), pen = canvas.getContext("2d", { willReadFrequently: true }), tip = $("map-tip");
  const corners = array("corners", Float64Array), phase = array("phase", Float64Array), K = meta.corners, residual = array("residual", Float32Array);
  const edge = Float64Array.from({ length: count }, (_, t) => Math.sqrt(column.area_mm2[t] * 4 / Math.sqrt(3)) * 1000);
  const x = (t, i) => corners[2 * (K * t + i)], y = (t, i) => corners[2 * (K * t + i) + 1];
  const sides = Array.from({ length: K }, (_, i) => i);
  const centre = t => [sides.reduce((sum, i) => sum + x(t, i), 0) / K, sides.reduce((sum, i) => sum + y(t, i), 0) / K];
  const widest = values => { let most = 0; for (const v of values) most = Math.max(most, Math.abs(v)); return most || 1; };
  const range = values => { let low = Infinity, high = -Infinity; for (const v of values) { low = Math.min(low, v); high = Math.max(high, v); } return [low, high > low ? high : low + 1]; };
  const twist = widest(column.dtheta_deg);

  const doubled = column.theta_deg.reduce(([c, d], a) => [c + Math.cos(a * Math.PI / 90), d + Math.sin(a * Math.PI / 90)], [0, 0]);
  const mean = Math.atan2(doubled[1], doubled[0]) * 90 / Math.PI;
  const turned = column.theta_deg.map(a => ((a - mean + 450) % 180) - 90);

  // Name, values, colour map, range, unit. The director's colour follows the view: what the plate has, as drawn.
  const quantities = {
    theta: ["director θ", null, "twilight", [0, 180], "°"],
    turned: [`director θ less its mean of ${((mean + 180) % 180).toFixed(1)}°`, turned, "viridis", range(turned), "°"],
    dtheta: ["twist Δθ", column.dtheta_deg, "diverging", [-twist, twist], "°"],
    residual: ["error of the stretches", residual, "viridis", [0, range(residual)[1]], "%"],
    size: ["size (edge of an equal triangle)", edge, "cividis", range(edge), "µm"],
  };
  const views = {
    sheet: ["theta_deg", 1], bottom: ["theta_bottom_deg", 1], "bottom-written": ["written_bottom_deg", 1],
    top: ["theta_top_deg", 1], "top-written": ["written_top_deg", -1],
  };
  for (const [key, [name]] of Object.entries(quantities)) $("map-quantity").add(new Option(name, key));

  const bounds = range(corners.filter((_, k) => k % 2 === 0)).concat(range(corners.filter((_, k) => k % 2)));
  const middle = [(bounds[0] + bounds[1]) / 2, (bounds[2] + bounds[3]) / 2];
  const camera = { x: middle[0], y: middle[1], scale: 1, home: true };          // scale: CSS pixels per mm
  const state = { quantity: "theta", view: "sheet", hover: -1 };
  const paint = new Uint32Array(count);                         // of each domain, as a pixel holds it: alpha, blue, green, red
  const layer = document.createElement("canvas"), brush = layer.getContext("2d", { willReadFrequently: true });
  let ratio = 1, frames = 0, image = null, pixels = null, filled = "", layered = null, moving = 0;

  const angles = () => column[views[state.view][0]];
  const mirror = () => views[state.view][1];
  const values = () => quantities[state.quantity][1] || angles();
  const shade = value => { const [low, high] = quantities[state.quantity][3]; return (value - low) / (high - low); };
  const whole = () => Math.min(canvas.clientWidth / (bounds[1] - bounds[0]), canvas.clientHeight / (bounds[3] - bounds[2])) * 0.94;
  const toScreen = (px, py) => [canvas.clientWidth / 2 + camera.scale * mirror() * (px - camera.x), canvas.clientHeight / 2 - camera.scale * (py - camera.y)];
  const toSheet = (sx, sy) => [camera.x + mirror() * (sx - canvas.clientWidth / 2) / camera.scale, camera.y - (sy - canvas.clientHeight / 2) / camera.scale];

  // A grid of cells over the sheet, each with the triangles that reach into it: for the pointer and for what is in sight.
  const N = Math.max(1, Math.ceil(Math.sqrt(count))), grid = Array.from({ length: N * N }, () => []);
  const cellX = v => Math.max(0, Math.min(N - 1, Math.floor((v - bounds[0]) / (bounds[1] - bounds[0]) * N)));
  const cellY = v => Math.max(0, Math.min(N - 1, Math.floor((v - bounds[2]) / (bounds[3] - bounds[2]) * N)));
  for (let t = 0; t < count; t++) {
    const xs = sides.map(i => cellX(x(t, i))), ys = sides.map(i => cellY(y(t, i)));
    for (let i = Math.min(...xs); i <= Math.max(...xs); i++) for (let j = Math.min(...ys); j <= Math.max(...ys); j++) grid[j * N + i].push(t);
  }
  const side = (t, i, px, py) => { const k = (i + 1) % K; return (x(t, k) - x(t, i)) * (py - y(t, i)) - (y(t, k) - y(t, i)) * (px - x(t, i)); };
  function pick(px, py) {
    if (!(px >= bounds[0] && px <= bounds[1] && py >= bounds[2] && py <= bounds[3])) return -1;
    return grid[cellY(py) * N + cellX(px)].find(t => sides.every(i => side(t, i, px, py) >= 0)) ?? -1;
  }
  function inSight() {
    const [ax, ay] = toSheet(0, 0), [bx, by] = toSheet(canvas.clientWidth, canvas.clientHeight), seen = new Set();
    for (let j = cellY(Math.min(ay, by)); j <= cellY(Math.max(ay, by)); j++)
      for (let i = cellX(Math.min(ax, bx)); i <= cellX(Math.max(ax, bx)); i++) for (const t of grid[j * N + i]) seen.add(t);
    return [...seen];
  }

  function trace(path, t) { path.moveTo(x(t, 0), y(t, 0)); for (let i = 1; i < K; i++) path.lineTo(x(t, i), y(t, i)); path.closePath(); }
  /** Fill the triangles: a pixel belongs to the one that holds its centre, shared edges are computed alike. */
  function raster(scale, m, seen) {
    const w = canvas.width, h = canvas.height, ox = w / 2 - scale * m * camera.x, oy = h / 2 + scale * camera.y;
    if (!image || image.width !== w || image.height !== h) { image = pen.createImageData(w, h); pixels = new Uint32Array(image.data.buffer); }
    pixels.fill(0);
    for (let k = 0, n = (seen ? seen.length : count) * (K - 2); k < n; k++) {        // each domain as a fan of triangles
      const f = Math.floor(k / (K - 2)), t = seen ? seen[f] : f, i = 1 + k % (K - 2), ink = paint[t];
      let ax = ox + scale * m * x(t, 0), ay = oy - scale * y(t, 0), bx = ox + scale * m * x(t, i), by = oy - scale * y(t, i);
      let cx = ox + scale * m * x(t, i + 1), cy = oy - scale * y(t, i + 1);
      if (by < ay) [ax, ay, bx, by] = [bx, by, ax, ay];
      if (cy < by) [bx, by, cx, cy] = [cx, cy, bx, by];
      if (by < ay) [ax, ay, bx, by] = [bx, by, ax, ay];
      for (let row = Math.max(0, Math.ceil(ay - 0.5)), end = Math.min(h, Math.ceil(cy - 0.5)); row < end; row++) {
        const at = row + 0.5, one = ax + (at - ay) * (cx - ax) / (cy - ay);
        const two = at < by ? ax + (at - ay) * (bx - ax) / (by - ay) : bx + (at - by) * (cx - bx) / (cy - by);
        const from = Math.max(0, Math.ceil((one < two ? one : two) - 0.5)), to = Math.min(w, Math.ceil((one < two ? two : one) - 0.5));
        for (let p = row * w + from, last = row * w + to; p < last; p++) pixels[p] = ink;
      }
    }
    pen.putImageData(image, 0, 0);
  }

  function recolour() {
    const shown = values(), name = quantities[state.quantity][2];
    for (let t = 0; t < count; t++) { const [r, g, b] = colour(name, shade(shown[t])); paint[t] = (255 << 24 | b << 16 | g << 8 | r) >>> 0; }
    const bar = $("map-bar"), brush = bar.getContext("2d"), [low, high] = quantities[state.quantity][3];
    for (let k = 0; k < 256; k++) { brush.fillStyle = `rgb(${colour(name, k / 255).join()})`; brush.fillRect(k, 0, 1, 1); }
    const digits = high - low > 50 ? 0 : 2, unit = quantities[state.quantity][4];
    $("map-ticks").replaceChildren(...[0, 0.25, 0.5, 0.75, 1].map(share => { const tick = document.createElement("span"); tick.textContent = (low + share * (high - low)).toFixed(digits) + (unit === "°" ? "" : " ") + unit; return tick; }));
    redraw();
  }

  /** The channels of domain t along `angle` [rad] on plate 0 (bottom) or 1: [middle x, middle y, length] in mm, by the masks' rule. */
  function channels(t, angle, plate) {
    const { width, pitch, guard } = meta.channels, c = Math.cos(angle), s = Math.sin(angle);
    const [ox, oy] = centre(t);
    const p = sides.map(i => [c * (x(t, i) - ox) + s * (y(t, i) - oy), c * (y(t, i) - oy) - s * (x(t, i) - ox)]);
    const normal = p.map((a, i) => { const b = p[(i + 1) % K], l = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1; return [(b[1] - a[1]) / l, (a[0] - b[0]) / l]; });
    let low = Infinity, high = -Infinity;
    p.forEach((a, i) => {
      const n = normal[i], m = normal[(i + K - 1) % K], v = a[1] - guard * (n[1] + m[1]) / Math.max(1 + n[0] * m[0] + n[1] * m[1], 1e-9);
      low = Math.min(low, v); high = Math.max(high, v);
    });
    low = Math.max(low, Math.min(...p.map(a => a[1])) - guard); high = Math.min(high, Math.max(...p.map(a => a[1])) + guard);
    const rest = phase.length ? phase[2 * t + plate] - (c * oy - s * ox) - low - width / 2 : 0, spare = rest - Math.floor(rest / pitch) * pitch;
    const number = Math.floor((high - low - width - spare) / pitch) + 1, made = [];
    const first = phase.length ? low + width / 2 + spare : (low + high - (number - 1) * pitch) / 2;
    for (let k = 0; k < number; k++) {
      const v = first + k * pitch;
      let left = -Infinity, right = Infinity;
      normal.forEach((n, i) => {
        if (Math.abs(n[0]) <= 1e-9) return;
        const end = (n[0] * p[i][0] + n[1] * p[i][1] - guard - Math.abs(n[1]) * width / 2 - n[1] * v) / n[0];
        if (n[0] < 0) left = Math.max(left, end); else right = Math.min(right, end);
      });
      const length = Math.floor((right - left) * 1e4) / 1e4, at = (left + right) / 2;
      if (length >= 0.002) made.push([ox + c * at - s * v, oy + s * at + c * v, length]);
    }
    return made;
  }

  function draw() {
    ratio = fit(canvas);
    if (camera.home) { camera.scale = whole(); [camera.x, camera.y] = middle; }
    const w = canvas.width, h = canvas.height, scale = camera.scale * ratio, m = mirror();
    const seen = camera.scale > 1.5 * whole() ? inSight() : null;
    const look = [w, h, scale, camera.x, camera.y, state.quantity, state.view].join();
    if (look === filled) pen.putImageData(image, 0, 0); else raster(scale, m, seen);
    filled = look;
    if (Math.sqrt((bounds[1] - bounds[0]) * (bounds[3] - bounds[2]) / count) * camera.scale > STREAK_PX) overlay(look, seen || inSight());
    place(pen, camera);
    outline(selection.domain, css("--pick"), 3);
    outline(state.hover, css("--ink"), 1.5);
    frames++;
  }

  /** Let a pen draw in mm as a camera sees the sheet. */
  function place(onto, { x: px, y: py, scale: s }) {
    const scale = s * ratio, m = mirror();
    onto.setTransform(scale * m, 0, 0, -scale, canvas.width / 2 - scale * m * px, canvas.height / 2 + scale * py);
  }

  /** The lines, which take long, are drawn where the map rests; while it moves the last ones move with it. */
  function overlay(look, seen) {
    const w = canvas.width, h = canvas.height;
    if (layered?.look !== look && !moving) {
      layer.width = w; layer.height = h;                          // which also clears it
      place(brush, camera);
      lines(brush, seen);
      layered = { look, view: state.view, ...camera };
    }
    const k = camera.scale / layered?.scale, scale = camera.scale * ratio, m = mirror();
    if (layered?.view !== state.view || k > 3 || k < 1 / 3) return;
    const right = (1 - k) * w / 2 + scale * m * (layered.x - camera.x), down = (1 - k) * h / 2 - scale * (layered.y - camera.y);
    pen.setTransform(k, 0, 0, k, Math.round(right), Math.round(down));  // whole pixels keep the lines sharp
    pen.drawImage(layer, 0, 0);
  }
  function moved() {
    clearTimeout(moving);
    moving = setTimeout(() => { moving = 0; redraw(); }, REST_MS);
    redraw();
  }

  function lines(onto, seen) {
    const along = angles(), m = mirror();                       // the view itself is mirrored, so its lines turn back
    const line = t => { const a = along[t] * Math.PI / 180; return m < 0 ? Math.PI - a : a; };
    if (meta.channels.pitch * camera.scale > CHANNEL_PX && state.view !== "sheet") {
      onto.strokeStyle = "#000c"; onto.lineWidth = meta.channels.width; onto.beginPath();
      for (const t of seen) for (const [cx, cy, length] of channels(t, line(t), state.view.startsWith("top") ? 1 : 0)) {
        const dx = Math.cos(line(t)) * length / 2, dy = Math.sin(line(t)) * length / 2;
        onto.moveTo(cx - dx, cy - dy); onto.lineTo(cx + dx, cy + dy);
      }
      onto.stroke();
      onto.lineWidth = 1 / camera.scale; onto.strokeStyle = "#fff"; onto.beginPath();
      for (const t of seen) trace(onto, t);
      onto.stroke();
    } else if (seen.length < STREAKS) {
      onto.beginPath();
      for (const t of seen) {
        const r = edge[t] / 1000 * 0.3, [cx, cy] = centre(t);
        onto.moveTo(cx - r * Math.cos(line(t)), cy - r * Math.sin(line(t))); onto.lineTo(cx + r * Math.cos(line(t)), cy + r * Math.sin(line(t)));
      }
      onto.lineWidth = 3 / camera.scale; onto.strokeStyle = "#fffa"; onto.stroke();
      onto.lineWidth = 1.2 / camera.scale; onto.strokeStyle = "#000"; onto.stroke();
    }
  }

  function outline(t, ink, width) {
    if (t < 0) return;
    const path = new Path2D();
    trace(path, t);
    pen.strokeStyle = "#fff"; pen.lineWidth = (width + 2) / camera.scale; pen.stroke(path);
    pen.strokeStyle = ink; pen.lineWidth = width / camera.scale; pen.stroke(path);
  }
  const redraw = once(draw);

  const row = t => columns.map((name, k) => `${name} ${cells[t][k]}`);
  let tipSize = [0, 0];
  function hovered(sx, sy) {
    const t = pick(...toSheet(sx, sy));
    if (t !== state.hover) {
      state.hover = t;
      tip.hidden = t < 0;
      if (t >= 0) tip.textContent = [...row(t), `stretch_error_pct ${residual[t].toFixed(3)}`].join("\n");
      tipSize = [tip.offsetWidth, tip.offsetHeight];
      redraw();
    }
    const [left, top] = [[sx, canvas.clientWidth], [sy, canvas.clientHeight]].map(([at, room], k) => Math.max(0, Math.min(at + 16, room - tipSize[k])));
    tip.style.transform = `translate(${left}px, ${top}px)`;       // in a layer of its own: moving it paints nothing anew
  }
  function zoom(factor, sx = canvas.clientWidth / 2, sy = canvas.clientHeight / 2) {
    const [px, py] = toSheet(sx, sy);
    camera.home = false;
    camera.scale = Math.max(whole() * 0.5, Math.min(20000, camera.scale * factor));
    const [qx, qy] = toSheet(sx, sy);
    camera.x += px - qx; camera.y += py - qy;
    moved();
  }
  function move(dx, dy) { camera.home = false; camera.x -= mirror() * dx / camera.scale; camera.y += dy / camera.scale; moved(); }
  function home() { camera.home = true; redraw(); }
  function goTo(t, scale) { camera.home = false; camera.scale = scale; [camera.x, camera.y] = centre(t); redraw(); }
  gestures(canvas, {
    moved: move, zoomed: zoom, hovered,
    clicked: (sx, sy) => { const t = pick(...toSheet(sx, sy)); if (t >= 0) select(t, "map"); },
    keys: { ArrowLeft: () => move(40, 0), ArrowRight: () => move(-40, 0), ArrowUp: () => move(0, 40), ArrowDown: () => move(0, -40),
      "+": () => zoom(1.4), "=": () => zoom(1.4), "-": () => zoom(1 / 1.4), 0: home, ".": () => table.step(1), ",": () => table.step(-1) },
  });
  $("map-in").addEventListener("click", () => zoom(1.6));
  $("map-out").addEventListener("click", () => zoom(1 / 1.6));
  $("map-home").addEventListener("click", home);
  $("map-channels").addEventListener("click", () => {             // to where channels can be told apart
    if (state.view === "sheet") $("map-view").value = state.view = "bottom";
    const t = selection.domain >= 0 ? selection.domain : pick(camera.x, camera.y);
    recolour();
    goTo(Math.max(0, t), 4 / meta.channels.pitch);
  });
  $("map-quantity").addEventListener("change", event => { state.quantity = event.target.value; recolour(); });
  $("map-view").addEventListener("change", event => { state.view = event.target.value; recolour(); });
  selection.listeners.push((t, from) => {
    $("map-selected").textContent = "Selected: " + row(t).join(" · ");
    const [sx, sy] = toScreen(...centre(t));
    if (from !== "map" && !(sx > 0 && sy > 0 && sx < canvas.clientWidth && sy < canvas.clientHeight)) goTo(t, camera.scale);
    redraw();
  });
  new ResizeObserver(redraw).observe(canvas);
  themes.push(redraw);
  recolour();
  return { channels, toScreen, camera, drawn: () => frames };
})();
