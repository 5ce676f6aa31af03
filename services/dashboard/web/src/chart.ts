// Pure: lays the slope ahead out on a plot. Stretches nobody has driven stay empty.

import { niceStep } from "./geometry";
import type { SlopePoint } from "./view";

/** Size and margins in the drawing's own units. */
export interface Plot {
  width: number;
  height: number;
  left: number;
  right: number;
  top: number;
  bottom: number;
}

export interface Tick {
  at: number;
  value: number;
}

export interface Chart {
  /** Points of an SVG polyline for every stretch without a gap. */
  lines: string[];
  /** Points of an SVG polygon: one sigma on both sides. */
  bands: string[];
  gradeTicks: Tick[];
  distanceTicks: Tick[];
  lowPct: number;
  highPct: number;
  lengthM: number;
  /** Of the best known point. */
  runs: number;
}

interface Known {
  distance_m: number;
  grade_pct: number;
  std_pct: number;
}

/** At least this much of the slope axis, so that a flat road looks flat. */
const SPAN_MIN_PCT = 4;

/** Null where nothing is known at all. */
export function slopeChart(points: readonly SlopePoint[], plot: Plot): Chart | null {
  const stretches = knownStretches(points);
  const known = stretches.flat();
  const last = points.at(-1);
  if (known.length === 0 || last === undefined) {
    return null;
  }
  const lengthM = Math.max(last.distance_m, 1);
  const [from, to] = gradeRange(known);
  const x = (distance: number) =>
    plot.left + (distance / lengthM) * (plot.width - plot.left - plot.right);
  const y = (grade: number) =>
    plot.top + ((to - grade) / (to - from)) * (plot.height - plot.top - plot.bottom);
  const grades = known.map((point) => point.grade_pct);
  return {
    lines: stretches.map((stretch) => path(stretch.map((p) => [x(p.distance_m), y(p.grade_pct)]))),
    bands: stretches.map((stretch) =>
      path([
        ...stretch.map((p) => [x(p.distance_m), y(p.grade_pct + p.std_pct)] as const),
        ...stretch.map((p) => [x(p.distance_m), y(p.grade_pct - p.std_pct)] as const).reverse(),
      ]),
    ),
    gradeTicks: ticks(from, to, 4).map((value) => ({ at: y(value), value })),
    distanceTicks: ticks(0, lengthM, 4).map((value) => ({ at: x(value), value })),
    lowPct: Math.min(...grades),
    highPct: Math.max(...grades),
    lengthM,
    runs: Math.max(...points.map((point) => point.runs)),
  };
}

function knownStretches(points: readonly SlopePoint[]): Known[][] {
  const stretches: Known[][] = [];
  let open: Known[] = [];
  for (const { distance_m, grade_pct, grade_std_pct } of points) {
    if (grade_pct === null) {
      open = [];
      continue;
    }
    if (open.length === 0) {
      stretches.push(open);
    }
    open.push({ distance_m, grade_pct, std_pct: grade_std_pct ?? 0 });
  }
  return stretches;
}

function gradeRange(known: readonly Known[]): [number, number] {
  const low = Math.min(0, ...known.map((point) => point.grade_pct - point.std_pct));
  const high = Math.max(0, ...known.map((point) => point.grade_pct + point.std_pct));
  const widen = Math.max(0, SPAN_MIN_PCT - (high - low)) / 2;
  return [Math.floor(low - widen), Math.ceil(high + widen)];
}

function ticks(from: number, to: number, wanted: number): number[] {
  const step = niceStep((to - from) / wanted);
  const first = Math.ceil(from / step);
  const count = Math.floor(to / step + 1e-9) - first + 1;
  return Array.from({ length: count }, (_, index) => (first + index) * step);
}

function path(points: readonly (readonly number[])[]): string {
  return points.map((point) => point.map((value) => value.toFixed(1)).join(",")).join(" ");
}
