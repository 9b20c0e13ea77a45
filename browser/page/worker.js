// The worker of the page: compiles the engine once and runs it for each message.

let compiled, dataFiles;

// Runs one job: {words, files: [[path, bytes], ...]}.
async function runJob(message) {
  if (message.engine) {
    compiled = await WebAssembly.compile(message.engine);
    dataFiles = unpackBundle(message.data);
  }
  const files = new MemoryFiles([...dataFiles, ...(message.files || [])]);
  const begin = performance.now();
  const result = runProgram(compiled, ["retarget", ...message.words], files, (line) => {
    const progress = /^progress (\w+) ([\d.]+)$/.exec(line);
    if (progress) postMessage({ kind: "progress", stage: progress[1], done: Number(progress[2]) });
  });
  const out = [...result.files].filter(([path]) => path.startsWith("out/")).map(([path, bytes]) => [path.slice(4), bytes.slice()]);
  const errors = result.errors.filter((line) => !line.startsWith("progress "));
  postMessage({ kind: "done", code: result.code, out, errors, seconds: (performance.now() - begin) / 1000 });
}

onmessage = (event) => {
  runJob(event.data).catch((error) => {
    postMessage({ kind: "done", code: -1, out: [], errors: [`the engine failed: ${error.message}`], seconds: 0 });
  });
};
