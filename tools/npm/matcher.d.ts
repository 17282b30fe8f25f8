import type { CompareOptions, Picture } from "./index.js";

/** Which file is the golden, and the tolerance, which is `compare`'s. */
export interface GoldenOptions extends Omit<CompareOptions, "diff"> {
  /** Of a test's several pictures each needs one. */
  name?: string;
  /** In place of `goldens` beside the test's file. */
  folder?: string;
}

/**
 * A matcher for jest's and vitest's `expect.extend({ toMatchSoftfocusGolden })`:
 *
 *     await expect(picture).toMatchSoftfocusGolden({ maxFlip: 0.01 });
 *
 * The picture is held against `goldens/FILE/TEST.npy` beside the test's file, or a .png of that name.
 * Without a tolerance all bits must be equal. `-u` writes what is missing or differs, as .npy. A failure
 * leaves `.got.npy` there and, beside a golden of its size, `.diff.png`.
 */
export function toMatchSoftfocusGolden(
  this: any, received: Picture, options?: GoldenOptions,
): Promise<{ pass: boolean; message: () => string }>;

/**
 * For vitest: `declare module "vitest" { interface Matchers<T> extends SoftfocusMatchers {} }`. jest's
 * types have it.
 */
export interface SoftfocusMatchers<R = unknown> {
  toMatchSoftfocusGolden(options?: GoldenOptions): Promise<R>;
}

declare global {
  namespace jest {
    // eslint-disable-next-line @typescript-eslint/no-unused-vars
    interface Matchers<R, T = {}> extends SoftfocusMatchers<R> {}
  }
}
