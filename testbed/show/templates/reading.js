"use strict";
/* Links of a page land on their headings, whatever is drawn in the meantime; tables that do not fit become cards. */
(() => {
  const $ = (id) => document.getElementById(id);
  const HOLD_MS = 3000;
  let held = null;

  /* Until the reader moves, or nothing has moved for a while, the place stays where the link put it. */
  function go(id) {
    const target = id && $(id);
    if (!target) return;
    for (let fold = target.closest("details:not([open])"); fold; fold = fold.parentElement.closest("details:not([open])")) fold.open = true;
    held = { target, until: performance.now() + HOLD_MS };
    target.scrollIntoView();
  }
  const place = () => decodeURIComponent(location.hash.slice(1));
  document.addEventListener("click", (event) => {
    const link = event.target.closest?.('a[href^="#"]');
    if (link) setTimeout(() => go(decodeURIComponent(link.hash.slice(1))));
  });
  addEventListener("hashchange", () => go(place()));
  for (const moved of ["wheel", "touchstart", "keydown", "pointerdown"]) addEventListener(moved, () => { held = null; }, { passive: true });
  new ResizeObserver(() => { if (held && performance.now() < held.until) held.target.scrollIntoView(); }).observe(document.body);
  if (location.hash) {
    go(place());
    new MutationObserver(() => { if (held) { held.until = performance.now() + HOLD_MS; held.target.scrollIntoView(); } }).observe(document.body, { attributeFilter: ["data-ready"] });
    if (held) held.until = Infinity;
  }

  /* The link of the section that is being read is marked. */
  const links = new Map([...document.querySelectorAll("nav a")].map((link) => [link.hash.slice(1), link]));
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) {
      links.forEach((link) => link.removeAttribute("aria-current"));
      links.get(entry.target.id)?.setAttribute("aria-current", "true");
    }
  }, { rootMargin: "-15% 0px -75% 0px" });
  for (const id of links.keys()) if ($(id)) seen.observe($(id));

  const phone = matchMedia("(max-width: 800px)");
  function label(table) {
    const heads = [...table.tHead.rows[table.tHead.rows.length - 1].cells].map((head) => head.textContent.trim());
    for (const row of table.tBodies[0].rows) [...row.cells].forEach((cell, k) => { cell.dataset.label ??= heads[k]; });
    table.dataset.labelled = "1";
  }
  /* All are measured before one is changed: each change in between would have the whole page laid out again. */
  function fit() {
    const tables = [...document.querySelectorAll(".scroll > table:not(.claims)")].filter((table) => table.tHead);
    const were = new Map(tables.map((table) => [table, table.classList.contains("as-cards")]));
    tables.forEach((table) => table.classList.remove("as-cards"));
    const wide = new Map(tables.map((table) => [table, table.offsetParent && { is: table.scrollWidth, has: table.parentElement.clientWidth }]));
    for (const [table, before] of were) {
      const width = wide.get(table), rows = table.classList.contains("rows");
      if (!width) { table.classList.toggle("as-cards", before); continue; }
      const cards = phone.matches || (!rows && width.is > width.has + 1);
      if (cards && !rows && !table.dataset.labelled) label(table);
      table.classList.toggle("as-cards", cards);
      table.parentElement.classList.toggle("of-cards", cards);
      if (before !== cards) table.dispatchEvent(new Event("layout"));
    }
  }
  let asked = 0;
  const later = () => { cancelAnimationFrame(asked); asked = requestAnimationFrame(fit); };
  addEventListener("resize", later);
  for (const fold of document.querySelectorAll("details")) fold.addEventListener("toggle", later);
  fit();
})();
