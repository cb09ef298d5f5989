// The table of all domains: only the rows in sight are elements, so thousands of rows cost nothing.
const table = (() => {
  const ROW = 26, SPARE = 12, box = $("table");
  const sort = { name: "domain", down: false };
  const filters = {};
  let order = Int32Array.from({ length: count }, (_, k) => k);

  box.innerHTML = "<table><thead><tr></tr></thead><tbody></tbody></table>";
  const head = box.querySelector("thead tr"), body = box.querySelector("tbody");
  box.setAttribute("aria-rowcount", count + 1);
  columns.forEach(name => {
    const cell = document.createElement("th"), button = document.createElement("button"), input = document.createElement("input");
    cell.scope = "col"; cell.dataset.name = name;
    button.textContent = name;
    button.addEventListener("click", () => { sort.down = sort.name === name && !sort.down; sort.name = name; arrange(); });
    input.type = "text"; input.placeholder = "filter"; input.setAttribute("aria-label", "Filter " + name);
    input.addEventListener("input", () => { filters[name] = input.value; arrange(); });
    cell.append(button, input);
    head.append(cell);
  });

  /** What a filter's text lets through, or null when it says nothing that makes sense. */
  function rule(text) {
    const word = text.trim().replace("−", "-"), number = "([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)";
    let found;
    if ((found = word.match(new RegExp(`^${number}\\s*\\.\\.\\s*${number}$`)))) return v => v >= +found[1] && v <= +found[2];
    if ((found = word.match(new RegExp(`^(<=|>=|<|>|=)\\s*${number}$`)))) {
      const limit = +found[2];
      return { "<": v => v < limit, ">": v => v > limit, "<=": v => v <= limit, ">=": v => v >= limit, "=": v => v === limit }[found[1]];
    }
    if ((found = word.match(new RegExp(`^${number}$`)))) return v => v === +found[1];
    return null;
  }

  function arrange() {
    const rules = [];
    for (const name of columns) {
      const text = filters[name] || "", let_through = rule(text);
      head.querySelector(`[data-name=${name}] input`).setAttribute("aria-invalid", Boolean(text.trim()) && !let_through);
      if (let_through) rules.push([column[name], let_through]);
    }
    const values = column[sort.name], sign = sort.down ? -1 : 1, kept = [];
    for (let k = 0; k < count; k++) if (rules.every(([v, passes]) => passes(v[k]))) kept.push(k);
    order = Int32Array.from(kept).sort((a, b) => sign * (values[a] - values[b]) || a - b);
    for (const cell of head.children) {
      const ours = cell.dataset.name === sort.name;
      cell.setAttribute("aria-sort", ours ? (sort.down ? "descending" : "ascending") : "none");
      cell.firstChild.textContent = cell.dataset.name + (ours ? (sort.down ? " ▼" : " ▲") : "");
    }
    $("table-count").textContent = `${order.length} of ${count} domains`;
    box.scrollTop = 0;
    render();
  }

  const element = (name, text) => { const made = document.createElement(name); if (text !== undefined) made.textContent = text; return made; };
  function spacer(height) {
    const row = element("tr"), cell = element("td");
    row.className = "spacer"; row.setAttribute("aria-hidden", "true"); cell.colSpan = columns.length; cell.style.height = height + "px";
    row.append(cell);
    return row;
  }

  function render() {
    const first = Math.max(0, Math.floor(box.scrollTop / ROW) - SPARE);
    const last = Math.min(order.length, first + Math.ceil(box.clientHeight / ROW) + 2 * SPARE);
    const rows = [spacer(first * ROW)];
    for (let k = first; k < last; k++) {
      const row = element("tr");
      row.setAttribute("aria-rowindex", k + 2);
      row.setAttribute("aria-selected", order[k] === selection.domain);
      row.dataset.domain = order[k];
      row.append(...cells[order[k]].map(text => element("td", text)));
      rows.push(row);
    }
    rows.push(spacer((order.length - last) * ROW));
    body.replaceChildren(...rows);
  }

  function show(domain) {
    const place = order.indexOf(domain);
    if (place >= 0) box.scrollTop = Math.max(0, place * ROW - box.clientHeight / 2 + head.offsetHeight);
    render();
  }

  function step(by) {
    const place = order.indexOf(selection.domain), next = place < 0 ? 0 : Math.max(0, Math.min(order.length - 1, place + by));
    if (order.length) { select(order[next]); show(order[next]); }
  }

  box.addEventListener("scroll", once(render));
  body.addEventListener("click", event => { const row = event.target.closest("[data-domain]"); if (row) select(+row.dataset.domain, "table"); });
  box.addEventListener("keydown", event => {
    const by = { ArrowDown: 1, ArrowUp: -1, PageDown: 15, PageUp: -15 }[event.key];
    if (by && event.target === box) { event.preventDefault(); step(by); }
  });
  $("table-clear").addEventListener("click", () => { for (const input of head.querySelectorAll("input")) { input.value = ""; filters[input.closest("th").dataset.name] = ""; } arrange(); });
  $("table-csv").addEventListener("click", () => {
    const link = element("a");
    link.href = URL.createObjectURL(new Blob([csv], { type: "text/csv" }));
    link.download = "domains.csv";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  });
  selection.listeners.push((domain, from) => (from === "table" ? render() : show(domain)));
  arrange();
  new ResizeObserver(once(render)).observe(box);
  return { step };
})();
