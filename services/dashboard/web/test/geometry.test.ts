import { describe, expect, test } from "vitest";

import { SIGMAS_95, ellipseOutline, gridLines, metresPerDegree, trailLines } from "../src/geometry";
import type { LonLat } from "../src/geometry";
import type { PoseMode, TrailPoint } from "../src/view";

const PLACE: LonLat = [-75.35, 39.906];

function metresFrom([lon, lat]: LonLat): [number, number] {
  const [east, north] = metresPerDegree(PLACE[1]);
  return [(lon - PLACE[0]) * east, (lat - PLACE[1]) * north];
}

test("metres per degree agree with the geodesics of the Python side", () => {
  const [east, north] = metresPerDegree(39.906);
  expect(east).toBeCloseTo(85_512, -1);
  expect(north).toBeCloseTo(111_033, -1);
});

test("95 % of a plane's normal distribution lie within 2.45 sigmas", () => {
  expect(SIGMAS_95).toBeCloseTo(2.4477, 4);
});

describe("ellipse", () => {
  const outline = ellipseOutline(
    PLACE,
    { semi_major_m: 10, semi_minor_m: 4, orientation_deg: 90 },
    2,
  );

  test("is closed", () => expect(outline.at(-1)).toEqual(outline[0]));

  test("reaches its axes, the major one to the east", () => {
    const [east, north] = metresFrom(outline[0]!);
    expect([east, north]).toEqual([expect.closeTo(20, 2), expect.closeTo(0, 2)]);
    const norths = outline.map((corner) => metresFrom(corner)[1]);
    expect(Math.max(...norths)).toBeCloseTo(8, 1);
  });

  test("turns clockwise from north", () => {
    const shape = { semi_major_m: 10, semi_minor_m: 4, orientation_deg: 45 };
    const [east, north] = metresFrom(ellipseOutline(PLACE, shape, 1)[0]!);
    expect(east).toBeGreaterThan(5);
    expect(north).toBeGreaterThan(5);
  });
});

describe("trail", () => {
  const at = (north: number, mode: PoseMode = "fused"): TrailPoint => ({
    lat_deg: PLACE[1] + north / 111_033,
    lon_deg: PLACE[0],
    mode,
  });

  test("changes its kind without a hole", () => {
    const lines = trailLines([
      at(0),
      at(5),
      at(10, "dead_reckoning"),
      at(15, "dead_reckoning"),
      at(20),
    ]);
    expect(lines.map(({ line, reckoned }) => [line.length, reckoned])).toEqual([
      [2, false],
      [3, true],
      [2, false],
    ]);
    expect(lines[1]!.line[0]).toEqual(lines[0]!.line.at(-1));
  });

  test("breaks where the vehicle cannot have driven", () => {
    expect(trailLines([at(0), at(5), at(5000), at(5005)])).toHaveLength(2);
  });

  test("needs two points for a line", () => expect(trailLines([at(0)])).toEqual([]));
});

describe("grid", () => {
  const lines = gridLines([-75.3525, 39.9035, -75.3435, 39.9105], 7);

  test("lies on round degrees with the decimals that they need", () => {
    expect(lines.map((line) => line.label)).toEqual([
      "75.352° W",
      "75.350° W",
      "75.348° W",
      "75.346° W",
      "75.344° W",
      "39.904° N",
      "39.906° N",
      "39.908° N",
      "39.910° N",
    ]);
  });

  test("spans the area", () => {
    expect(lines[0]!.line.map(([, lat]) => lat)).toEqual([39.9035, 39.9105]);
  });
});
