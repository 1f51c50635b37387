// Tables of class "sorted": the heads of their columns sort the rows, and a field above those with many rows filters them.
(() => {
  "use strict";

  const { make } = page;
  const MANY = 8; // rows from which on there is a field

  /** The number of a cell, or its text. */
  const valueOf = (cell) => (cell?.dataset.sort === undefined ? (cell?.textContent ?? "") : Number(cell.dataset.sort));

  /** Numbers before texts, and empty cells last in either direction. */
  const order = (sign) => (a, b) => {
    if (a === b) return 0;
    if (a === "" || b === "") return a === "" ? 1 : -1;
    if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
    return sign * (typeof a === "number" ? a - b : a.localeCompare(b, undefined, { numeric: true }));
  };

  const sorts = (table) => {
    const heads = [...table.tHead.rows[0].cells];
    const body = table.tBodies[0];
    heads.forEach((head, at) => {
      const button = make("button", { type: "button" }, ...head.childNodes);
      head.append(button);
      button.addEventListener("click", () => {
        const descends = head.getAttribute("aria-sort") === "ascending";
        const compare = order(descends ? -1 : 1);
        heads.forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", descends ? "descending" : "ascending");
        const rows = [...body.rows].map((row) => [valueOf(row.cells[at]), row]);
        body.append(...rows.sort((a, b) => compare(a[0], b[0])).map(([, row]) => row));
      });
    });
  };

  const filters = (table) => {
    const rows = [...table.tBodies[0].rows];
    if (rows.length < MANY) return;
    const field = make("input", { type: "search", placeholder: "filter rows" });
    field.setAttribute("aria-label", "filter rows");
    const count = make("span", { className: "at" });
    count.setAttribute("role", "status");
    field.addEventListener("input", () => {
      const wanted = field.value.trim().toLowerCase();
      let shown = 0;
      for (const row of rows) {
        row.hidden = !row.textContent.toLowerCase().includes(wanted);
        if (!row.hidden) shown++;
      }
      count.textContent = wanted ? `${shown} of ${rows.length}` : "";
    });
    table.parentElement.before(make("div", { className: "filter" }, field, count));
  };

  // What scrolls can be scrolled by keyboard; what does not is no stop on the way.
  const scrolls = new ResizeObserver((entries) => {
    for (const { target } of entries) {
      if (target.scrollWidth > target.clientWidth + 1) {
        target.tabIndex = 0;
        target.setAttribute("role", "group");
        target.setAttribute("aria-label", "table, scrolls sideways");
      } else {
        for (const name of ["tabindex", "role", "aria-label"]) target.removeAttribute(name);
      }
    }
  });
  document.querySelectorAll(".scroll").forEach((box) => scrolls.observe(box));

  for (const table of document.querySelectorAll("table.sorted")) {
    // On a narrow screen each row is a block, whose values have the heads of their columns before them.
    const heads = [...table.tHead.rows[0].cells].map((head) => head.textContent);
    for (const row of table.tBodies[0].rows) {
      [...row.cells].forEach((cell, at) => (cell.dataset.head = heads[at]));
    }
    sorts(table);
    filters(table);
  }
})();
