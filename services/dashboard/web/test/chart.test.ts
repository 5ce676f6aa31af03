import { expect, test } from "vitest";

import { slopeChart } from "../src/chart";
import type { SlopePoint } from "../src/view";

const PLOT = { width: 120, height: 120, left: 10, right: 10, top: 10, bottom: 10 };

function point(distance_m: number, grade_pct: number | null, runs = 2): SlopePoint {
  return {
    distance_m,
    grade_pct,
    grade_std_pct: grade_pct === null ? null : 0.5,
    alt_m: null,
    runs,
  };
}

test("what nobody has driven stays empty", () => {
  const chart = slopeChart([point(0, 1), point(20, 1), point(40, null), point(60, 1)], PLOT);
  expect(chart?.lines.map((line) => line.split(" ").length)).toEqual([2, 1]);
});

test("nothing known is no chart", () => {
  expect(slopeChart([point(0, null, 0)], PLOT)).toBeNull();
  expect(slopeChart([], PLOT)).toBeNull();
});

test("the band is one sigma to both sides", () => {
  const chart = slopeChart([point(0, 1), point(100, 1)], PLOT)!;
  const [low, high] = [chart.gradeTicks[0]!, chart.gradeTicks.at(-1)!];
  const perPct = (low.at - high.at) / (high.value - low.value);
  const heights = chart.bands[0]!.split(" ").map((corner) => Number(corner.split(",")[1]));
  expect(Math.max(...heights) - Math.min(...heights)).toBeCloseTo(perPct, 0);
});

test("a flat road looks flat", () => {
  const chart = slopeChart([point(0, 0.1), point(100, -0.1)], PLOT)!;
  const grades = chart.gradeTicks.map(({ value }) => value);
  expect(Math.max(...grades) - Math.min(...grades)).toBeGreaterThanOrEqual(4);
});
