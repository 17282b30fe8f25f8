// Numbers as people read them: three digits and a unit.

/** Three digits, without an exponent where one is not needed. */
export function three_digits(value) {
  if (!Number.isFinite(value)) return value > 0 ? "∞" : value < 0 ? "−∞" : "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e7)) return value.toExponential(2);
  return String(Number(value.toPrecision(size >= 1000 ? 4 : 3))).replace("-", "−");
}

/** "85 cm", "1.2 m", "∞". */
export function metres_text(metres) {
  if (!Number.isFinite(metres)) return "∞";
  if (Math.abs(metres) >= 1) return `${three_digits(metres)} m`;
  if (Math.abs(metres) >= 0.01) return `${three_digits(metres * 100)} cm`;
  return `${three_digits(metres * 1000)} mm`;
}

/** "85 mm", "12 µm". */
export function millimetres_text(mm) {
  const size = Math.abs(mm);
  if (!Number.isFinite(mm)) return three_digits(mm);
  if (size >= 1000) return `${three_digits(mm / 1000)} m`;
  if (size >= 0.1 || size === 0) return `${three_digits(mm)} mm`;
  return `${three_digits(mm * 1000)} µm`;
}

export function pixels_text(px) {
  return `${three_digits(px)} px`;
}

export function ms_text(ms) {
  return ms === undefined || ms === null ? "–" :
         ms < 10 ? ms.toFixed(1) : Math.round(ms).toString();
}

/** The end of a range, exactly: 1e9 rather than its zeros. */
export function limit_text(value) {
  const size = Math.abs(value);
  const is_long = size !== 0 && (size < 1e-3 || size >= 1e6);
  return (is_long ? value.toExponential() : String(value)).replace("e+", "e");
}

/** A number of few digits, so that a command line and a link can repeat it exactly. */
export function rounded(value, digits = 3) {
  return Number(value.toPrecision(digits));
}
