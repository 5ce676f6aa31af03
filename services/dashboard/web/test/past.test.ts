import { expect, test } from "vitest";

import { PastTrack, lastAtOrBefore } from "../src/past/track";
import type { PastPoint } from "../src/past/track";

const START = Date.parse("2026-01-01T00:00:00.000Z");

function point(seconds: number, lon_deg: number, more: Partial<PastPoint> = {}): PastPoint {
  return {
    t: new Date(START + seconds * 1000).toISOString(),
    lat_deg: 48,
    lon_deg,
    alt_m: 500,
    heading_deg: 90,
    speed_mps: 10,
    grade_pct: null,
    distance_m: seconds * 10,
    mode: "fused",
    east_std_m: 2,
    north_std_m: 1,
    alt_std_m: 3,
    ...more,
  };
}

test("between two poses the vehicle is between them", () => {
  const track = new PastTrack([point(0, 11), point(10, 11.1)]);
  const pose = track.poseAt(START + 2500);
  expect(pose?.lon_deg).toBeCloseTo(11.025);
  expect(pose?.t).toBe("2026-01-01T00:00:02.500Z");
  expect(pose?.ellipse).toEqual({ semi_major_m: 2, semi_minor_m: 1, orientation_deg: 90 });
});

test("before the first pose nobody knows, after the last it stays", () => {
  const track = new PastTrack([point(0, 11), point(10, 11.1)]);
  expect(track.poseAt(START - 1)).toBeNull();
  expect(track.poseAt(START + 60_000)?.lon_deg).toBeCloseTo(11.1);
});

test("a heading turns the shorter way, a track goes on over the antimeridian", () => {
  const track = new PastTrack([
    point(0, 179.9, { heading_deg: 350 }),
    point(10, -179.9, { heading_deg: 20 }),
  ]);
  expect(track.poseAt(START + 5000)?.heading_deg).toBeCloseTo(5);
  expect(Math.abs(track.poseAt(START + 5000)?.lon_deg ?? 0)).toBeCloseTo(180);
});

test("through a long silence the vehicle stays where it was last", () => {
  const track = new PastTrack([point(0, 11), point(3600, 12)]);
  expect(track.poseAt(START + 1_800_000)?.lon_deg).toBe(11);
});

test("the trail goes as far as the instant and leaves out what is unknown", () => {
  const unknown = point(5, 0, { lat_deg: null, lon_deg: null });
  const track = new PastTrack([point(0, 11), unknown, point(10, 11.1), point(20, 11.2)]);
  expect(track.trailTo(START + 12_000).map(({ lon_deg }) => lon_deg)).toEqual([11, 11.1]);
  expect(track.trailTo(START - 1)).toEqual([]);
});

test("the last one at or before an instant is found", () => {
  expect([-1, 0, 5, 9, 10, 99].map((ms) => lastAtOrBefore([0, 5, 10], ms))).toEqual([
    -1, 0, 1, 1, 2, 2,
  ]);
});
