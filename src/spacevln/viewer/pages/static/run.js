"use strict";
(() => {
  const table = document.getElementById("list");
  const body = table.tBodies[0];
  const rows = [...body.rows];
  const more = document.getElementById("more");
  let order = rows, limit = Number(table.dataset.first);
  const find = document.getElementById("find");
  const outcome = document.getElementById("outcome");
  const diagnosis = document.getElementById("diagnosis");
  const shown = document.getElementById("shown");
  const words = new Map(rows.map((row) => [row, row.cells[1].textContent.toLowerCase()]));

  function filter() {
    const text = find.value.trim().toLowerCase();
    let count = 0;
    for (const row of order) {
      const fits = words.get(row).includes(text) && (!outcome.value || row.dataset.outcome === outcome.value) &&
        (!diagnosis || !diagnosis.value || row.dataset.diagnosis === diagnosis.value);
      count += fits;
      row.hidden = !fits || count > limit;
    }
    shown.textContent = count > limit ? `${count} found, the first ${limit} shown` : `${count} shown`;
    more.hidden = count <= limit;
    more.textContent = `Show all ${count}`;
    const query = new URLSearchParams();
    if (text) query.set("find", find.value.trim());
    if (outcome.value) query.set("outcome", outcome.value);
    if (diagnosis && diagnosis.value) query.set("diagnosis", diagnosis.value);
    history.replaceState(null, "", query.size ? `#${query}` : location.pathname);
  }

  function compare(a, b) {
    if (a === "" || b === "") return (a === "") - (b === "");
    const x = Number(a), y = Number(b);
    return Number.isNaN(x) || Number.isNaN(y) ? a.localeCompare(b, "en", { numeric: true }) : x - y;
  }

  table.tHead.addEventListener("click", (event) => {
    const button = event.target.closest("button[data-sort]");
    if (!button) return;
    const head = button.closest("th");
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of table.tHead.rows[0].cells) if (other.hasAttribute("aria-sort")) other.setAttribute("aria-sort", "none");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const cell = Number(button.dataset.sort) + 1;
    const value = (row) => row.cells[cell].dataset.v ?? "";
    order = [...rows].sort((a, b) => {
      const [x, y] = [value(a), value(b)];
      return down && x !== "" && y !== "" ? compare(y, x) : compare(x, y);
    });
    body.append(...order);
    filter();
  });

  for (const control of [find, outcome, diagnosis]) if (control) control.addEventListener("input", filter);
  find.form.addEventListener("submit", (event) => event.preventDefault());
  more.addEventListener("click", () => {
    limit = Infinity;
    filter();
  });
  for (const button of document.querySelectorAll("button[data-diagnosis]")) {
    button.addEventListener("click", () => {
      diagnosis.value = button.dataset.diagnosis;
      filter();
      document.getElementById("episodes").scrollIntoView();
    });
  }
  const asked = new URLSearchParams(location.hash.slice(1));
  if (asked.size) {
    find.value = asked.get("find") ?? "";
    outcome.value = asked.get("outcome") ?? "";
    if (diagnosis) diagnosis.value = asked.get("diagnosis") ?? "";
    filter();
  }
})();
