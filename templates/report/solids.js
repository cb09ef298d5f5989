// Small WebGL2 viewer: triangles with a colour per vertex, lit from the eye, turned by pointer or keys.
const OPEN = 2.4, NEAR = 1.2, MARGIN = 0.08;                     // of the lens; of the first look at a body
function viewer(canvas) {
  const gl = canvas.getContext("webgl2", { antialias: true });
  if (!gl) { $("no-webgl").hidden = false; return null; }
  const made = program(gl, `in vec3 at; in vec4 ink; uniform mat4 view, lens; uniform vec3 shift; out vec3 seen; out vec4 paint;
    void main() { vec4 p = view * vec4(at + shift, 1.0); seen = p.xyz; paint = ink; gl_Position = lens * p; }`,
  `in vec3 seen; in vec4 paint; out vec4 shown;
    void main() { vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
      float lit = 0.38 + 0.5 * abs(n.z) + 0.12 * abs(dot(n, normalize(vec3(-0.5, 0.6, 0.6))));
      shown = vec4(paint.rgb * lit * paint.a, paint.a); }`);
  const place = Object.fromEntries(["view", "lens", "shift"].map(name => [name, gl.getUniformLocation(made, name)]));
  const attribute = Object.fromEntries(["at", "ink"].map(name => [name, gl.getAttribLocation(made, name)]));
  const bodies = [], middle = [0, 0, 0];
  const start = { turn: -0.45, tilt: 0.85, near: 1 }, eye = { ...start };
  let size = 1;

  function load(data, target) { const buffer = gl.createBuffer(); gl.bindBuffer(target, buffer); gl.bufferData(target, data, gl.DYNAMIC_DRAW); return buffer; }
  /** Add a body: positions (3 n), colours as bytes (4 n), triangles. `clear` bodies are drawn last. */
  function add(at, ink, faces, clear = false) {
    const body = { shown: true, shift: [0, 0, 0], clear, length: faces.length, at: load(at, gl.ARRAY_BUFFER), ink: load(ink, gl.ARRAY_BUFFER), faces: load(faces, gl.ELEMENT_ARRAY_BUFFER) };
    body.move = points => { gl.bindBuffer(gl.ARRAY_BUFFER, body.at); gl.bufferData(gl.ARRAY_BUFFER, points, gl.DYNAMIC_DRAW); redraw(); };
    bodies.push(body);
    return body;
  }
  /** Look at these points (3 n). */
  function frame(points) {
    const low = [Infinity, Infinity, Infinity], high = low.map(v => -v);
    for (let k = 0; k < points.length; k++) { low[k % 3] = Math.min(low[k % 3], points[k]); high[k % 3] = Math.max(high[k % 3], points[k]); }
    for (let i = 0; i < 3; i++) middle[i] = (low[i] + high[i]) / 2;
    size = Math.hypot(...high.map((v, i) => v - low[i])) || 1;
    start.near = eye.near = NEAR * size / reach(points);
    redraw();
  }
  /** How far the eye has to be so that all points are in sight, with a margin. */
  function reach(points) {
    const [right, up, back] = axes(), w = canvas.clientWidth, h = canvas.clientHeight, slim = OPEN * Math.min(1, w / h);
    const along = (axis, k) => axis[0] * (points[k] - middle[0]) + axis[1] * (points[k + 1] - middle[1]) + axis[2] * (points[k + 2] - middle[2]);
    let far = size / 10;
    for (let k = 0; k < points.length; k += 3)
      far = Math.max(far, along(back, k) + slim * Math.max(Math.abs(along(right, k)) * h / w, Math.abs(along(up, k))) / (1 - MARGIN));
    return far;
  }
  /** The directions right, up and towards the eye. */
  function axes() {
    const [a, b, c, d] = [Math.cos(eye.turn), Math.sin(eye.turn), Math.cos(eye.tilt), Math.sin(eye.tilt)];
    return [[a, b, 0], [-b * c, a * c, d], [b * d, -a * d, c]];
  }
  function draw() {
    fit(canvas);
    const w = canvas.width, h = canvas.height, far = size * NEAR / eye.near, slim = OPEN * Math.min(1, w / h), rows = axes();
    const view = new Float32Array([0, 1, 2].flatMap(k => [...rows.map(r => r[k]), 0]).concat(rows.map(r => -(r[0] * middle[0] + r[1] * middle[1] + r[2] * middle[2])), 1));
    view[14] -= far;
    const near = far / 50, back = far + 3 * size;
    const lens = new Float32Array([slim * h / w, 0, 0, 0, 0, slim, 0, 0, 0, 0, -(back + near) / (back - near), -1, 0, 0, -2 * back * near / (back - near), 0]);
    gl.viewport(0, 0, w, h); gl.clearColor(0, 0, 0, 0); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST); gl.enable(gl.BLEND); gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.uniformMatrix4fv(place.view, false, view); gl.uniformMatrix4fv(place.lens, false, lens);
    for (const clear of [false, true]) {
      gl.depthMask(!clear);
      for (const body of bodies) if (body.shown && body.clear === clear) {
        gl.uniform3fv(place.shift, body.shift);
        for (const [name, parts, kind] of [["at", 3, gl.FLOAT], ["ink", 4, gl.UNSIGNED_BYTE]]) {
          gl.bindBuffer(gl.ARRAY_BUFFER, body[name]); gl.enableVertexAttribArray(attribute[name]);
          gl.vertexAttribPointer(attribute[name], parts, kind, kind === gl.UNSIGNED_BYTE, 0, 0);
        }
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, body.faces);
        gl.drawElements(gl.TRIANGLES, body.length, gl.UNSIGNED_INT, 0);
      }
    }
    gl.depthMask(true);
  }
  const redraw = once(draw);
  const turn = (x, y) => { eye.turn -= x * 0.008; eye.tilt = Math.max(0, Math.min(Math.PI, eye.tilt - y * 0.008)); redraw(); };
  const zoom = factor => { eye.near = Math.max(0.3, Math.min(20, eye.near * factor)); redraw(); };
  gestures(canvas, { moved: turn, zoomed: zoom,
    keys: { ArrowLeft: () => turn(20, 0), ArrowRight: () => turn(-20, 0), ArrowUp: () => turn(0, 20), ArrowDown: () => turn(0, -20),
      "+": () => zoom(1.2), "=": () => zoom(1.2), "-": () => zoom(1 / 1.2), 0: () => { Object.assign(eye, start); redraw(); } } });
  new ResizeObserver(redraw).observe(canvas);
  return { add, frame, redraw, eye };
}

/** n times the same colour. */
const plain = (n, rgba) => Uint8Array.from({ length: 4 * n }, (_, k) => rgba[k % 4]);

function showShape() {
  const view = viewer($("shape"));
  if (!view) return;
  const target = array("target", Float32Array), faces = new Uint32Array(array("faces", Int32Array)), n = target.length / 3;
  const goal = view.add(target, plain(n, meta.lambdas ? [150, 156, 165, 120] : [176, 182, 190, 255]), faces, Boolean(meta.lambdas));
  if (!meta.lambdas) return view.frame(target);
  const frames = array("frames", Float32Array), deviation = array("deviation", Float32Array), ink = new Uint8Array(4 * n);
  for (let k = 0; k < n; k++) ink.set([...colour("viridis", deviation[k] / meta.deviation), 255], 4 * k);
  const step = k => frames.subarray(3 * n * k, 3 * n * (k + 1));
  const hot = view.add(step(meta.lambdas.length - 1), ink, faces), heat = $("shape-heat");
  const heated = () => {
    hot.move(step(+heat.value));
    $("shape-lambda").textContent = +heat.value ? `λ = ${meta.lambdas[+heat.value].toFixed(3)}` : "λ = 1 (flat)";
  };
  heat.addEventListener("input", heated);
  const chosen = () => { hot.shown = $("shape-show").value !== "target"; goal.shown = $("shape-show").value !== "prediction"; view.redraw(); };
  $("shape-show").addEventListener("change", chosen);
  view.frame([...target, ...step(0)]);                            // the flat sheet is larger
  heated();
  chosen();
}

function showCell() {
  const view = viewer($("cell")), all = [];
  if (!view) return;
  const bodies = meta.parts.map((part, k) => {
    const at = array("part-at-" + k, Float32Array), faces = array("part-faces-" + k, Uint32Array);
    for (const v of at) all.push(v);
    return view.add(at, plain(at.length / 3, part.colour), faces, part.colour[3] < 255);
  });
  const levels = [...new Set(meta.parts.map(part => part.level))].sort((a, b) => a - b);
  const apart = () => {
    const step = $("cell-apart").value / 100 * meta.apart;
    bodies.forEach((body, k) => { body.shift = [0, 0, (levels.indexOf(meta.parts[k].level) - (levels.length - 1) / 2) * step]; });
    view.redraw();
  };
  meta.parts.forEach((part, k) => {
    const label = document.createElement("label"), box = document.createElement("input");
    box.type = "checkbox"; box.checked = true;
    box.addEventListener("change", () => { bodies[k].shown = box.checked; view.redraw(); });
    label.append(box, " " + part.name);
    $("cell-parts").append(label);
  });
  $("cell-apart").addEventListener("input", apart);
  view.frame(all);
  apart();
}

// Only when they come into sight, so that the page appears at once.
const waiting = { shape: showShape, cell: showCell };
const watcher = new IntersectionObserver(entries => {
  for (const entry of entries) if (entry.isIntersecting && waiting[entry.target.id]) { watcher.unobserve(entry.target); waiting[entry.target.id](); delete waiting[entry.target.id]; }
}, { rootMargin: "300px" });
for (const id of Object.keys(waiting)) if ($(id)) watcher.observe($(id));
