// Asks the server that the page comes from for meshes. Its addresses are relative, as the page's own has the token.

// The time between two questions for the progress, in milliseconds.
const PAUSE = 150;

// The answer of the server, as JSON; with a text it is told that.
async function ask(address, text) {
  const request = text === undefined ? {} : { method: "POST", body: text };
  const answer = await fetch(address, request).catch(() => { throw new Error("The server does not answer; perhaps it was ended."); });
  const value = await answer.json();
  if (!answer.ok) throw new Error(value.error);
  return value;
}

// What is to be meshed: the options of the form, and what was drawn.
function order() {
  const options = {}, { lineCount, paintedCount } = drawing;
  for (const name of ["points", "layout"]) if (byId(name).value !== "") options[name] = byId(name).value;
  return JSON.stringify({
    options,
    ...(lineCount > 0 ? { guides: drawing.guides() } : {}),
    ...(paintedCount > 0 ? { sizes: drawing.sizes() } : {}),
  });
}

function showRun({ state, stage, share = 0, message }) {
  const isRunning = state === "running";
  byId("mesh").disabled = isRunning;
  byId("cancel").disabled = !isRunning;
  byId("share").hidden = !isRunning;
  byId("share").value = share;
  const told = { running: `${stage}, ${Math.round(100 * share)} %`, cancelled: "Cancelled.", done: "Meshed.", failed: message };
  byId("run").textContent = told[state];
}

// Shows the progress of a run until it ends, and then its mesh.
async function follow(status) {
  while (status.state === "running") {
    showRun(status);
    await new Promise((resolve) => setTimeout(resolve, PAUSE));
    status = await ask("status");
  }
  if (status.state === "done") show(await ask("data"));
  showRun(status);
}

// Does what a button asks for; what goes wrong is told beside it.
async function attempt(action) {
  try {
    await action();
  } catch (error) {
    showRun({ state: "failed", message: error.message });
  }
}

function saveMesh() {
  const link = element("a", { href: "mesh", download: "" });
  document.body.append(link);
  link.click();
  link.remove();
}

if (gl) {
  byId("mesh").addEventListener("click", () => attempt(async () => follow(await ask("run", order()))));
  byId("cancel").addEventListener("click", () => attempt(() => ask("cancel", "")));
  byId("save-mesh").addEventListener("click", saveMesh);
  attempt(async () => {
    const status = await ask("status");
    byId("points").value = status.points ?? "";
    if (status.state === "running") await follow(status);
  });
}
