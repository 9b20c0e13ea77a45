// Contact edits: a timeline of the contacts of the human's feet, and the list of edits that are made on it. The JSON is
// that of the option contact-edits.

const PARTS = ["left_heel", "left_toe", "right_heel", "right_toe"];
const LABEL_WIDTH = 78, ROW_HEIGHT = 26, TOP = 4;
const SVG = "http://www.w3.org/2000/svg";
const SHORTEST = 0.03;  // seconds; a shorter drag is a click

// Milliseconds are finer than frames, and short in a file.
const roundedTime = (seconds) => Math.round(seconds * 1000) / 1000;

export class ContactEditor {
  constructor(timeline, list, isWholeFoot, onChange) {
    Object.assign(this, { timeline, list, isWholeFoot, onChange, edits: [], contacts: {}, seconds: 1, selected: null });
    this.timeline.tabIndex = 0;
    this.timeline.addEventListener("keydown", (event) => {
      if ((event.key === "Delete" || event.key === "Backspace") && this.selected) this.removeSelected();
    });
  }

  // Shows the contacts of a solved motion, in which the edits are already applied.
  show(contacts, seconds) {
    Object.assign(this, { contacts, seconds, selected: null });
    this.draw();
  }

  clear() {
    this.edits = [];
    this.selected = null;
    this.drawList();
  }

  text() {
    return `${JSON.stringify({ contacts: this.edits }, null, 2)}\n`;
  }

  // Takes the text of an edits.json; throws on other text.
  load(text) {
    const { contacts } = JSON.parse(text);
    if (!Array.isArray(contacts)) throw new Error('expected {"contacts": [...]}');
    this.edits = contacts;
    this.drawList();
    this.onChange();
  }

  add(edit) {
    this.edits.push(edit);
    this.drawList();
    this.onChange();
  }

  partOf(row) {
    return this.isWholeFoot() ? `${PARTS[row].split("_")[0]}_foot` : PARTS[row];
  }

  removeSelected() {
    const { row, start, end } = this.selected;
    this.add({ part: this.partOf(row), action: "remove", start: roundedTime(start), end: this.clipped(end) });
    this.selected = null;
    this.draw();
  }

  // Rounding must not move a time outside the motion.
  clipped(seconds) {
    return Math.min(Math.max(0, roundedTime(seconds)), Math.floor(this.seconds * 1000) / 1000);
  }

  draw() {
    const width = Math.max(300, this.timeline.clientWidth || 900);
    const scale = (width - LABEL_WIDTH - 8) / this.seconds;
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", `0 0 ${width} ${TOP + PARTS.length * ROW_HEIGHT + 20}`);
    const place = (name, attributes, text) => {
      const element = document.createElementNS(SVG, name);
      for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
      if (text !== undefined) element.textContent = text;
      svg.append(element);
      return element;
    };
    const timeAt = (event) => {
      const box = svg.getBoundingClientRect();
      const x = (event.clientX - box.left) * (width / box.width);
      return Math.min(this.seconds, Math.max(0, (x - LABEL_WIDTH) / scale));
    };
    PARTS.forEach((part, row) => {
      const y = TOP + row * ROW_HEIGHT;
      place("text", { x: 2, y: y + 15 }, part.replace("_", " "));
      const background = place("rect", {
        class: "row", x: LABEL_WIDTH, y, width: this.seconds * scale, height: ROW_HEIGHT - 4 });
      background.dataset.part = part;
      this.dragToAdd(background, svg, row, timeAt, scale);
      for (const [start, end] of this.contacts[part] || []) {
        const bar = place("rect", { class: "contact", x: LABEL_WIDTH + start * scale, y: y + 2,
          width: Math.max(1, (end - start) * scale), height: ROW_HEIGHT - 8 });
        const title = document.createElementNS(SVG, "title");
        title.textContent = `${part.replace("_", " ")}: ${start.toFixed(2)} to ${end.toFixed(2)} s`;
        bar.append(title);
        this.dragToShift(bar, { row, start, end }, timeAt, scale);
      }
    });
    const step = [0.5, 1, 2, 5, 10, 20, 60, 120].find((each) => each * scale > 50) || 300;
    for (let t = 0; t <= this.seconds; t += step) {
      place("text", { x: LABEL_WIDTH + t * scale, y: TOP + PARTS.length * ROW_HEIGHT + 12 }, `${t} s`);
    }
    this.timeline.replaceChildren(svg);
  }

  dragToAdd(background, svg, row, timeAt, scale) {
    background.addEventListener("pointerdown", (down) => {
      background.setPointerCapture(down.pointerId);
      const from = timeAt(down);
      const draft = document.createElementNS(SVG, "rect");
      draft.setAttribute("class", "draft");
      draft.setAttribute("y", TOP + row * ROW_HEIGHT + 2);
      draft.setAttribute("height", ROW_HEIGHT - 8);
      svg.append(draft);
      const move = (event) => {
        const [a, b] = [from, timeAt(event)].sort((x, y) => x - y);
        draft.setAttribute("x", LABEL_WIDTH + a * scale);
        draft.setAttribute("width", (b - a) * scale);
      };
      background.addEventListener("pointermove", move);
      background.addEventListener("pointerup", (up) => {
        background.removeEventListener("pointermove", move);
        draft.remove();
        const [start, end] = [from, timeAt(up)].sort((x, y) => x - y);
        if (end - start < SHORTEST) return;
        this.add({ part: this.partOf(row), action: "add", start: this.clipped(start), end: this.clipped(end) });
      }, { once: true });
    });
  }

  dragToShift(bar, contact, timeAt, scale) {
    bar.addEventListener("pointerdown", (down) => {
      bar.setPointerCapture(down.pointerId);
      const from = timeAt(down);
      const move = (event) => bar.setAttribute("transform", `translate(${(timeAt(event) - from) * scale} 0)`);
      bar.addEventListener("pointermove", move);
      bar.addEventListener("pointerup", (up) => {
        bar.removeEventListener("pointermove", move);
        const by = timeAt(up) - from;
        if (Math.abs(by) >= SHORTEST) {
          this.add({ part: this.partOf(contact.row), action: "shift", start: this.clipped(contact.start),
            end: this.clipped(contact.end), by: roundedTime(by) });
          return;
        }
        for (const other of this.timeline.querySelectorAll(".selected")) other.classList.remove("selected");
        bar.classList.add("selected");
        this.selected = contact;
        this.timeline.focus();
      }, { once: true });
    });
  }

  drawList() {
    this.list.replaceChildren(...this.edits.map((edit, index) => {
      const item = document.createElement("li");
      const by = edit.action === "shift" ? ` by ${edit.by} s` : "";
      item.textContent = `${edit.action} ${edit.part}, ${edit.start} to ${edit.end} s${by} `;
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = "Undo";
      button.addEventListener("click", () => {
        this.edits.splice(index, 1);
        this.drawList();
        this.onChange();
      });
      item.append(button);
      return item;
    }));
  }
}
