// Pure: how long to wait before the next attempt to connect.

const FIRST_MS = 500;
const LONGEST_MS = 10_000;

/** Doubles with each failure; `random` in [0, 1) spreads many pages after a restart. */
export function waitMs(failures: number, random: number): number {
  const longest = Math.min(FIRST_MS * 2 ** Math.max(0, failures - 1), LONGEST_MS);
  return longest * (0.75 + 0.5 * random);
}
