// Data of the page, and what its parts share: one selected domain, one palette.
const $ = id => document.getElementById(id);
const meta = JSON.parse($("data-meta").textContent);

/** The array of a data element; the type is one of JavaScript's typed arrays. */
function array(name, type) {
  const bytes = Uint8Array.from(atob($("data-" + name).textContent.trim()), c => c.charCodeAt(0));
  return new type(bytes.buffer);
}

const csv = $("data-table").textContent;
const lines = csv.trimEnd().split("\n");
const columns = lines[0].split(",");
const cells = lines.slice(1).map(line => line.split(","));      // as they are printed
const count = cells.length;
const column = Object.fromEntries(columns.map((name, k) => [name, Float64Array.from(cells, row => +row[k])]));

const selection = { domain: -1, listeners: [] };
function select(domain, from) {
  selection.domain = domain;
  for (const listener of selection.listeners) listener(domain, from);
}

const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const themes = [];                                               // called when light turns dark or the reverse
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => themes.forEach(draw => draw()));

/** Colour number k of 256 of a map, as [red, green, blue]. */
const palettes = Object.fromEntries(Object.entries(meta.palettes).map(([name, text]) =>
  [name, Uint8Array.from(atob(text), c => c.charCodeAt(0))]));
const colour = (name, share) => {
  const k = 3 * Math.max(0, Math.min(255, Math.round(255 * share)));
  return palettes[name].subarray(k, k + 3);
};

/** Call draw once per frame however often it is asked for. */
function once(draw) {
  let waiting = false;
  return () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; draw(); });
  };
}

/** Give a canvas the pixels of its place on the screen; returns their number per CSS pixel. */
function fit(canvas) {
  const ratio = Math.min(devicePixelRatio || 1, 2), box = canvas.getBoundingClientRect();
  const w = Math.round(box.width * ratio), h = Math.round(box.height * ratio);
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  return ratio;
}

/** A WebGL2 program of these two shaders, in use. */
function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, "#version 300 es\nprecision highp float;\n" + text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  gl.useProgram(made);
  return made;
}

/** Drag, wheel and pinch on a canvas: moved(dx, dy), zoomed(factor, x, y), clicked(x, y), hovered(x, y), in CSS pixels. */
function gestures(canvas, on) {
  const down = new Map();
  let far = 0;
  const at = event => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  const spread = () => { const [a, b] = [...down.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
  canvas.addEventListener("pointerdown", event => { canvas.setPointerCapture(event.pointerId); down.set(event.pointerId, at(event)); far = down.size > 1 ? 99 : 0; });
  canvas.addEventListener("pointermove", event => {
    const now = at(event), before = down.get(event.pointerId);
    if (!before) return on.hovered?.(...now);
    const apart = down.size === 2 ? spread() : 0;
    down.set(event.pointerId, now);
    far += Math.abs(now[0] - before[0]) + Math.abs(now[1] - before[1]);
    if (apart) on.zoomed(spread() / apart, ...now);
    else if (far > 3) on.moved(now[0] - before[0], now[1] - before[1], event);
  });
  const up = event => { if (down.delete(event.pointerId) && event.type === "pointerup" && far <= 3) on.clicked?.(...at(event)); };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("pointerleave", () => on.hovered?.(NaN, NaN));
  canvas.addEventListener("wheel", event => { event.preventDefault(); on.zoomed(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), ...at(event)); }, { passive: false });
  canvas.addEventListener("keydown", event => {
    if (!on.keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    on.keys[event.key]();
  });
}
