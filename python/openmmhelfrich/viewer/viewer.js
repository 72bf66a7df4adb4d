// The page: what the keys, buttons and pointers do, and what follows the slider.

/** Frames of the scene in a second while it plays. */
const PLAYING = 15;

/** Powers of modes below this are none. */
const ROUNDING = 1e-24;

const get = (id) => document.getElementById(id);

class Viewer {
  constructor(scene) {
    this.scene = scene;
    // What has come of a run is its last frame.
    this.frame = scene.frames.length - 1;
    this.field = 0;
    /** The number of a surface; −1 for all. */
    this.chosen = -1;
    this.options = { edges: true, flat: false };
    this.row = null;
    this.followers = [];
    this.surface = new Surface(get("canvas"));
    this.camera = new Camera(Math.max(...scene.frames.map(extent)));
    get("title").textContent = document.title;
    this.fill();
    this.listen();
    if (!this.surface.gl) {
      complain("This browser has no WebGL 2, so there is no picture; the numbers are beside.");
    }
    this.remember();
    this.choose(this.chosen);
    this.colour(this.field);
    this.press();
    // What is drawn follows the size of the window.
    new ResizeObserver(() => this.resize()).observe(get("canvas"));
    this.resize();
  }

  /** Lists, and what is not needed for one frame or one surface. */
  fill() {
    const { scene } = this;
    scene.fields.forEach((field, k) => get("field").add(new Option(field.label, k)));
    get("surface").add(new Option("all surfaces", -1));
    scene.surfaces.forEach((name, k) => get("surface").add(new Option(`surface ${name}`, k)));
    get("surface").hidden = scene.surfaces.length < 2;
    const still = scene.frames.length < 2;
    document.body.classList.toggle("still", still);
    get("slider").max = scene.frames.length - 1;
  }

  listen() {
    const canvas = get("canvas");
    followPointers(canvas, this.camera, () => this.redraw());
    canvas.addEventListener("pointermove", (event) => this.point(event));
    canvas.addEventListener("pointerleave", () => (get("tip").hidden = true));
    canvas.addEventListener("dblclick", () => this.home());
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.surface.prepare();
      this.colour(this.field);
      this.show(this.frame);
    });
    get("field").addEventListener("change", (event) => this.colour(Number(event.target.value)));
    get("surface").addEventListener("change", (event) => this.choose(Number(event.target.value)));
    get("slider").addEventListener("input", (event) => this.show(Number(event.target.value)));
    for (const name of ["edges", "flat"]) get(name).addEventListener("click", () => this.toggle(name));
    get("home").addEventListener("click", () => this.home());
    get("help").addEventListener("click", () => this.help());
    get("play").addEventListener("click", () => this.play(!this.playing));
    document.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      // Lists and the slider have these keys themselves.
      if (/^(SELECT|INPUT)$/.test(event.target.tagName) && /^(Arrow|Home|End)/.test(event.key)) return;
      if (event.target.tagName === "BUTTON" && event.key === " ") return;
      const act = this.keys[(event.shiftKey && event.key.startsWith("Arrow") ? "Shift" : "") + event.key]
        ?? this.keys[event.key.toLowerCase()];
      if (!act) return;
      event.preventDefault();
      act();
    });
    this.keys = {
      ArrowLeft: () => this.show(this.frame - 1),
      ArrowRight: () => this.show(this.frame + 1),
      Home: () => this.show(0),
      End: () => this.show(this.scene.frames.length - 1),
      ShiftArrowLeft: () => this.turn(-0.1, 0),
      ShiftArrowRight: () => this.turn(0.1, 0),
      ShiftArrowUp: () => this.turn(0, -0.1),
      ShiftArrowDown: () => this.turn(0, 0.1),
      "+": () => this.zoom(1.15),
      "=": () => this.zoom(1.15),
      "-": () => this.zoom(1 / 1.15),
      0: () => this.home(),
      " ": () => this.play(!this.playing),
      e: () => this.toggle("edges"),
      f: () => this.toggle("flat"),
      v: () => this.choose(this.chosen + 1 < this.scene.surfaces.length ? this.chosen + 1 : -1),
      "?": () => this.help(),
      escape: () => (get("keys").hidden = true),
    };
    this.scene.fields.forEach((_, k) => (this.keys[k + 1] = () => this.colour(k)));
  }

  /** Show a frame, and everything that belongs to it. */
  show(frame) {
    const { scene } = this;
    this.frame = Math.min(scene.frames.length - 1, Math.max(0, frame));
    const now = scene.frames[this.frame];
    if (this.surface.gl) {
      const positions = positionsOf(now);
      if (this.shownMesh !== now.mesh || this.surface.count === 0) this.surface.setTriangles(now.mesh.corners);
      this.shownMesh = now.mesh;
      this.surface.setPoints(positions, normalsOf(positions, now.mesh.corners), this.places());
    }
    get("slider").value = this.frame;
    get("slider").setAttribute("aria-valuetext", `${shortNumber(now.time, 6)} ps`);
    get("count").textContent = `${this.frame + 1} / ${scene.frames.length}`;
    get("when").textContent = `${shortNumber(now.time, 6)} ps · step ${now.step}`;
    for (const follow of this.followers) follow(this.frame);
    this.redraw();
  }

  /** Colour by a field. */
  colour(field) {
    this.field = field;
    get("field").value = field;
    const { kind } = this.scene.fields[field];
    showLegend(get("legend"), this.scene.fields[field]);
    if (!this.surface.gl) return;
    this.surface.setMap(kind);
    if (this.surface.positions) this.surface.setValues(this.places());
    this.redraw();
  }

  /** Places of the points on the colour map; those of other surfaces have none. */
  places() {
    const { scene, field, chosen } = this;
    const now = scene.frames[this.frame];
    return Float32Array.from({ length: now.mesh.points }, (_, i) =>
      chosen >= 0 && now.mesh.surfaces[i] !== chosen ? -1
        : placeOnMap(scene.fields[field], valueAt(scene, now, field, i)));
  }

  /** Numbers and spectrum of one surface, or of all. */
  choose(surface) {
    this.chosen = surface;
    get("surface").value = surface;
    const { scene } = this;
    const only = scene.surfaces.length === 1 ? 0 : surface;
    const measures = scene.series.filter((each) => each.unit !== "kJ/mol" && (each.surface ?? -1) === only);
    const energies = scene.series.filter((each) => each.unit === "kJ/mol");
    this.followers = [];
    const body = get("numbers").tBodies[0];
    body.replaceChildren();
    for (const series of measures) this.addRow(body, series);
    if (energies.length) this.addHeading(body, "energies (kJ/mol)");
    for (const series of energies) this.addRow(body, series);
    this.openRow(this.row ?? keyOf(energies[0] ?? measures[0]));
    const rows = only >= 0 ? scene.spectra[only] : null;
    // An exact sphere has nothing but rounding.
    const shown = !!rows && meanSpectrum(rows).some((power) => power > ROUNDING);
    get("modes").hidden = !shown;
    if (shown) this.followers.push(spectrumPlot(get("spectrum"), rows));
    this.show(this.frame);
  }

  addHeading(body, text) {
    const cell = body.insertRow().appendChild(document.createElement("th"));
    cell.colSpan = 3;
    cell.textContent = text;
  }

  addRow(body, series) {
    const row = body.insertRow();
    row.dataset.key = keyOf(series);
    const name = row.insertCell();
    const button = name.appendChild(document.createElement("button"));
    button.textContent = series.label;
    button.title = "Show over time";
    row.onclick = () => this.openRow(keyOf(series));
    row.series = series;
    const cell = row.insertCell();
    const mark = this.scene.frames.length > 1 ? sparkline(cell, series.values, 64, 18) : () => {};
    const value = row.insertCell();
    this.followers.push((frame) => {
      mark(frame);
      const unit = series.unit === "kJ/mol" ? "" : series.unit;
      value.textContent = `${shortNumber(series.values[frame], 6)} ${unit}`;
      value.dataset.value = series.values[frame];
    });
  }

  /** Show a number over time. */
  openRow(key) {
    if (this.scene.frames.length < 2) return;
    const rows = [...get("numbers").rows];
    const row = rows.find((each) => each.dataset.key === key) ?? rows[0];
    this.row = row.dataset.key;
    for (const each of rows) each.classList.toggle("open", each === row);
    const times = this.scene.frames.map((frame) => frame.time);
    this.mark = chart(get("chart"), times, row.series, (frame) => this.show(frame));
    if (!this.followers.includes(this.follow)) {
      this.follow = (frame) => this.mark(frame);
      this.followers.push(this.follow);
    }
    this.mark(this.frame);
    this.redraw();
  }

  toggle(name) {
    this.options[name] = !this.options[name];
    this.press();
    this.redraw();
  }

  press() {
    for (const name of ["edges", "flat"]) get(name).setAttribute("aria-pressed", this.options[name]);
  }

  turn(right, up) {
    this.camera.turn(right, up);
    this.redraw();
  }

  zoom(factor) {
    this.camera.closer(factor);
    this.redraw();
  }

  home() {
    this.camera.reset();
    this.redraw();
  }

  help() {
    get("keys").hidden = !get("keys").hidden;
  }

  /** Play from here, or again from the start, or stop. */
  play(on) {
    this.playing = on && this.scene.frames.length > 1;
    get("play").textContent = this.playing ? "❚❚" : "▶";
    get("play").setAttribute("aria-label", this.playing ? "Stop" : "Play");
    if (!this.playing) return;
    let before = null;
    const next = (now) => {
      if (!this.playing) return;
      before ??= now;
      const passed = Math.floor(((now - before) / 1000) * PLAYING);
      if (passed > 0) {
        before += (1000 * passed) / PLAYING;
        this.show((this.frame + passed) % this.scene.frames.length);
      }
      requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  }

  /** The values of the vertex under the pointer. */
  point(event) {
    const tip = get("tip");
    tip.hidden = true;
    if (event.buttons || event.pointerType === "touch" || !this.surface.positions) return;
    const point = this.surface.pointAt(this.camera, event.offsetX, event.offsetY, 8);
    if (point < 0) return;
    const { scene } = this;
    const now = scene.frames[this.frame];
    const place = [0, 1, 2].map((k) => this.surface.positions[3 * point + k] + now.middle[k]);
    const lines = scene.fields.map((field, k) => {
      const value = valueAt(scene, now, k, point);
      const text = field.kind === "whole" ? Math.round(value) : shortNumber(value, 4);
      return `${field.label}: ${text} ${field.unit}`;
    });
    tip.textContent = [`vertex ${point}`, `at ${place.map((p) => shortNumber(p, 5)).join(", ")} nm`, ...lines].join("\n");
    tip.hidden = false;
    tip.style.left = `${Math.min(event.offsetX + 14, get("canvas").clientWidth - tip.offsetWidth - 6)}px`;
    tip.style.top = `${Math.min(event.offsetY + 14, get("canvas").clientHeight - tip.offsetHeight - 6)}px`;
  }

  resize() {
    const canvas = get("canvas");
    const density = Math.min(window.devicePixelRatio || 1, 2);
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * density));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * density));
    this.redraw();
  }

  /** Draw with the next picture of the browser, once. */
  redraw() {
    if (this.waiting || !this.surface.gl) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      if (this.scene.key !== null) this.keep();
      if (!this.surface.gl.isContextLost()) this.surface.draw(this.camera, this.options);
    });
  }

  /** A page that is made anew during a run is seen as the last one was left, at the newest frame. */
  remember() {
    const { key, reload } = this.scene;
    const last = this.scene.frames.length - 1;
    try {
      const saved = JSON.parse(sessionStorage.getItem(key));
      Object.assign(this.camera, saved.camera);
      Object.assign(this, { options: saved.options, field: saved.field, row: saved.row });
      if (saved.chosen < this.scene.surfaces.length) this.chosen = saved.chosen;
      if (saved.frame >= 0) this.frame = Math.min(saved.frame, last);
    } catch {
      // It is seen for the first time, or the browser keeps nothing.
    }
    if (reload !== null) setTimeout(() => this.renew(), 1000 * reload);
  }

  /** Keeps how the page is seen. */
  keep() {
    const { options, field, chosen, row } = this;
    const { azimuth, elevation, zoom, shift } = this.camera;
    // Who looks at the newest frame sees the next one.
    const frame = this.frame === this.scene.frames.length - 1 ? -1 : this.frame;
    const state = { camera: { azimuth, elevation, zoom, shift }, options, field, chosen, row, frame };
    try {
      sessionStorage.setItem(this.scene.key, JSON.stringify(state));
    } catch {
      // The browser keeps nothing.
    }
  }

  renew() {
    if (this.playing) setTimeout(() => this.renew(), 1000);
    else location.reload();
  }

  /** Milliseconds for a picture that is drawn, and for a frame that is shown; means of several. */
  timing(pictures) {
    const gl = this.surface.gl;
    const pixel = new Uint8Array(4);
    // Reading a pixel waits for the picture.
    const finish = () => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    const mean = (work) => {
      const start = performance.now();
      for (let i = 0; i < pictures; i++) work();
      return (performance.now() - start) / pictures;
    };
    const paint = () => {
      this.camera.turn(0.01, 0);
      this.surface.draw(this.camera, this.options);
      finish();
    };
    paint();
    const frame = this.frame;
    const result = { draw: mean(paint), show: mean(() => this.show((this.frame + 1) % this.scene.frames.length)) };
    this.show(frame);
    return result;
  }
}

/** What tells a number from others: an area from the energy that it costs. */
function keyOf(series) {
  return `${series.label} ${series.unit}`;
}

/** How far a frame reaches from its middle, nm. */
function extent(frame) {
  const positions = positionsOf(frame);
  let most = 0;
  for (let i = 0; i < positions.length; i += 3) {
    most = Math.max(most, positions[i] ** 2 + positions[i + 1] ** 2 + positions[i + 2] ** 2);
  }
  return Math.sqrt(most);
}

function complain(text) {
  get("problem").textContent = text;
  get("problem").hidden = false;
}

readScene(get("header").textContent, get("block").textContent)
  .then((scene) => {
    window.viewer = new Viewer(scene);
    document.body.dataset.ready = "true";
  })
  .catch((reason) => complain(`The page cannot show its surface: ${reason.message}`));
