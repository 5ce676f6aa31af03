import { expect, test } from "vitest";

import { ServerClock, ageS, isRecording, vehicleNowMs } from "../src/clock";
import type { Vehicle } from "../src/fleet";
import type { Pose } from "../src/view";

const HEARD = "2026-01-01T12:00:00.000Z";
const HEARD_MS = Date.parse(HEARD);

function vehicle(t: string): Vehicle {
  return {
    vehicle_id: "a",
    heard: HEARD,
    pose: { t, mode: "fused" } as Pose,
    trail: [],
    trailRevision: 0,
  };
}

test("the server's clock goes on with the monotonic one", () => {
  let monotonic = 1000;
  const clock = new ServerClock(() => monotonic);
  clock.set(HEARD);
  monotonic += 2500;
  expect(clock.nowMs()).toBe(HEARD_MS + 2500);
});

test("a live pose ages from its own instant, delay on the way included", () => {
  const late = vehicle("2026-01-01T11:59:58.000Z");
  expect(ageS(late, HEARD_MS + 1000)).toBe(3);
  expect(vehicleNowMs(late, HEARD_MS + 1000)).toBe(HEARD_MS + 1000);
});

test("a recording ages from when it was heard and keeps its own time", () => {
  const old = vehicle("2018-11-12T14:00:00.000Z");
  expect(isRecording(old)).toBe(true);
  expect(ageS(old, HEARD_MS + 1000)).toBe(1);
  expect(vehicleNowMs(old, HEARD_MS + 1000)).toBe(Date.parse("2018-11-12T14:00:01.000Z"));
});

test("without a pose there is no age", () => {
  expect(ageS({ vehicle_id: "a", trail: [], trailRevision: 0 }, HEARD_MS)).toBeNull();
});
