// Golden images in jest and vitest, as the fixture softfocus_compare has them in pytest.

import { createHash } from "node:crypto";
import fs from "node:fs";
import path from "node:path";

import { SoftfocusError, compare } from "./index.js";
import { npy_of, read_picture } from "./pictures.js";

/** Of a test, and a picture's own name: no two alike. */
function file_name(test, name) {
  const whole = [test, name].filter((word) => word !== undefined).join(".");
  const plain = whole.replace(/[^A-Za-z0-9._+-]/g, "_").slice(0, 100);
  if (plain === whole) return plain;
  return `${plain}~${createHash("sha256").update(whole).digest("hex").slice(0, 8)}`;
}

function said({ differing, values, maxError, flip }) {
  return `${differing} of ${values} values differ` +
      (typeof maxError === "number" ? `, at most by ${Number(maxError.toPrecision(4))}` : "") +
      (typeof flip === "number" ? `; mean FLIP ${Number(flip.toPrecision(4))}` : "");
}

/** What differs, or nothing. */
async function difference_of(picture, golden, tolerance) {
  if (!fs.existsSync(golden)) return "there is none yet";
  try {
    const found = await compare(picture, fs.readFileSync(golden), tolerance);
    return found.passes ? null : said(found);
  } catch (error) {
    if (!(error instanceof SoftfocusError)) throw error;
    return error.message;
  }
}

const npy_file = (picture) => npy_of(read_picture("the picture", picture, [1, 3, 4]));

export async function toMatchSoftfocusGolden(picture, { name, folder, ...tolerance } = {}) {
  if (this.isNot) throw new SoftfocusError("toMatchSoftfocusGolden has no .not");
  const test = path.parse(this.testPath);
  const plain = path.join(folder ?? path.join(test.dir, "goldens"), test.name.replace(/\.(test|spec)$/, ""),
                          file_name(this.currentTestName ?? "", name));
  const png = `${plain}.png`;
  const npy = `${plain}.npy`;
  const golden = !fs.existsSync(npy) && fs.existsSync(png) ? png : npy;
  const got = `${plain}.got.npy`;
  const diff = `${plain}.diff.png`;
  for (const stale of [got, diff]) fs.rmSync(stale, { force: true });
  const why = await difference_of(picture, golden, tolerance);
  if (why === null) return { pass: true, message: () => "" };
  await compare(picture, picture, tolerance);  // what can be no golden, or no option, ends here
  fs.mkdirSync(path.dirname(plain), { recursive: true });
  if (this.snapshotState?._updateSnapshot === "all") {
    fs.writeFileSync(npy, npy_file(picture));
    fs.rmSync(png, { force: true });
    return { pass: true, message: () => "" };
  }
  fs.writeFileSync(got, npy_file(picture));
  let shown = "";
  if (fs.existsSync(golden)) {
    try {
      fs.writeFileSync(diff, (await compare(picture, fs.readFileSync(golden), { diff: true })).diff);
      shown = `, differences in ${path.basename(diff)}`;
    } catch (error) {
      if (!(error instanceof SoftfocusError)) throw error;  // of another size
    }
  }
  return {
    pass: false,
    message: () => `${golden}: ${why}. The picture is in ${path.basename(got)}${shown}; -u takes it.`,
  };
}
