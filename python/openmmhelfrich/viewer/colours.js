// Colour maps that people who confuse red and green read too.

/** Colours from the least to the largest value. */
const MAPS = {
  // ColorBrewer's RdYlBu, from blue to red.
  diverging: ["#313695", "#4575b4", "#74add1", "#abd9e9", "#e0f3f8", "#ffffbf", "#fee090",
              "#fdae61", "#f46d43", "#d73027", "#a50026"],
  // Viridis.
  sequential: ["#440154", "#482878", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779",
               "#6ece58", "#b5de2b", "#fde725"],
  // Four to eight neighbours; six are grey.
  whole: ["#08519c", "#6baed6", "#d9d9d9", "#fdae6b", "#d94801"],
};

/** A map as 256 colours of red, green, blue and alpha. */
function colourTable(kind) {
  const stops = MAPS[kind].map((text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)));
  const table = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; i++) {
    const whole = kind === "whole";
    const at = whole ? Math.min(stops.length - 1, Math.floor((i / 256) * stops.length))
                     : (i / 255) * (stops.length - 1);
    const low = Math.min(stops.length - 1, Math.floor(at));
    const high = Math.min(stops.length - 1, low + 1);
    for (let k = 0; k < 3; k++) {
      table[4 * i + k] = Math.round(stops[low][k] + (at - low) * (stops[high][k] - stops[low][k]));
    }
    table[4 * i + 3] = 255;
  }
  return table;
}

/** Where a value lies on its map, from 0 to 1; −1 for none. */
function placeOnMap(field, value) {
  if (Number.isNaN(value)) return -1;
  const { from, to } = field;
  // Whole numbers have a stretch of the map each.
  const place = field.kind === "whole" ? (value - from + 0.5) / (to - from + 1)
                                       : (value - from) / (to - from);
  return Math.min(1, Math.max(0, place));
}

/** Fills the legend of a field. */
function showLegend(element, field) {
  const unit = field.unit ? ` (${field.unit})` : "";
  const stops = MAPS[field.kind];
  element.replaceChildren();
  const label = element.appendChild(document.createElement("div"));
  label.textContent = field.label + unit;
  const bar = element.appendChild(document.createElement("div"));
  bar.className = "bar";
  const ticks = element.appendChild(document.createElement("div"));
  ticks.className = field.kind === "whole" ? "ticks whole" : "ticks";
  let words;
  if (field.kind === "whole") {
    const share = 100 / stops.length;
    const pieces = stops.map((c, i) => `${c} ${i * share}% ${(i + 1) * share}%`);
    bar.style.background = `linear-gradient(to right, ${pieces.join(",")})`;
    words = stops.map((_, i) => String(field.from + i));
    words[0] = "≤ " + words[0];
    words[words.length - 1] += " ≤";
  } else {
    bar.style.background = `linear-gradient(to right, ${stops.join(",")})`;
    words = [0, 0.5, 1].map((share) => {
      const value = field.from + share * (field.to - field.from);
      // The middle may miss 0 by rounding.
      return shortNumber(Math.abs(value) < 1e-9 * (field.to - field.from) ? 0 : value, 3);
    });
  }
  for (const word of words) ticks.appendChild(document.createElement("span")).textContent = word;
}

/** A number with so many digits, as 1.23 × 10⁴ where it is far from 1. */
function shortNumber(value, digits) {
  if (value === null || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 10 ** Math.max(digits, 6)) {
    return String(Number(value.toPrecision(digits))).replace("-", "−");
  }
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  const raised = [...String(Number(exponent))].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c])).join("");
  return `${mantissa} × 10${raised}`.replace("-", "−");
}
