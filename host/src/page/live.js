"use strict";
// Puts the parts of the page in their places as they come; hover, zoom, reconnect, commands.

const AGAIN_MS = 3000; // until a server that refused or went away is asked again
const ZOOM = 1.25; // of a step of the wheel or of a key
const MOVE = 0.1; // of the width that is seen, a key of an arrow
const views = new Map(); // pictures that are zoomed: identifier to what is seen
let ended = false;
let known = null; // the recording whose settings the form has

const element = (id) => document.getElementById(id);

function connection(text, lost) {
  const line = element("connection");
  if (line.textContent === text) return; // said once, not with every state
  line.textContent = text;
  line.className = lost ? "lost" : "";
}

// What the bench does decides which commands make sense; the others are refused with words.
function doing() {
  const { state, recording, rate, phase, highPass } = element("doing").firstElementChild.dataset;
  const sensible = {
    mark: state === "recording",
    stop: state === "recording",
    record: state === "recording" || state === "resting",
    "selftest-start": state === "resting",
  };
  for (const [id, yes] of Object.entries(sensible)) {
    const button = element(id).matches("button") ? element(id) : element(id).querySelector("button");
    button.setAttribute("aria-disabled", !yes);
  }
  if (recording === known || !rate) return;
  // The form begins with the settings of each new recording.
  known = recording;
  [element("rate").value, element("phase").value, element("high-pass").value] = [rate, phase, highPass];
}

function place([id, html]) {
  let target = element(id);
  if (!target) {
    // Parts of an axis, in the order in which they come first.
    target = document.createElement("section");
    target.id = id;
    element("axes").append(target);
  }
  const focused = document.activeElement?.id;
  // What is wider than the screen stays where it was scrolled to.
  const wide = () => target.querySelectorAll(".scroll, figure");
  const left = [...wide()].map((one) => one.scrollLeft);
  target.innerHTML = html;
  wide().forEach((one, number) => (one.scrollLeft = left[number] ?? 0));
  target.querySelectorAll("figure[data-x]").forEach(picture);
  if (id === "doing") doing();
  // A picture that is drawn anew keeps the focus.
  if (focused && document.activeElement === document.body) element(focused)?.focus({ preventScroll: true });
}

function follow() {
  const source = new EventSource("events");
  source.addEventListener("parts", (event) => {
    connection("connected", false);
    JSON.parse(event.data).forEach(place);
  });
  source.addEventListener("end", (event) => {
    JSON.parse(event.data).forEach(place);
    ended = true;
    source.close();
    connection("the recording has ended: this is its last state", false);
    document.querySelectorAll("button").forEach((button) => (button.disabled = true));
  });
  source.onerror = () => {
    if (ended) return;
    connection("no connection: what is shown is old, the recording may go on", true);
    if (source.readyState === EventSource.CLOSED) setTimeout(follow, AGAIN_MS);
  };
}

// --- pictures: reading values, zoom ---------------------------------------------------------------

function scale(text) {
  const [kind, from, to, first, last] = text.split(" ");
  const [a, b, p, q] = [from, to, first, last].map(Number);
  return (pixel) => {
    const value = a + ((pixel - p) / (q - p)) * (b - a);
    return kind === "log" ? 10 ** value : value;
  };
}

function picture(figure) {
  const svg = figure.querySelector("svg");
  const whole = svg.getAttribute("viewBox");
  const readout = figure.querySelector(".readout");
  const [x, y] = [scale(figure.dataset.x), scale(figure.dataset.y)];
  const see = (box) => {
    if (box) views.set(figure.id, box);
    else views.delete(figure.id);
    svg.setAttribute("viewBox", box ? box.join(" ") : whole);
  };
  const seen = () => svg.getAttribute("viewBox").split(" ").map(Number);
  const at = (event) => {
    const area = svg.getBoundingClientRect();
    const [left, top, width, height] = seen();
    return [
      left + ((event.clientX - area.left) / area.width) * width,
      top + ((event.clientY - area.top) / area.height) * height,
    ];
  };
  const zoom = (factor, [px, py]) => {
    const [left, top, width, height] = seen();
    if (width * factor >= Number(whole.split(" ")[2])) return see(null);
    see([px - (px - left) * factor, py - (py - top) * factor, width * factor, height * factor]);
  };
  const move = (dx, dy) => {
    const [left, top, width, height] = seen();
    if (views.has(figure.id)) see([left + dx * width, top + dy * height, width, height]);
  };
  if (views.has(figure.id)) see(views.get(figure.id));
  svg.addEventListener("pointermove", (event) => {
    const [px, py] = at(event);
    readout.textContent = `${figure.dataset.xName} ${x(px).toPrecision(4)}, ${figure.dataset.yName} ${y(py).toPrecision(3)}`;
  });
  svg.addEventListener("wheel", (event) => {
    // The wheel scrolls the page, unless the picture was clicked first.
    if (document.activeElement !== figure) return;
    event.preventDefault();
    zoom(event.deltaY > 0 ? ZOOM : 1 / ZOOM, at(event));
  }, { passive: false });
  svg.addEventListener("dblclick", () => see(null));
  figure.addEventListener("keydown", (event) => {
    const [left, top, width, height] = seen();
    const middle = [left + width / 2, top + height / 2];
    const act = {
      "+": () => zoom(1 / ZOOM, middle),
      "-": () => zoom(ZOOM, middle),
      0: () => see(null),
      ArrowLeft: () => move(-MOVE, 0),
      ArrowRight: () => move(MOVE, 0),
      ArrowUp: () => move(0, -MOVE),
      ArrowDown: () => move(0, MOVE),
    }[event.key];
    if (!act || (event.key.startsWith("Arrow") && !views.has(figure.id))) return;
    event.preventDefault();
    act();
  });
}

// --- commands -------------------------------------------------------------------------------------

/** Whether it was done. */
async function command(what, body, done) {
  const say = (answer) => (element("answer").textContent = answer);
  try {
    const response = await fetch(what, { method: "POST", body });
    say(response.ok ? done : `refused: ${await response.text()}`);
    return response.ok;
  } catch {
    say("not done: no connection");
    return false;
  }
}

element("mark").addEventListener("submit", (event) => {
  event.preventDefault();
  command("mark", element("note").value, "marked").then((done) => done && (element("note").value = ""));
});

const recording = () => element("doing").firstElementChild?.dataset.state === "recording";

element("record").addEventListener("submit", (event) => {
  event.preventDefault();
  if (recording() && !confirm("End this recording, and start another one?")) return;
  const [rate, phase, high_pass] = ["rate", "phase", "high-pass"].map((id) => element(id).value);
  command("record", JSON.stringify({ rate, phase, high_pass }), "a new recording starts");
});
element("stop").addEventListener("click", () => {
  if (!recording() || confirm("Stop the recording?")) command("stop", "", "the recording stops");
});
element("selftest-start").addEventListener("click", () => command("selftest", "", "the board tests itself"));
element("end").addEventListener("click", () => {
  if (confirm("End inm live, and this page with it?")) command("end", "", "inm live ends");
});
follow();
