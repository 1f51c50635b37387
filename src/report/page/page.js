// Parts of every page: links to its sections, and a button for light or dark, which the system decides until the button
// is pressed. Nothing is stored. `page` holds what the other scripts share. `VIRIDIS`, the colours of the scale, stands
// before.
const page = (() => {
  "use strict";

  const headings = [...document.querySelectorAll("main > section > h2")];
  if (headings.length > 2) {
    const nav = document.createElement("nav");
    nav.setAttribute("aria-label", "sections");
    for (const [at, heading] of headings.entries()) {
      heading.parentElement.id = `section-${at + 1}`;
      const link = document.createElement("a");
      link.href = `#section-${at + 1}`;
      link.textContent = heading.textContent;
      nav.append(link);
    }
    const title = document.querySelector("main > .lead") ?? document.querySelector("main > h1");
    title.after(nav);
  }

  const root = document.documentElement;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);

  const button = document.createElement("button");
  button.type = "button";
  button.className = "theme";
  const changed = () => {
    button.textContent = isDark() ? "light" : "dark";
    button.setAttribute("aria-label", `show the page ${button.textContent}`);
    document.dispatchEvent(new CustomEvent("theme"));
  };
  button.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    changed();
  });
  system.addEventListener("change", changed);
  document.body.prepend(button);
  changed();

  // Paper is white: drawings are redrawn for it.
  let before;
  addEventListener("beforeprint", () => {
    before = root.dataset.theme;
    root.dataset.theme = "light";
    changed();
  });
  addEventListener("afterprint", () => {
    if (before) root.dataset.theme = before;
    else delete root.dataset.theme;
    changed();
  });

  /** An element with its properties and children. */
  const make = (tag, properties = {}, ...children) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  };

  /** Red, green and blue (0 to 255) of a share of the colour scale. */
  const viridis = (share) => {
    const place = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1);
    const below = Math.min(Math.floor(place), VIRIDIS.length - 2);
    return VIRIDIS[below].map((part, channel) => part + (place - below) * (VIRIDIS[below + 1][channel] - part));
  };

  return { make, isDark, viridis, rgb: (parts) => `rgb(${parts.map(Math.round).join()})` };
})();
