// Pure: a stretch of the past, and where the vehicle was at any instant of it.

import type { Pose, PoseMode, TrailPoint } from "../view";

/** A pose as history tells it (wayline_history/points.py). */
export interface PastPoint {
  t: string;
  lat_deg: number | null;
  lon_deg: number | null;
  alt_m: number | null;
  heading_deg: number | null;
  speed_mps: number | null;
  grade_pct: number | null;
  distance_m: number;
  mode: PoseMode;
  east_std_m: number | null;
  north_std_m: number | null;
  alt_std_m: number | null;
}

/** After such a silence nobody knows what was between. */
const SILENCE_MS = 600_000;

export class PastTrack {
  private readonly times: number[];

  constructor(private readonly points: readonly PastPoint[]) {
    this.times = points.map(({ t }) => Date.parse(t));
  }

  get isEmpty(): boolean {
    return this.points.length === 0;
  }

  /** The pose at an instant, between two that are known; null before the first one. */
  poseAt(ms: number): Pose | null {
    const place = lastAtOrBefore(this.times, ms);
    const before = this.points[place];
    if (before === undefined) {
      return null;
    }
    const after = this.points[place + 1];
    const [from, to] = [this.times[place] ?? ms, this.times[place + 1] ?? ms];
    const share = after === undefined || to - from > SILENCE_MS ? 0 : (ms - from) / (to - from);
    return poseBetween(before, after ?? before, share, ms);
  }

  /** Where the vehicle had been up to an instant. */
  trailTo(ms: number): TrailPoint[] {
    const driven = this.points.slice(0, lastAtOrBefore(this.times, ms) + 1);
    return driven.flatMap(({ lat_deg, lon_deg, mode }) =>
      lat_deg === null || lon_deg === null ? [] : { lat_deg, lon_deg, mode },
    );
  }
}

/** -1 where all are later. */
export function lastAtOrBefore(times: readonly number[], ms: number): number {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((times[middle] ?? 0) <= ms) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low - 1;
}

function poseBetween(before: PastPoint, after: PastPoint, share: number, ms: number): Pose {
  const between = (name: "lat_deg" | "alt_m" | "speed_mps" | "distance_m"): number | null =>
    mixed(before[name], after[name], share);
  return {
    t: new Date(ms).toISOString(),
    mode: before.mode,
    lat_deg: between("lat_deg"),
    lon_deg: turned(before.lon_deg, after.lon_deg, share, -180),
    alt_m: between("alt_m"),
    alt_std_m: before.alt_std_m,
    heading_deg: turned(before.heading_deg, after.heading_deg, share, 0),
    heading_std_deg: null,
    speed_mps: between("speed_mps"),
    speed_std_mps: null,
    grade_pct: before.grade_pct,
    grade_std_pct: null,
    distance_m: between("distance_m") ?? 0,
    ellipse: ellipseOf(before),
  };
}

function mixed(a: number | null, b: number | null, share: number): number | null {
  return a === null || b === null ? a : a + (b - a) * share;
}

/** Between two angles the shorter way round, from `least` on in a whole turn. */
function turned(
  a: number | null,
  b: number | null,
  share: number,
  least: number,
): number | null {
  if (a === null || b === null) {
    return a;
  }
  const way = ((((b - a + 180) % 360) + 360) % 360) - 180;
  return ((((a + way * share - least) % 360) + 360) % 360) + least;
}

function ellipseOf({ east_std_m, north_std_m }: PastPoint): Pose["ellipse"] {
  if (east_std_m === null || north_std_m === null) {
    return null;
  }
  return {
    semi_major_m: Math.max(east_std_m, north_std_m),
    semi_minor_m: Math.min(east_std_m, north_std_m),
    orientation_deg: east_std_m > north_std_m ? 90 : 0,
  };
}
