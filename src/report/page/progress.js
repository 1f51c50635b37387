// A page of a study that runs: it renews itself, keeps what the reader chose in its address, and stops where the study has ended
// or nothing is heard of it any more.
(() => {
  "use strict";

  const { make } = page;

  // ---- What the reader chose stays in the address, since a file has no other memory in every browser.

  const kept = new URLSearchParams(location.hash.startsWith("#keep") ? location.hash.slice(1) : "");
  const root = document.documentElement;
  const controls = () => [...document.querySelectorAll(".filter input")];
  const keyOf = (control) => `filter ${controls().indexOf(control)}`;
  const folds = () => [...document.querySelectorAll("details")];
  const nameOf = (fold) => `${fold.closest("section")?.querySelector("h2")?.textContent}/${fold.querySelector("summary").textContent}`;
  const figures = () => [...document.querySelectorAll("figure.plot")];
  const titleOf = (figure) => figure.querySelector("h3").textContent;
  const focusable = () => [...document.querySelectorAll("a[href], button, select, input, summary, [tabindex]")];

  const restore = () => {
    const theme = kept.get("theme");
    if (theme && theme !== (page.isDark() ? "dark" : "light")) document.querySelector("button.theme").click();
    const open = new Set(kept.getAll("open"));
    folds().forEach((fold) => (fold.open = open.has(nameOf(fold))));
    for (const control of controls()) {
      const value = kept.get(keyOf(control));
      if (value == null) continue;
      control.value = value;
      control.dispatchEvent(new Event("input"));
    }
    const off = new Set(kept.getAll("off"));
    for (const figure of figures()) {
      for (const button of figure.querySelectorAll(".legend button")) {
        if (off.has(`${titleOf(figure)}/${button.children[1].textContent}`)) button.click();
      }
      const view = kept.get(`view ${titleOf(figure)}`)?.split("/").map(Number);
      if (view?.length === 2 && view.every(Number.isFinite)) figure.plot.look(view);
    }
    const focus = kept.get("focus");
    if (focus != null) focusable()[Number(focus)]?.focus({ preventScroll: true });
  };

  const keep = () => {
    const now = new URLSearchParams({ keep: "" });
    for (const name of ["beat", "seen", "pause"]) if (kept.has(name)) now.set(name, kept.get(name));
    if (root.dataset.theme) now.set("theme", root.dataset.theme);
    folds().filter((fold) => fold.open).forEach((fold) => now.append("open", nameOf(fold)));
    controls().forEach((control) => control.value && now.set(keyOf(control), control.value));
    for (const figure of figures()) {
      for (const button of figure.querySelectorAll(".legend button[aria-pressed='false']")) now.append("off", `${titleOf(figure)}/${button.children[1].textContent}`);
      const { view, whole } = figure.plot;
      if (view[0] !== whole[0] || view[1] !== whole[1]) now.set(`view ${titleOf(figure)}`, view.join("/"));
    }
    const focus = focusable().indexOf(document.activeElement);
    if (focus >= 0) now.set("focus", focus);
    history.replaceState(null, "", `#${now}`);
  };
  // A link to a section takes the address; what was chosen comes back into it.
  addEventListener("hashchange", () => location.hash.startsWith("#keep") || keep());

  // ---- Renewal.

  const AGAIN = 2000; // ms between two looks
  const QUIET = 2500; // ms without a touch of the reader's before the page may be renewed

  const line = document.querySelector(".renewal");
  const { lives, beat, written, silence } = line.dataset;
  const clock = (ms) => new Date(ms).toLocaleTimeString();
  const said = make("span");
  line.append(said);

  restore();

  let touched = 0;
  for (const name of ["pointerdown", "pointermove", "keydown", "wheel", "touchmove"]) addEventListener(name, () => (touched = performance.now()), { passive: true });
  const isBusy = () => {
    const waits = document.activeElement?.matches("input") ? 8 * QUIET : QUIET;
    const isTouched = touched > 0 && performance.now() - touched < waits;
    return isTouched || getSelection().type === "Range" || document.hidden;
  };

  // `?once` is for what takes a picture of it, or reads it once.
  if (lives !== "true" || new URLSearchParams(location.search).has("once")) {
    said.textContent = `Written at ${clock(Number(written))}.`;
    return;
  }
  // By the clock of the reader, which may be another than that of the study: a new beat is a sign of life.
  const LIMIT = 3000 * Number(silence);
  const now = Date.now();
  if (kept.get("beat") !== `${written}.${beat}`) {
    // What is old when it is opened first may be of a clock that is behind: it is given one silence.
    const age = now - Number(written);
    const seen = kept.has("beat") || age < LIMIT ? now : now - LIMIT + 1000 * Number(silence);
    kept.set("beat", `${written}.${beat}`);
    kept.set("seen", seen);
  }
  const renew = () => {
    keep();
    location.reload();
  };
  const button = make("button", { type: "button" });
  button.className = "pause";
  line.append(" ", button);
  const isSilent = () => Date.now() - Number(kept.get("seen")) > LIMIT;
  const show = () => {
    if (isSilent()) {
      line.classList.add("silent");
      said.setAttribute("role", "status");
      said.textContent = `No news since ${clock(Number(written))}: the process has ended without a word, or its machine sleeps.`;
      button.textContent = "look again";
      return;
    }
    const paused = kept.has("pause");
    said.textContent = paused ? `As of ${clock(Number(written))}; not renewed.` : `As of ${clock(Number(written))}; renews itself.`;
    button.textContent = paused ? "go on" : "pause";
  };
  button.addEventListener("click", () => {
    if (isSilent()) {
      kept.set("seen", Date.now() - LIMIT + 1000 * Number(silence));
      renew();
      return;
    }
    if (kept.has("pause")) kept.delete("pause");
    else kept.set("pause", "1");
    keep();
    show();
  });
  const look = () => {
    show();
    if (isSilent()) return;
    if (kept.has("pause") || isBusy()) setTimeout(look, 500);
    else renew();
  };
  keep();
  show();
  setTimeout(look, AGAIN);
})();
