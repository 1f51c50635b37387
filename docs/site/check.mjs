// Checks the links of a site: check.mjs SITE
//
// Every link within it leads to a file and, with a fragment, to a place in it; every page is reached from the first one;
// nothing is loaded from elsewhere; an address outside is well formed.
import { existsSync, readFileSync, readdirSync, statSync } from "node:fs";
import path from "node:path";
import { parse } from "parse5";

const [site] = process.argv.slice(2);
// The page for addresses that do not exist is linked by none.
const UNLINKED = ["404.html"];

const faults = [];
const pages = new Map();

/** What a page links, loads and names. */
function read(page) {
  const found = { links: [], loads: [], ids: new Set() };
  const visit = (node) => {
    const attributes = Object.fromEntries((node.attrs ?? []).map(({ name, value }) => [name, value]));
    if (attributes.id) {
      if (found.ids.has(attributes.id)) faults.push(`${page}: two places are called #${attributes.id}`);
      found.ids.add(attributes.id);
    }
    if (node.tagName === "a" && attributes.href) found.links.push(attributes.href);
    if (node.tagName === "link" && attributes.href) found.loads.push(attributes.href);
    if (attributes.src) found.loads.push(attributes.src);
    (node.content ?? node).childNodes?.forEach(visit);
  };
  visit(parse(readFileSync(path.join(site, page), "utf8"), { scriptingEnabled: false }));
  return found;
}

/** The file of the site and the place in it that `target` on `page` names. */
function resolved(page, target) {
  const [file, fragment] = target.split("#");
  const there = file ? path.normalize(path.join(path.dirname(page), decodeURIComponent(file))) : page;
  const whole = path.join(site, there);
  const isFolder = existsSync(whole) && statSync(whole).isDirectory();
  return { there: isFolder ? path.join(there, "index.html") : there, fragment: fragment && decodeURIComponent(fragment) };
}

function follow(page, target) {
  const { there, fragment } = resolved(page, target);
  if (!existsSync(path.join(site, there))) faults.push(`${page}: ${target} does not exist`);
  else if (fragment && pages.has(there) && !pages.get(there).ids.has(fragment)) {
    faults.push(`${page}: ${target} names no place there`);
  }
  return there;
}

for (const page of readdirSync(site, { recursive: true }).filter((name) => name.endsWith(".html"))) pages.set(page, read(page));
const isOutside = (target) => /^[a-z][a-z0-9+.-]*:|^\/\//i.test(target);
const leads = new Map();
for (const [page, { links, loads }] of pages) {
  for (const target of loads.filter((target) => isOutside(target) && !target.startsWith("data:"))) {
    faults.push(`${page} loads ${target}`);
  }
  for (const target of links.filter(isOutside)) {
    if (!URL.canParse(target) || !target.startsWith("https://")) faults.push(`${page}: ${target} is no address of https`);
  }
  // mdBook writes the page of an unknown address for the root of a server.
  const inside = UNLINKED.includes(page) ? [] : [...links, ...loads].filter((target) => !isOutside(target));
  leads.set(page, inside.map((target) => follow(page, target)));
}
for (const style of readdirSync(site, { recursive: true }).filter((name) => name.endsWith(".css"))) {
  for (const [, target] of readFileSync(path.join(site, style), "utf8").matchAll(/url\(["']?([^"')]+)["']?\)/g)) {
    if (isOutside(target) && !target.startsWith("data:")) faults.push(`${style} loads ${target}`);
    else if (!target.startsWith("data:") && !target.startsWith("#")) follow(style, target.replace(/[?#].*/, ""));
  }
}

const reached = new Set(["index.html"]);
for (const page of reached) (leads.get(page) ?? []).forEach((target) => pages.has(target) && reached.add(target));
for (const page of pages.keys()) {
  if (!reached.has(page) && !UNLINKED.includes(page)) faults.push(`${page} is reached from nowhere`);
}

if (faults.length) {
  console.error(faults.join("\n"));
  process.exit(1);
}
const count = [...leads.values()].flat().length;
console.log(`${pages.size} pages, ${count} links within them`);
