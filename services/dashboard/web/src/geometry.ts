// Pure: metres on the ground as longitude and latitude, for what the map draws.

import type { Ellipse, TrailPoint } from "./view";

export type LonLat = [number, number];

/** 95 % of a two-dimensional normal distribution lies within this many sigmas. */
export const SIGMAS_95 = Math.sqrt(-2 * Math.log(0.05));

const EQUATOR_M = 6_378_137;
const ECCENTRICITY_2 = 0.00669437999;

/** Metres per degree of longitude and latitude on WGS84, from its radii of curvature. */
export function metresPerDegree(latDeg: number): LonLat {
  const lat = (latDeg * Math.PI) / 180;
  const w = Math.sqrt(1 - ECCENTRICITY_2 * Math.sin(lat) ** 2);
  const east = (EQUATOR_M / w) * Math.cos(lat);
  const north = (EQUATOR_M * (1 - ECCENTRICITY_2)) / w ** 3;
  return [(east * Math.PI) / 180, (north * Math.PI) / 180];
}

/** The ellipse's outline, closed, `sigmas` times its axes. */
export function ellipseOutline(
  center: LonLat,
  ellipse: Ellipse,
  sigmas: number,
  corners = 48,
): LonLat[] {
  const [east, north] = metresPerDegree(center[1]);
  const turn = (ellipse.orientation_deg * Math.PI) / 180;
  return Array.from({ length: corners + 1 }, (_, corner) => {
    const angle = (2 * Math.PI * (corner % corners)) / corners;
    const along = sigmas * ellipse.semi_major_m * Math.cos(angle);
    const across = sigmas * ellipse.semi_minor_m * Math.sin(angle);
    return [
      center[0] + (along * Math.sin(turn) + across * Math.cos(turn)) / east,
      center[1] + (along * Math.cos(turn) - across * Math.sin(turn)) / north,
    ];
  });
}

export interface TrailLine {
  line: LonLat[];
  reckoned: boolean;
}

/** A stroke longer than this was not driven: the recording began anew, or reports are sparse. */
const JUMP_M = 250;

/** The trail as lines of one kind each: with fixes, or reckoned without. */
export function trailLines(trail: readonly TrailPoint[]): TrailLine[] {
  const lines: TrailLine[] = [];
  let last: TrailPoint | undefined;
  for (const point of trail) {
    const here: LonLat = [point.lon_deg, point.lat_deg];
    const reckoned = point.mode === "dead_reckoning" || point.mode === "lost";
    const open = lines.at(-1);
    if (open === undefined || last === undefined || isJump(last, point)) {
      lines.push({ line: [here], reckoned });
    } else if (open.reckoned === reckoned) {
      open.line.push(here);
    } else {
      lines.push({ line: [[last.lon_deg, last.lat_deg], here], reckoned });
    }
    last = point;
  }
  return lines.filter(({ line }) => line.length > 1);
}

function isJump(from: TrailPoint, to: TrailPoint): boolean {
  const [east, north] = metresPerDegree(to.lat_deg);
  return (
    Math.hypot((to.lon_deg - from.lon_deg) * east, (to.lat_deg - from.lat_deg) * north) > JUMP_M
  );
}

export interface GridLine {
  line: LonLat[];
  label: string;
}

/** West, south, east, north in degrees. */
export type Area = [number, number, number, number];

/** Parallels and meridians over an area, 1, 2 or 5 powers of ten apart, about `wanted` across. */
export function gridLines([west, south, east, north]: Area, wanted: number): GridLine[] {
  const step = niceStep((east - west) / wanted);
  const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  const lines: GridLine[] = [];
  for (const lon of multiples(west, east, step)) {
    const label = `${Math.abs(lon).toFixed(decimals)}° ${lon < 0 ? "W" : "E"}`;
    lines.push({
      line: [
        [lon, south],
        [lon, north],
      ],
      label,
    });
  }
  for (const lat of multiples(south, north, step)) {
    const label = `${Math.abs(lat).toFixed(decimals)}° ${lat < 0 ? "S" : "N"}`;
    lines.push({
      line: [
        [west, lat],
        [east, lat],
      ],
      label,
    });
  }
  return lines;
}

export function niceStep(raw: number): number {
  const power = 10 ** Math.floor(Math.log10(raw));
  const factor = [1, 2, 5].find((candidate) => candidate * power >= raw * 0.999) ?? 10;
  return factor * power;
}

function multiples(from: number, to: number, step: number): number[] {
  const first = Math.ceil(from / step);
  const count = Math.max(0, Math.floor(to / step) - first + 1);
  return Array.from({ length: count }, (_, index) => (first + index) * step);
}
