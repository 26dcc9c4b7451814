"use strict";
/* Tables of thousands of rows: searched, filtered, sorted; a row is made when somebody scrolls to it. */
(() => {
  const STEP = matchMedia("(max-width: 800px)").matches ? 12 : 60; // rows that are made at once; cards are long
  const KNOWN = /^[\u2212-]?\d/;
  const make = (tag, attributes = {}, ...inside) => {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) name in made && name !== "list" ? (made[name] = value) : made.setAttribute(name, value);
    made.append(...inside);
    return made;
  };

  function read(packed) {
    for (const column of packed.columns) {
      const lines = column.lines?.split("\u001e");
      column.text = lines ? (row) => lines[row] : (row) => column.values[column.codes[row]];
      column.numeric = column.kind === "number" || column.kind === "bad";
    }
    packed.marks = new Set(packed.marked);
    return packed;
  }
  const amount = (text) => (KNOWN.test(text) ? parseFloat(text.replace("\u2212", "-")) : NaN);

  /* Numbers by value and the rest as text; unknown values last, whichever way. */
  function sorted(rows, column, down) {
    const sign = down ? -1 : 1;
    if (!column.numeric) return [...rows].sort((a, b) => sign * column.text(a).localeCompare(column.text(b), "en", { numeric: true }) || a - b);
    const key = new Map(rows.map((row) => [row, amount(column.text(row))]));
    return [...rows].sort((a, b) => {
      const x = key.get(a), y = key.get(b);
      return isNaN(x) || isNaN(y) ? isNaN(x) - isNaN(y) || a - b : sign * (x - y) || a - b;
    });
  }

  function begin(root, data) {
    const table = root.querySelector("table"), scroll = root.querySelector(".scroll"), head = table.tHead.rows[0], body = table.tBodies[0];
    const every = Array.from({ length: data.n }, (_, row) => row), chosen = new Map(), elsewhere = document.body.dataset.files === "elsewhere";
    let order = every, found = every, shown = 0, by = null, down = false, words = [], hay = null;

    const haystack = () => (hay ??= every.map((row) => data.columns.filter((c) => !c.numeric).map((c) => c.text(row)).join(" ").toLowerCase()));

    /* One pass over all rows: those that are found, and how many each choice would leave, which is those that nothing else rules out. */
    function find() {
      const counts = new Map([...selects.keys()].map((column) => [column, new Uint32Array(column.values.length)])), choices = [...chosen], texts = words.length ? haystack() : null;
      found = order.filter((row) => {
        if (texts && !words.every((word) => texts[row].includes(word))) return false;
        let against = null, several = false;
        for (const [column, code] of choices) if (column.codes[row] !== code) { several = against !== null; against = column; if (several) break; }
        if (several) return false;
        if (against) counts.get(against)[against.codes[row]]++;
        else for (const [column, count] of counts) count[column.codes[row]]++;
        return !against;
      });
      for (const [column, select] of selects) for (const option of [...select.options].slice(1)) {
        const code = Number(option.value), n = counts.get(column)[code];
        option.textContent = `${column.values[code] || "\u2013"} (${n})`;
        option.disabled = !n && !option.selected;
      }
    }

    function cell(column, row) {
      const text = column.text(row);
      if (column.kind === "flight") return flight(text, row);
      const td = make("td");
      td.dataset.label = column.unit ? `${column.heading}, ${column.unit}` : column.heading;
      if (column.kind === "badge") { if (data.notes[row]) td.title = data.notes[row]; td.append(make("span", { className: `badge badge-${data.tones[text]}` }, text)); } else td.textContent = text;
      if (column.numeric) td.className = column.kind === "bad" && data.marks.has(row) ? "n bad" : "n";
      return td;
    }

    function flight(text, row) {
      const [id, about] = text.split("\n"), link = data.links[row], th = make("th", { scope: "row", className: "flight" }), line = make("div", { className: "flight-box" });
      if (data.sparks[row]) { const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"); svg.setAttribute("viewBox", "0 0 56 34"); svg.setAttribute("class", "spark"); svg.setAttribute("aria-hidden", "true"); svg.innerHTML = data.sparks[row]; line.append(svg); }
      const command = data.commands[row] || data.command.replace("{}", id), box = make("span");
      box.append(make("code", {}, link && !elsewhere ? make("a", { href: link }, id) : id));
      box.append(make("button", { type: "button", className: "copy", title: `copy: ${command}`, "aria-label": `copy the command ${command}`, onclick: (event) => navigator.clipboard?.writeText(command).then(() => event.target.classList.add("done"), () => {}) }));
      if (about) box.append(make("span", { className: "reading" }, about));
      line.append(box);
      th.append(line);
      return th;
    }

    function more() {
      const visible = data.columns.filter((column) => column.shown), rows = found.slice(shown, shown + STEP);
      body.append(...rows.map((row) => make("tr", {}, ...visible.map((column) => cell(column, row)))));
      shown += rows.length;
      rest.hidden = shown >= found.length;
      rest.textContent = `${(found.length - shown).toLocaleString("en")} more`;
    }

    function draw() {
      find();
      count.textContent = found.length === data.n ? `${data.n.toLocaleString("en")} ${data.name}` : `${found.length.toLocaleString("en")} of ${data.n.toLocaleString("en")} ${data.name}`;
      body.replaceChildren();
      shown = 0;
      scroll.scrollTop = 0;
      more();
    }

    function heads() {
      head.replaceChildren(...data.columns.filter((column) => column.shown).map((column) => {
        const th = make("th", { scope: "col", title: column.title, className: column.numeric ? "n" : "" }), button = make("button", { type: "button" }, column.heading);
        if (column.unit) button.append(" ", make("span", { className: "unit" }, column.unit));
        if (by === column) th.setAttribute("aria-sort", down ? "descending" : "ascending");
        button.addEventListener("click", () => { down = by === column && !down; by = column; order = sorted(every, column, down); heads(); draw(); });
        th.append(button);
        return th;
      }));
    }

    const selects = new Map();
    const bar = root.querySelector(".explorer-bar"), count = make("output", { className: "quiet" }), rest = make("button", { type: "button", className: "more-rows" });
    const search = make("input", { type: "search", placeholder: `search ${data.name}`, "aria-label": `search ${data.name}` });
    search.addEventListener("input", () => { words = search.value.toLowerCase().split(/\s+/).filter(Boolean); draw(); });
    bar.append(search);
    for (const column of data.columns) {
      if (!column.facet || !column.values || column.values.length < 2 || column.values.length > 40) continue;
      const select = make("select", { "aria-label": column.heading }, new Option(`any ${column.heading}`, ""));
      const codes = column.values.map((_, code) => code).sort((a, b) => column.values[a].localeCompare(column.values[b], "en", { numeric: true }));
      for (const code of codes) select.append(new Option(column.values[code], String(code)));
      select.addEventListener("change", () => { select.selectedIndex ? chosen.set(column, Number(select.value)) : chosen.delete(column); draw(); });
      selects.set(column, select);
      bar.append(select);
    }
    const columns = make("details", { className: "columns" }, make("summary", {}, "Columns"));
    columns.append(make("div", {}, ...data.columns.map((column) => {
      const box = make("input", { type: "checkbox", checked: column.shown });
      box.addEventListener("change", () => { column.shown = box.checked; heads(); draw(); });
      return make("label", { title: column.title }, box, ` ${column.heading}`, column.unit ? make("span", { className: "unit" }, ` ${column.unit}`) : "");
    })));
    bar.append(columns, count);
    scroll.append(rest);
    rest.addEventListener("click", more);
    new IntersectionObserver((seen) => { if (seen.some((one) => one.isIntersecting) && scroll.scrollHeight > scroll.clientHeight + 1) more(); }, { root: scroll, rootMargin: "400px" }).observe(rest);
    scroll.tabIndex = 0;
    heads();
    draw();
    root.dataset.ready = "1";
  }

  /* Unpacked when it comes near, so that it does not hold up what is read first; at once for who prints or follows a link to it. */
  for (const root of document.querySelectorAll(".explorer")) {
    root.classList.add("lively");
    root.querySelector(".scroll").classList.add("tall");
    root.insertBefore(make("div", { className: "controls explorer-bar" }), root.querySelector(".scroll")); // its place is kept until then
    const start = async () => { if (root.dataset.begun) return; root.dataset.begun = "1"; begin(root, read(JSON.parse(await Plots.unpack(root.querySelector(".explorer-data").id)))); };
    const near = new IntersectionObserver((seen) => { if (seen.some((one) => one.isIntersecting)) { near.disconnect(); start(); } }, { rootMargin: "1200px" });
    near.observe(root);
    addEventListener("beforeprint", start);
  }
})();
