// Small pictures of numbers over time, and of a spectrum, as SVG.

const SVG = "http://www.w3.org/2000/svg";

/** An element of SVG in another one. */
function draw(parent, name, attributes, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return parent.appendChild(element);
}

/** Least and largest of the numbers that are known; never the same. */
function rangeOf(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value === null) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) return [0, 1];
  return low === high ? [low - Math.abs(low) / 100 - 1e-12, high + Math.abs(high) / 100 + 1e-12] : [low, high];
}

/** A path through points, with gaps where x or y returns null. */
function pathOf(count, x, y) {
  let path = "", pen = "M";
  for (let i = 0; i < count; i++) {
    const height = y(i);
    if (height === null) {
      pen = "M";
      continue;
    }
    path += `${pen}${x(i).toFixed(1)} ${height.toFixed(1)}`;
    pen = "L";
  }
  return path;
}

/** A line without axes; returns a function that marks a frame. */
function sparkline(parent, values, width, height) {
  const svg = draw(parent, "svg", { viewBox: `0 0 ${width} ${height}`, class: "spark", "aria-hidden": true });
  const [low, high] = rangeOf(values);
  const x = (i) => 2 + ((width - 4) * i) / Math.max(1, values.length - 1);
  const y = (i) => values[i] === null ? null : height - 2 - ((height - 4) * (values[i] - low)) / (high - low);
  draw(svg, "path", { d: pathOf(values.length, x, y) });
  const dot = draw(svg, "circle", { r: 2.2 });
  return (frame) => {
    const at = y(frame);
    dot.setAttribute("visibility", at === null ? "hidden" : "visible");
    dot.setAttribute("cx", x(frame));
    dot.setAttribute("cy", at ?? 0);
  };
}

/** A number over time with its axes; returns a function that marks a frame. */
function chart(svg, times, series, chosen) {
  svg.replaceChildren();
  const width = 300, height = 120, left = 8, right = 8, top = 20, bottom = 18;
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const [low, high] = rangeOf(series.values);
  const [first, last] = [times[0], times[times.length - 1]];
  const x = (i) => left + ((width - left - right) * (times[i] - first)) / (last - first || 1);
  const y = (i) => series.values[i] === null ? null
    : height - bottom - ((height - top - bottom) * (series.values[i] - low)) / (high - low);
  const unit = series.unit ? ` (${series.unit})` : "";
  draw(svg, "text", { x: left, y: 11, class: "name" }, series.label + unit);
  for (const [value, at] of [[high, top], [low, height - bottom]]) {
    draw(svg, "line", { x1: left, x2: width - right, y1: at, y2: at, class: "grid" });
    draw(svg, "text", { x: width - right, y: at - 2, class: "end" }, shortNumber(value, 4));
  }
  draw(svg, "text", { x: left, y: height - 5 }, shortNumber(first, 4));
  draw(svg, "text", { x: width - right, y: height - 5, class: "end" }, `${shortNumber(last, 4)} ps`);
  draw(svg, "path", { d: pathOf(times.length, x, y) });
  const line = draw(svg, "line", { y1: top, y2: height - bottom, class: "cursor" });
  const dot = draw(svg, "circle", { r: 3 });
  const pick = (event) => {
    if (!(event.buttons & 1)) return;
    const box = svg.getBoundingClientRect();
    const at = ((event.clientX - box.left) / box.width) * width;
    let best = 0;
    for (let i = 1; i < times.length; i++) if (Math.abs(x(i) - at) < Math.abs(x(best) - at)) best = i;
    chosen(best);
  };
  svg.onpointerdown = pick;
  svg.onpointermove = pick;
  return (frame) => {
    line.setAttribute("x1", x(frame));
    line.setAttribute("x2", x(frame));
    dot.setAttribute("visibility", y(frame) === null ? "hidden" : "visible");
    dot.setAttribute("cx", x(frame));
    dot.setAttribute("cy", y(frame) ?? 0);
  };
}

/** Means over the frames that have a spectrum. */
function meanSpectrum(rows) {
  const known = rows.filter((row) => row[0] !== null);
  return known[0].map((_, k) => known.reduce((sum, row) => sum + row[k], 0) / known.length);
}

/** A spectrum in logarithmic axes, from l = 2 on; returns a function that shows a frame. */
function spectrumPlot(svg, rows) {
  svg.replaceChildren();
  const width = 300, height = 170, left = 34, right = 8, top = 8, bottom = 28;
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const mean = meanSpectrum(rows);
  // Frames vary around the mean; an exact sphere among them, which has nothing but rounding, would
  // take up the picture.
  let low = Infinity, high = -Infinity;
  for (const value of mean) if (value > 0) low = Math.min(low, Math.log10(value));
  for (const value of rows.flat()) if (value > 0) high = Math.max(high, Math.log10(value));
  if (low > high) [low, high] = [0, 0];
  [low, high] = [Math.floor(low - (rows.length > 1 ? 0.7 : 0)), Math.ceil(high)];
  if (high === low) high++;
  const largest = mean.length + 1;
  const x = (l) => left + ((width - left - right) * Math.log(l / 1.8)) / Math.log(largest / 1.7);
  const y = (value) => height - bottom - ((height - top - bottom) * (Math.log10(value) - low)) / (high - low);
  const apart = Math.ceil((high - low) / 6);
  for (let power = low; power <= high; power += apart) {
    const at = y(10 ** power);
    draw(svg, "line", { x1: left, x2: width - right, y1: at, y2: at, class: "grid" });
    draw(svg, "text", { x: left - 4, y: at + 3.5, class: "end" }, shortPower(power));
  }
  for (let l = 2; l <= largest; l++) {
    draw(svg, "text", { x: x(l), y: height - bottom + 12, class: "middle" }, l);
  }
  draw(svg, "text", { x: (left + width) / 2, y: height - 4, class: "middle" }, "l");
  const shown = (values, k) => (values[k] !== null && values[k] >= 10 ** low ? y(values[k]) : null);
  if (rows.length > 1) {
    draw(svg, "path", { d: pathOf(mean.length, (k) => x(k + 2), (k) => shown(mean, k)), class: "mean" });
  }
  const dots = mean.map((_, k) => draw(svg, "circle", { r: 3, cx: x(k + 2) }));
  return (frame) => {
    dots.forEach((dot, k) => {
      const at = shown(rows[frame], k);
      dot.setAttribute("visibility", at === null ? "hidden" : "visible");
      dot.setAttribute("cy", at ?? 0);
      dot.dataset.value = rows[frame][k];
    });
  };
}

function shortPower(power) {
  return "10" + [...String(power)].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c])).join("");
}
