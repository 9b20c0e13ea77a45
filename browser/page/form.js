// The form of the options, made from the rows of the engine's option table.

// The page itself sets these, or their files do not exist here.
const NOT_IN_FORM = new Set(["motion", "robot", "output", "method", "contact-edits", "engine", "memory", "format", "contacts",
  "scene-out", "robot-xml", "robot-profile"]);

function inputFor(row) {
  if (row.choices && row.kind !== "list") {
    const select = document.createElement("select");
    const choices = row.choices.includes(row.standard) ? row.choices : ["", ...row.choices];
    for (const choice of choices) select.append(new Option(choice, choice, choice === row.standard, choice === row.standard));
    return select;
  }
  const input = document.createElement("input");
  if (row.kind === "flag") {
    input.type = "checkbox";
    input.checked = row.standard === "true";
  } else {
    input.placeholder = row.standard;
  }
  return input;
}

// The value of an input as JSON; undefined: as by default.
function valueOf(row, input) {
  if (row.kind === "flag") return input.checked === (row.standard === "true") ? undefined : input.checked;
  const text = input.value.trim();
  if (text === "" || text === row.standard) return undefined;
  if (row.kind === "integer" || row.kind === "number") return Number.isFinite(Number(text)) ? Number(text) : text;
  return row.kind === "list" ? text.split(",").map((each) => each.trim()) : text;
}

export class OptionForm {
  constructor(folder, count, rows) {
    this.inputs = [];
    const groups = new Map();
    for (const row of rows) {
      if (NOT_IN_FORM.has(row.name) || row.file) continue;
      if (!groups.has(row.group)) {
        const field = document.createElement("fieldset");
        const legend = document.createElement("legend");
        legend.textContent = row.group || "Other";
        field.append(legend);
        groups.set(row.group, field);
        folder.append(field);
      }
      const line = document.createElement("div"), label = document.createElement("label"), help = document.createElement("small");
      line.className = "option";
      const input = inputFor(row);
      input.id = `option-${row.name}`;
      label.htmlFor = input.id;
      label.textContent = row.name;
      help.textContent = row.help;
      line.append(label, input, help);
      groups.get(row.group).append(line);
      input.addEventListener("change", () => {
        line.classList.toggle("changed", valueOf(row, input) !== undefined);
        const changed = Object.keys(this.values()).length;
        count.textContent = changed > 0 ? `(${changed} changed)` : "";
      });
      this.inputs.push([row, input]);
    }
  }

  // The changed options by name.
  values() {
    const values = {};
    for (const [row, input] of this.inputs) {
      const value = valueOf(row, input);
      if (value !== undefined) values[row.name] = value;
    }
    return values;
  }
}
