// A length as a person writes it: metres, or with a unit, with a decimal point or comma, in feet and inches.

const METRES = { km: 1000, m: 1, cm: 0.01, mm: 0.001, ft: 0.3048, in: 0.0254 };
const NAMES = [
  [/(?:['′’]{2}|["″”]|inch(?:es)?|in)\.?/g, "in"],
  [/(?:['′’]|feet|foot|ft)\.?/g, "ft"],
  [/(?:metres?|meters?)/g, "m"],
];
const SHORTEST = 0.001; // m
const LONGEST = 100_000;
const NUMBER = String.raw`\d[\d.,]*(?:\s+\d+\s*/\s*\d+)?|[.,]\d+|\d+\s*/\s*\d+`; // also 6 1/2
const ONE = new RegExp(`^(${NUMBER})\\s*(km|m|cm|mm|ft|in)?$`);
const FEET_AND_INCHES = new RegExp(`^(${NUMBER})\\s*ft\\s*(${NUMBER})\\s*(?:in)?$`);

/** `{metres}` of a text, or `{error}` with one line that says what to write instead. */
export function readLength(text) {
  const plain = NAMES.reduce((left, [sign, name]) => left.replace(sign, name), text.trim().toLowerCase());
  const both = FEET_AND_INCHES.exec(plain);
  const parts = both
    ? [
        [both[1], "ft"],
        [both[2], "in"],
      ]
    : [(ONE.exec(plain) ?? []).slice(1)];
  let metres = 0;
  for (const [digits, unit] of parts) {
    if (digits === undefined) return { error: `“${text.trim()}” is no length: write 3.5, 350 cm or 11'6"` };
    const number = readNumber(digits);
    if (typeof number === "string") return { error: number };
    metres += number * METRES[unit ?? "m"];
  }
  if (metres >= SHORTEST && metres <= LONGEST) return { metres: Number(metres.toPrecision(12)) };
  return { error: `a length is from 1 mm to ${LONGEST / 1000} km, this one is ${metres} m` };
}

/** A number with a decimal point or comma, or a whole one with a fraction; a text where it can be read in two ways. */
function readNumber(digits) {
  const [, whole, above, below] = /^(?:([\d.,]+)\s+)?(\d+)\s*\/\s*(\d+)$/.exec(digits) ?? [];
  if (below !== undefined) {
    const first = whole === undefined ? 0 : readNumber(whole);
    return Number(below) > 0 && typeof first === "number" ? first + above / below : `${digits} is no number`;
  }
  const signs = digits.replace(/\d/g, "");
  const last = signs.at(-1);
  const groups = digits.split(/[.,]/);
  const inThrees = groups[0].length <= 3 && groups.slice(1, -1).every((group) => group.length === 3);
  if (signs === "") return Number(digits);
  if (signs === "," && /^[1-9]\d{0,2}$/.test(groups[0]) && groups[1].length === 3)
    return `${digits} can be ${groups.join(".")} or ${groups.join("")}: write one of these`;
  if (signs.length === 1) return Number(groups.join(".")); // 3.5 or 3,5
  if (!inThrees) return `${digits} is no number: write it with one point or comma`;
  const thousands = signs.slice(0, -1);
  if (signs === last.repeat(signs.length)) {
    return groups.at(-1).length === 3 ? Number(groups.join("")) : `${digits} is no number: write one point or comma`;
  }
  if (thousands !== thousands[0].repeat(thousands.length)) return `${digits} is no number: write one point or comma`;
  return Number(`${groups.slice(0, -1).join("")}.${groups.at(-1)}`);
}
