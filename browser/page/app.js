// The page: gives the worker a motion and options, and shows its results.

const $ = (id) => document.getElementById(id);
const encoder = new TextEncoder(), decoder = new TextDecoder();
const STAGES = { reading: "Reading", frames: "Inverse kinematics", fit: "Fitting the whole clip", measuring: "Measuring",
  drawing: "Drawing" };

let worker, engine, data, form, editor;
let motion = null;       // {name, bytes}
let results = new Map(); // of the last run, by name
let pendingJob = null;   // resolves the running job

async function embedded(id) {
  const text = $(id).textContent.trim();
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function startWorker() {
  const url = URL.createObjectURL(new Blob([$("worker-source").textContent], { type: "text/javascript" }));
  worker = new Worker(url);
  worker.fresh = true;
  worker.onmessage = ({ data: message }) => {
    if (message.kind === "progress") showProgress(message);
    else if (pendingJob) pendingJob(message);
  };
  worker.onerror = (event) => {
    if (pendingJob) pendingJob({ code: -1, out: [], errors: [`the worker failed: ${event.message}`], seconds: 0 });
  };
}

// Runs the engine in the worker; a new worker gets the engine first.
function runJob(words, files) {
  return new Promise((resolve) => {
    pendingJob = (message) => {
      pendingJob = null;
      resolve(message);
    };
    const message = { words, files };
    if (worker.fresh) Object.assign(message, { engine, data });
    worker.fresh = false;
    worker.postMessage(message);
  });
}

function showStatus(text, failed = false) {
  $("status").textContent = text;
  $("status").classList.toggle("failed", failed);
}

function showProgress({ stage, done }) {
  const begin = { reading: 0, frames: 0.02, fit: 0.2, measuring: 0.9, drawing: 0.97 }[stage] || 0;
  const length = { frames: 0.18, fit: 0.7 }[stage] || 0;
  $("progress").value = $("method").value === "gmr" && stage === "frames" ? 0.02 + 0.88 * done : begin + length * done;
  showStatus(`${STAGES[stage] || stage} ...`);
}

function setBusy(busy) {
  $("solve").disabled = $("solve-edits").disabled = busy || motion === null;
  $("stop").hidden = $("progress").hidden = !busy;
}

function offer(name, bytes, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([bytes], { type }));
  link.download = name;
  link.textContent = name;
  return link;
}

function showResult(out, seconds) {
  results = new Map(out);
  const result = JSON.parse(decoder.decode(results.get("result.json")));
  const stem = motion.name.replace(/\.[^.]*$/, "");
  $("result").hidden = false;
  $("verdict").textContent = result.passed ? "All gates passed." : `${result.missed.length} gates missed:`;
  $("verdict").className = result.passed ? "good" : "bad";
  $("missed").replaceChildren(...result.missed.map((gate) => {
    const item = document.createElement("li");
    const bound = gate.max !== undefined ? `at most ${gate.max}` : `at least ${gate.min}`;
    item.textContent = `${gate.metric}: ${Number(gate.value).toPrecision(4)} ${gate.unit}, ${bound}`;
    return item;
  }));
  const files = [["motion.csv", `${stem}_${result.robot}.csv`, "text/csv"], ["report.json", `${stem}_${result.robot}.report.json`,
    "application/json"], ["page.html", `${stem}_${result.robot}.html`, "text/html"]];
  const links = files.map(([name, shown, type]) => offer(shown, results.get(name), type));
  links[0].id = "csv";
  $("downloads").replaceChildren("Download: ", ...links.flatMap((link) => [link, " "]));
  $("viewer").srcdoc = decoder.decode(results.get("page.html"));
  $("report").textContent = result.report;
  $("summary").textContent = [result.summary.trimEnd(), ...result.notes].join("\n");
  $("contacts").hidden = $("method").value === "gmr";
  editor.show(result.contacts, result.seconds);
  showStatus(`${result.frames} frames at ${result.fps} per second, solved in ${seconds.toFixed(1)} s`);
  document.documentElement.dataset.state = "solved";
}

async function solve() {
  const isFit = $("method").value === "fit";
  const options = { motion: `/job/${motion.name}`, robot: $("robot").value, method: $("method").value,
    output: "/out/motion.csv", ...form.values() };
  const files = [[`job/${motion.name}`, motion.bytes]];
  if (isFit && editor.edits.length > 0) {
    options["contact-edits"] = "/job/edits.json";
    files.push(["job/edits.json", encoder.encode(editor.text())]);
  }
  files.push(["job/options.json", encoder.encode(JSON.stringify(options))]);
  document.documentElement.dataset.state = "solving";
  setBusy(true);
  const message = await runJob(["solve", "/job/options.json"], files);
  setBusy(false);
  if (message.code === 0) {
    showResult(message.out, message.seconds);
    return;
  }
  document.documentElement.dataset.state = "failed";
  showStatus(message.errors.join("\n") || `the engine ended with code ${message.code}`, true);
  // An engine that ended within a run may hold memory.
  worker.terminate();
  startWorker();
}

async function takeFile(file) {
  // The name becomes a path in the engine.
  motion = { name: file.name.replace(/[/\\]/g, "_"), bytes: new Uint8Array(await file.arrayBuffer()) };
  $("file-name").textContent = file.name;
  editor.clear();
  setBusy(false);
  solve();
}

function stop() {
  worker.terminate();
  startWorker();
  if (pendingJob) pendingJob({ code: -1, out: [], errors: ["stopped"], seconds: 0 });
}

function connect() {
  $("file").addEventListener("change", () => $("file").files[0] && takeFile($("file").files[0]));
  for (const name of ["dragover", "dragleave", "drop"]) {
    document.addEventListener(name, (event) => {
      event.preventDefault();
      $("drop").classList.toggle("over", name === "dragover");
      if (name === "drop" && event.dataTransfer.files[0]) takeFile(event.dataTransfer.files[0]);
    });
  }
  $("solve").addEventListener("click", solve);
  $("solve-edits").addEventListener("click", solve);
  $("stop").addEventListener("click", stop);
  $("save-edits").addEventListener("click", () => offer("edits.json", editor.text(), "application/json").click());
  $("load-edits").addEventListener("change", async () => {
    try {
      editor.load(await $("load-edits").files[0].text());
    } catch (error) {
      showStatus(`edits.json: ${error.message}`, true);
    }
  });
}

async function start() {
  editor = new ContactEditor($("timeline"), $("edits"), () => $("whole-foot").checked,
    () => showStatus("The edits take effect when you solve again."));
  [engine, data] = await Promise.all([embedded("engine"), embedded("data")]);
  startWorker();
  const message = await runJob(["options"], []);
  if (message.code !== 0) throw new Error(message.errors.join("\n"));
  const out = new Map(message.out);
  $("licences").replaceChildren("Licences of this page and its parts: ", offer("licences.txt", out.get("licences.txt"), "text/plain"));
  const { robots, options } = JSON.parse(decoder.decode(out.get("options.json")));
  for (const robot of robots) $("robot").append(new Option(robot.name, robot.name, false, robot.name === "unitree_g1"));
  $("robot").value = "unitree_g1";
  form = new OptionForm($("option-groups"), $("option-count"), options);
  connect();
  setBusy(false);
  showStatus("Ready.");
  document.documentElement.dataset.state = "ready";
}

start().catch((error) => showStatus(`The engine did not start: ${error.message}`, true));
