// The controls and figures beside the picture.

const byId = (id) => document.getElementById(id);

// An element with properties and children.
function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

// A box to check, with a key of its colour and a count where there are such; `change` gets whether it is checked.
function switchFor({ id, label, key, colour, count, checked }, change) {
  const box = element("input", { type: "checkbox", checked });
  if (id) box.dataset.layer = id;
  box.addEventListener("change", () => change(box.checked));
  const parts = [box];
  if (colour) {
    const mark = element("span", { className: `key ${key ?? ""}` });
    mark.style.background = mark.style.borderColor = colour;
    parts.push(mark);
  }
  parts.push(element("span", { textContent: label }));
  if (count !== undefined) parts.push(element("span", { className: "count", textContent: count.toLocaleString("en") }));
  return element("label", {}, ...parts);
}

// Names below a width at their shares of it.
function marksOf(marks) {
  const names = marks.map(([share, name]) => {
    const mark = element("span", { textContent: name });
    mark.style.left = `${100 * share}%`;
    // A name is below the middle of its place, but inside of the width.
    mark.style.transform = `translateX(-${share === 0 ? 0 : share === 1 ? 100 : 50}%)`;
    return mark;
  });
  return element("div", { className: "marks" }, ...names);
}

function showLegend(scale) {
  const legend = byId("legend");
  legend.hidden = !scale;
  if (!scale) return;
  const bar = element("div", { className: "bar" });
  bar.style.background = `linear-gradient(to right, ${scale.ramp.join(", ")})`;
  legend.replaceChildren(element("div", { textContent: scale.title }), bar, marksOf(scale.marks));
}

function histogramOf({ title, of, marks, counts }) {
  const space = "http://www.w3.org/2000/svg", svg = document.createElementNS(space, "svg");
  const most = Math.max(...counts, 1), sum = counts.reduce((sum, count) => sum + count, 0);
  const about = `${sum.toLocaleString("en")} ${of}`;
  const set = (node, values) => Object.entries(values).forEach(([name, value]) => node.setAttribute(name, value));
  set(svg, { viewBox: `0 0 ${counts.length} 100`, preserveAspectRatio: "none", role: "img", "aria-label": `${title}: ${about}` });
  counts.forEach((count, k) => {
    const bar = document.createElementNS(space, "rect"), height = 100 * count / most;
    set(bar, { x: k + 0.06, width: 0.88, y: 100 - height, height });
    const told = document.createElementNS(space, "title");
    told.textContent = `${count.toLocaleString("en")} of ${about}`;
    bar.append(told);
    svg.append(bar);
  });
  const caption = element("figcaption", { textContent: title }, element("span", { className: "count", textContent: about }));
  return element("figure", {}, caption, svg, marksOf(marks));
}

// What does not change: names, notes, histograms and figures.
function showFigures(data) {
  byId("name").textContent = data.name;
  byId("program").textContent = `Written by ${data.program}`;
  byId("notes").replaceChildren(...data.notes.map((textContent) => element("li", { textContent })));
  byId("histograms").replaceChildren(...data.histograms.map(histogramOf));
  byId("figures-section").hidden = data.figures.length === 0;
  byId("figures").replaceChildren(...data.figures.map(([name, value]) =>
    element("tr", {}, element("th", { scope: "row", textContent: name }), element("td", { textContent: value }))));
}

// Offers a text as a file.
function save(name, text) {
  const link = element("a", { href: URL.createObjectURL(new Blob([text])), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  URL.revokeObjectURL(link.href);
}
